// SPDX-License-Identifier: GPL-3.0-or-later
#include "thalweg/terrain/graph.hpp"

#include <algorithm>
#include <array>

#include "terrain/check_sizes.hpp"
#include "terrain/downhill.hpp"
#include "terrain/layered_order.hpp"
#include "terrain/row_lengths.hpp"
#include "thalweg/core/parallel.hpp"

namespace thalweg::terrain {
namespace {

void write_lengths(const Mesh& mesh, const FlowDirections& directions, std::vector<double>& length) {
    parallel_for(0, mesh.size(), [&](Index first, Index last) {
        for (Index node = first; node < last; ++node) {
            if (directions[node] != no_flow) length[node] = mesh.length(node, directions[node]);
        }
    });
}

/// By rows, whose eight lengths are looked up once.
void write_lengths(const Grid& grid, const FlowDirections& directions, std::vector<double>& length) {
    const auto rows = [&](Index first_row, Index last_row) {
        for (Index row = first_row; row < last_row; ++row) {
            const std::size_t first = std::size_t{row} * grid.cols;
            const std::array<double, 8> of_slot = row_lengths(grid, row);
            for (std::size_t node = first; node < first + grid.cols; ++node) {
                if (directions[node] != no_flow) length[node] = of_slot[directions[node]];
            }
        }
    };
    parallel_for(0, grid.rows, rows, std::max<Index>(1, 16384 / grid.cols));
}

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

template <Topology T>
FlowGraph make_graph(const T& topology, std::span<const double> elevation_m, const FlowDirections& directions) {
    check_sizes(topology.size(), elevation_m.size(), directions.size());
    FlowGraph graph{.receiver = std::vector<Index>(topology.size(), none),
                    .length = std::vector<double>(topology.size(), 0.0),
                    .order = {}};
    OrderBuffers buffers;
    order_by_layers(topology, elevation_m, directions, buffers, graph.order, graph.layers, [](Index, Index) {});
    const auto neighbor = downhill(topology);
    parallel_for(0, topology.size(), [&](Index first, Index last) {
        for (Index node = first; node < last; ++node) {
            if (directions[node] != no_flow) graph.receiver[node] = neighbor(node, directions[node]);
        }
    });
    write_lengths(topology, directions, graph.length);
    return graph;
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

FlowGraph flow_graph(const Grid& grid, std::span<const double> elevation_m, const FlowDirections& directions) {
    return make_graph(grid, elevation_m, directions);
}

FlowGraph flow_graph(const Mesh& mesh, std::span<const double> elevation_m, const FlowDirections& directions) {
    return make_graph(mesh, elevation_m, directions);
}

}  // namespace thalweg::terrain
