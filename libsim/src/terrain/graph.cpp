// SPDX-License-Identifier: GPL-3.0-or-later
#include "thalweg/terrain/graph.hpp"

#include <algorithm>
#include <cmath>

#include "terrain/check_sizes.hpp"
#include "thalweg/core/parallel.hpp"

namespace thalweg::terrain {
namespace {

template <Topology T>
std::vector<Slot> count_donors(const T& topology, const FlowDirections& directions) {
    std::vector<Slot> donors(topology.size(), 0);
    for (Index node = 0; node < topology.size(); ++node) {
        if (directions[node] != no_flow) ++donors[topology.neighbor(node, directions[node])];
    }
    return donors;
}

/// From every node without donors down as far as no other branch is awaited; the last branch to arrive walks on. That
/// writes donors before receivers, so it is filled in from the end.
template <Topology T>
std::vector<Index> order_nodes(const T& topology, std::span<const double> elevation_m,
                               const FlowDirections& directions) {
    check_sizes(topology.size(), elevation_m.size(), directions.size());
    std::vector<Slot> awaited = count_donors(topology, directions);
    const std::vector<Slot> donors = awaited;
    std::vector<Index> order(topology.size());
    Index free = topology.size();
    for (Index leaf = 0; leaf < topology.size(); ++leaf) {
        if (donors[leaf] != 0 || std::isnan(elevation_m[leaf])) continue;
        Index node = leaf;
        order[--free] = node;
        while (directions[node] != no_flow) {
            node = topology.neighbor(node, directions[node]);
            if (--awaited[node] != 0) break;
            order[--free] = node;
        }
    }
    order.erase(order.begin(), order.begin() + free);
    return order;
}

template <Topology T>
FlowGraph make_graph(const T& topology, std::span<const double> elevation_m, const FlowDirections& directions) {
    FlowGraph graph{.receiver = std::vector<Index>(topology.size(), none),
                    .length = std::vector<double>(topology.size(), 0.0),
                    .order = order_nodes(topology, elevation_m, directions)};
    parallel_for(0, topology.size(), [&](Index first, Index last) {
        for (Index node = first; node < last; ++node) {
            if (directions[node] == no_flow) continue;
            graph.receiver[node] = topology.neighbor(node, directions[node]);
            graph.length[node] = topology.length(node, directions[node]);
        }
    });
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
