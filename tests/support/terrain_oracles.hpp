// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <queue>
#include <span>
#include <vector>

#include "thalweg/core/topology.hpp"
#include "thalweg/terrain/graph.hpp"

namespace thalweg::support {

/// Nodes where the outside begins: those of the boundary, and in each connected piece without any the lowest node.
template <Topology T>
std::vector<Index> outlets_by_search(const T& topology, std::span<const double> z, std::span<const Boundary> boundary) {
    std::vector<Index> outlets;
    std::vector<int> seen(topology.size(), 0);
    for (Index start = 0; start < topology.size(); ++start) {
        if (seen[start] || std::isnan(z[start])) continue;
        std::vector<Index> piece{start};
        seen[start] = 1;
        bool has_outlet = false;
        Index lowest = start;
        for (std::size_t i = 0; i < piece.size(); ++i) {
            const Index node = piece[i];
            if (boundary[node] != Boundary::interior) {
                outlets.push_back(node);
                has_outlet = true;
            }
            if (z[node] < z[lowest] || (z[node] == z[lowest] && node < lowest)) lowest = node;
            topology.neighbors(node, [&](Index other, double, Slot) {
                if (seen[other] || std::isnan(z[other])) return;
                seen[other] = 1;
                piece.push_back(other);
            });
        }
        if (!has_outlet) outlets.push_back(lowest);
    }
    return outlets;
}

/// Filling by its definition: from infinity down to the fixed point of h = max(z, lowest neighbour).
template <Topology T>
std::vector<double> fill_by_iteration(const T& topology, std::span<const double> z,
                                      std::span<const Boundary> boundary) {
    std::vector<double> h(topology.size(), std::numeric_limits<double>::infinity());
    for (Index node = 0; node < topology.size(); ++node) {
        if (std::isnan(z[node])) h[node] = z[node];
    }
    std::vector<int> fixed(topology.size(), 0);
    for (const Index node : outlets_by_search(topology, z, boundary)) {
        h[node] = z[node];
        fixed[node] = 1;
    }
    for (bool changed = true; changed;) {
        changed = false;
        for (Index node = 0; node < topology.size(); ++node) {
            if (fixed[node] || std::isnan(z[node])) continue;
            double lowest = std::numeric_limits<double>::infinity();
            topology.neighbors(node, [&](Index other, double, Slot) {
                if (!std::isnan(z[other])) lowest = std::min(lowest, h[other]);
            });
            const double level = std::max(z[node], lowest);
            changed = changed || level != h[node];
            h[node] = level;
        }
    }
    return h;
}

/// Filling by a flood from the outlets with a priority queue (Barnes, Lehman & Mulla 2014b).
template <Topology T>
std::vector<double> fill_by_priority_flood(const T& topology, std::span<const double> z,
                                           std::span<const Boundary> boundary) {
    using Entry = std::pair<double, Index>;
    std::priority_queue<Entry, std::vector<Entry>, std::greater<>> queue;
    std::vector<double> h(z.begin(), z.end());
    std::vector<int> closed(topology.size(), 0);
    for (const Index node : outlets_by_search(topology, z, boundary)) {
        queue.emplace(z[node], node);
        closed[node] = 1;
    }
    while (!queue.empty()) {
        const auto [level, node] = queue.top();
        queue.pop();
        topology.neighbors(node, [&](Index other, double, Slot) {
            if (closed[other] || std::isnan(z[other])) return;
            closed[other] = 1;
            h[other] = std::max(z[other], level);
            queue.emplace(h[other], other);
        });
    }
    return h;
}

/// Where the water of `node` ends, step by step; `none` if it goes round in a loop.
template <Topology T>
Index end_of_flow(const T& topology, const FlowDirections& directions, Index node) {
    for (Index steps = 0; steps <= topology.size(); ++steps) {
        if (directions[node] == no_flow) return node;
        node = topology.neighbor(node, directions[node]);
    }
    return none;
}

/// Upslope sums by walking down from every node.
template <Topology T>
std::vector<double> accumulate_by_walking(const T& topology, std::span<const double> z,
                                          const FlowDirections& directions, std::span<const double> amount) {
    std::vector<double> sum(topology.size(), 0);
    for (Index start = 0; start < topology.size(); ++start) {
        if (std::isnan(z[start])) continue;
        Index node = start;
        sum[node] += amount[start];
        while (directions[node] != no_flow) {
            node = topology.neighbor(node, directions[node]);
            sum[node] += amount[start];
        }
    }
    return sum;
}

}  // namespace thalweg::support
