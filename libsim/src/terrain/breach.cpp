// SPDX-License-Identifier: GPL-3.0-or-later
#include "thalweg/terrain/breach.hpp"

#include <algorithm>
#include <cmath>
#include <queue>
#include <tuple>

#include "terrain/check_sizes.hpp"
#include "thalweg/terrain/flats.hpp"
#include "thalweg/terrain/route.hpp"

namespace thalweg::terrain {
namespace {

/// How a node is reached from the pit at hand.
struct Reached {
    double cost_m2, length_m;
    Index from;
};

struct Waiting {
    double cost_m2, length_m;
    Index node;
    friend bool operator>(const Waiting& a, const Waiting& b) {
        return std::tie(a.cost_m2, a.length_m, a.node) > std::tie(b.cost_m2, b.length_m, b.node);
    }
};

class Breacher {
  public:
    Breacher(const Grid& grid, std::span<const double> elevation_m, std::span<const Boundary> boundary,
             const BreachLimits& limits)
        : grid_(grid), boundary_(boundary), limits_(limits), surface_(elevation_m.begin(), elevation_m.end()) {
        reached_.resize(grid.size());
        searched_for_.assign(grid.size(), none);
        settled_for_.assign(grid.size(), none);
        done_.assign(grid.size(), 0);
    }

    std::vector<double> run() {
        for (const Index pit : pits()) {
            if (done_[pit]) continue;
            const Index target = search(pit, surface_[pit]);
            if (target != none) cut(pit, target);
        }
        return std::move(surface_);
    }

  private:
    /// Nodes that are lower than all around, or on a flat that is; lowest first. A flat has several: see `search`.
    std::vector<Index> pits() const {
        FlowDirections directions = route(grid_, surface_, boundary_);
        resolve_flats(grid_, surface_, boundary_, directions);
        std::vector<Index> pits;
        for (Index node = 0; node < grid_.size(); ++node) {
            const bool stays = directions[node] == no_flow && boundary_[node] == Boundary::interior;
            if (stays && !std::isnan(surface_[node])) pits.push_back(node);
        }
        std::ranges::sort(pits, {}, [&](Index node) { return std::pair(surface_[node], node); });
        return pits;
    }

    bool is_target(Index node, double height) const {
        return surface_[node] < height || boundary_[node] != Boundary::interior;
    }

    /// Dijkstra's search from the pit; `none` if no way out is within the limits. All of a flat pit is reached for
    /// nothing before anything that costs, so it is searched once.
    Index search(Index pit, double height) {
        std::priority_queue<Waiting, std::vector<Waiting>, std::greater<>> queue;
        const auto offer = [&](Index node, const Reached& way) {
            if (searched_for_[node] == pit) {
                const Reached& known = reached_[node];
                if (std::tie(known.cost_m2, known.length_m, known.from) <=
                    std::tie(way.cost_m2, way.length_m, way.from)) {
                    return;
                }
            }
            searched_for_[node] = pit;
            reached_[node] = way;
            queue.push({way.cost_m2, way.length_m, node});
        };
        offer(pit, {0, 0, none});
        while (!queue.empty()) {
            const Waiting next = queue.top();
            queue.pop();
            if (settled_for_[next.node] == pit) continue;
            settled_for_[next.node] = pit;
            if (is_target(next.node, height)) return next.node;
            if (next.cost_m2 == 0) done_[next.node] = 1;
            grid_.neighbors(next.node, [&](Index node, double length, Slot) {
                const double depth = std::max(0.0, surface_[node] - height);
                const double way = next.length_m + length;
                if (std::isnan(surface_[node]) || depth > limits_.depth_m || way > limits_.length_m) return;
                if (settled_for_[node] != pit) offer(node, {next.cost_m2 + length * depth, way, next.node});
            });
        }
        return none;
    }

    void cut(Index pit, Index target) {
        const double height = surface_[pit];
        for (Index node = target; node != none; node = reached_[node].from) {
            surface_[node] = std::min(surface_[node], height);
        }
    }

    const Grid& grid_;
    std::span<const Boundary> boundary_;
    const BreachLimits limits_;
    std::vector<double> surface_;
    std::vector<Reached> reached_;
    std::vector<Index> searched_for_, settled_for_;  // pit for which the node was seen last, so nothing is wiped
    std::vector<std::uint8_t> done_;
};

}  // namespace

std::vector<double> breach(const Grid& grid, std::span<const double> elevation_m, std::span<const Boundary> boundary,
                           const BreachLimits& limits) {
    check_sizes(grid.size(), elevation_m.size(), boundary.size());
    return Breacher(grid, elevation_m, boundary, limits).run();
}

}  // namespace thalweg::terrain
