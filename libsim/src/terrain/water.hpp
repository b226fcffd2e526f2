// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <atomic>
#include <span>
#include <vector>

#include "terrain/downhill.hpp"
#include "thalweg/core/parallel.hpp"
#include "thalweg/terrain/graph.hpp"

namespace thalweg::terrain {

/// True if every direction leads strictly down: then every node's water level is its ground.
template <Topology T>
bool falls_everywhere(const T& topology, std::span<const double> elevation_m, const FlowDirections& single) {
    const auto neighbor = downhill(topology);
    std::atomic<bool> falls = true;
    parallel_for(0, topology.size(), [&](Index first, Index last) {
        unsigned not_falling = 0;
        for (Index node = first; node < last; ++node) {
            if (single[node] == no_flow) continue;
            not_falling += !(elevation_m[neighbor(node, single[node])] < elevation_m[node]);
        }
        if (not_falling > 0) falls = false;
    });
    return falls;
}

/// Highest ground on the way out, from the outlets up.
template <Topology T>
void raise_to_water_level(const T& topology, const FlowDirections& single, std::span<const Index> order,
                          std::vector<double>& level) {
    constexpr std::size_t ahead = 24;
    const auto neighbor = downhill(topology);
    for (std::size_t at = 0; at < order.size(); ++at) {
        if (at + ahead < order.size()) {
            __builtin_prefetch(&single[order[at + ahead]]);
            __builtin_prefetch(&level[order[at + ahead]], 1);
        }
        const Index node = order[at];
        if (single[node] != no_flow) level[node] = std::max(level[node], level[neighbor(node, single[node])]);
    }
}

/// Ground and water level of a terrain whose flow is to be divided.
class Water {
  public:
    template <Topology T>
    Water(const T& topology, std::span<const double> elevation_m, const FlowDirections& single)
        : ground_(elevation_m), single_(single), level_(elevation_m) {
        if (falls_everywhere(topology, elevation_m, single)) return;
        raised_.assign(elevation_m.begin(), elevation_m.end());
        raise_to_water_level(topology, single, downstream_first_order(topology, elevation_m, single), raised_);
        level_ = raised_;
    }
    Water(const Water&) = delete;
    Water& operator=(const Water&) = delete;

    const FlowDirections& single() const { return single_; }
    const double* ground() const { return ground_.data(); }
    const double* level() const { return level_.data(); }

    /// Water may divide at nodes that have a way out and do not lie under water.
    bool may_divide(Index node) const { return single_[node] != no_flow && ground_[node] == level_[node]; }

    /// Whether the neighbour of a node that may divide can be one of its receivers. False without data.
    bool takes_from(Index neighbor, Index node) const { return level_[neighbor] < ground_[node]; }

  private:
    std::span<const double> ground_;
    const FlowDirections& single_;
    std::vector<double> raised_;
    std::span<const double> level_;
};

}  // namespace thalweg::terrain
