// SPDX-License-Identifier: GPL-3.0-or-later
#include "thalweg/terrain/graph.hpp"

#include <algorithm>
#include <cmath>
#include <memory>

#include "terrain/check_sizes.hpp"
#include "terrain/downhill.hpp"
#include "terrain/layered_order.hpp"
#include "thalweg/core/parallel.hpp"

namespace thalweg::terrain {
namespace {

template <Topology T>
std::vector<Index> order_nodes(const T& topology, std::span<const double> elevation_m,
                               const FlowDirections& directions) {
    check_sizes(topology.size(), elevation_m.size(), directions.size());
    OrderBuffers buffers;
    FlowLayers layers;
    std::vector<Index> order;
    order_by_layers(topology, elevation_m, directions, buffers, order, layers, [](Index, Index) {});
    return order;
}

/// Nodes in order, with pass(donor, receiver) called along the way.
template <class Pass>
FlowGraph grid_graph(const Grid& grid, std::span<const double> elevation_m, FlowDirections directions,
                     const Pass& pass) {
    check_sizes(grid.size(), elevation_m.size(), directions.size());
    OrderBuffers buffers;
    FlowGraph graph;
    order_by_layers(grid, elevation_m, directions, buffers, graph.order, graph.layers, pass);
    const auto shared = std::make_shared<const FlowDirections>(std::move(directions));
    graph.receiver = Receivers(grid, shared);
    graph.length = ReceiverLengths(grid, shared);
    return graph;
}

/// What each cell has before anything flows.
std::vector<double> own_areas(const Grid& grid, std::span<const double> elevation_m) {
    check_sizes(grid.size(), elevation_m.size(), elevation_m.size());
    std::vector<double> area(grid.size());
    const auto rows = [&](Index first, Index last) {
        for (std::size_t row = first; row < last; ++row) {
            for (std::size_t node = row * grid.cols; node < (row + 1) * grid.cols; ++node) {
                area[node] = std::isnan(elevation_m[node]) ? 0 : grid.cell_area[row];
            }
        }
    };
    parallel_for(0, grid.rows, rows, std::max<Index>(1, 65536 / grid.cols));
    return area;
}

}  // namespace

std::vector<Index> downstream_first_order(const Grid& grid, std::span<const double> elevation_m,
                                          const FlowDirections& directions) {
    return order_nodes(grid, elevation_m, directions);
}

std::vector<Index> downstream_first_order(const Mesh& mesh, std::span<const double> elevation_m,
                                          const FlowDirections& directions) {
    return order_nodes(mesh, elevation_m, directions);
}

FlowGraph flow_graph(const Grid& grid, std::span<const double> elevation_m, FlowDirections directions) {
    return grid_graph(grid, elevation_m, std::move(directions), [](Index, Index) {});
}

FlowGraph flow_graph(const Mesh& mesh, std::span<const double> elevation_m, const FlowDirections& directions) {
    check_sizes(mesh.size(), elevation_m.size(), directions.size());
    OrderBuffers buffers;
    FlowGraph graph;
    order_by_layers(mesh, elevation_m, directions, buffers, graph.order, graph.layers, [](Index, Index) {});
    std::vector<Index> receiver(mesh.size(), none);
    std::vector<double> length(mesh.size(), 0);
    parallel_for(0, mesh.size(), [&](Index first, Index last) {
        for (Index node = first; node < last; ++node) {
            if (directions[node] == no_flow) continue;
            receiver[node] = mesh.neighbor(node, directions[node]);
            length[node] = mesh.length(node, directions[node]);
        }
    });
    graph.receiver = std::move(receiver);
    graph.length = std::move(length);
    return graph;
}

GraphAndArea graph_and_area(const Grid& grid, std::span<const double> elevation_m, FlowDirections directions) {
    std::vector<double> area = own_areas(grid, elevation_m);
    const auto give = [&](Index donor, Index receiver) { area[receiver] += area[donor]; };
    FlowGraph graph = grid_graph(grid, elevation_m, std::move(directions), give);
    return {std::move(graph), std::move(area)};
}

}  // namespace thalweg::terrain
