// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "evolve/check_setting.hpp"
#include "evolve/drainage.hpp"
#include "evolve/erosion.hpp"
#include "thalweg/core/error.hpp"
#include "thalweg/evolve/exchange_watch.hpp"
#include "thalweg/evolve/simulate.hpp"

namespace thalweg::evolve {
namespace {

/// Sweeps for which only the same nodes may exchange receivers before they are kept.
constexpr Index patience = 20;

double erodibility(const River& river, const Setting& setting, Index node) {
    return setting.relative_erodibility.empty() ? river.k : river.k * setting.relative_erodibility[node];
}

/// u/k and the exponents of S = (u/k)^(1/n)·A^(−m/n), made once: the slope costs one root and one power per node.
class SteadySlope {
  public:
    SteadySlope(const River& river, const Setting& setting)
        : area_exponent_(river.m / river.n), talus_(river.talus_slope), slope_at_unit_area_(setting.uplift_m_per_yr) {
        for (Index node = 0; node < slope_at_unit_area_.size(); ++node) {
            double& value = slope_at_unit_area_[node];
            value = value > 0 ? std::pow(value / erodibility(river, setting, node), 1 / river.n) : 0;
        }
    }

    /// With sediment: what the river must cut is the node's own uplift and what it lays down of all uplift upstream.
    double loaded(const River& river, const Setting& setting, Index node, double area_m2, double load) const {
        const double laid_down = area_m2 > 0 ? river.g * load / area_m2 : 0;
        const double cut = setting.uplift_m_per_yr[node] + laid_down;
        if (!(cut > 0)) return 0;
        const double slope = std::pow(cut / erodibility(river, setting, node), 1 / river.n);
        return std::min(talus_, slope / area_power(area_m2, area_exponent_));
    }

    /// Infinite where a node rises and no water carries anything away.
    double operator()(Index node, double area_m2) const {
        if (slope_at_unit_area_[node] == 0) return 0;
        return std::min(talus_, slope_at_unit_area_[node] / area_power(area_m2, area_exponent_));
    }

  private:
    double area_exponent_;
    double talus_;
    std::vector<double> slope_at_unit_area_;
};

template <class Edges>
void integrate(const Edges& edges, const Drainage& drainage, const SteadySlope& slope, Landscape& landscape) {
    for (const Index node : drainage.order) {
        const Slot slot = drainage.directions[node];
        if (slot == no_flow) continue;
        const double receiver_m = landscape.elevation_m[edges.neighbor(node, slot)];
        landscape.elevation_m[node] = receiver_m + edges.length(node, slot) * slope(node, drainage.area_m2[node]);
    }
}

/// The same with sediment: `load` becomes the uplift of every node and all upstream (m³/yr).
template <class Edges>
void integrate_loaded(const Edges& edges, const Drainage& drainage, const River& river, const Setting& setting,
                      const SteadySlope& slope, std::vector<double>& load, Landscape& landscape) {
    load.assign(landscape.elevation_m.size(), 0.0);
    for (std::size_t at = drainage.order.size(); at-- > 0;) {
        const Index node = drainage.order[at];
        load[node] += edges.area(node) * setting.uplift_m_per_yr[node];
        const Slot slot = drainage.directions[node];
        if (slot != no_flow) load[edges.neighbor(node, slot)] += load[node];
    }
    for (const Index node : drainage.order) {
        const Slot slot = drainage.directions[node];
        if (slot == no_flow) continue;
        const double rise = slope.loaded(river, setting, node, drainage.area_m2[node], load[node]);
        landscape.elevation_m[node] =
            landscape.elevation_m[edges.neighbor(node, slot)] + edges.length(node, slot) * rise;
    }
}

/// Every node must have a finite steady slope whatever water it gets: rain on its own cell is the least.
template <Topology T>
void check_steady(const T& topology, const River& river, const Setting& setting) {
    if (river.flow == Flow::multiple) {
        throw Error(
            "the steady solver follows one receiver per node: use the implicit solver for multiple flow, or "
            "single flow");
    }
    if (std::isfinite(river.talus_slope)) return;
    for (Index node = 0; node < topology.size(); ++node) {
        if (setting.boundary[node] == Boundary::base_level) continue;
        if (river.g == 0 && !(setting.uplift_m_per_yr[node] > 0)) continue;  // sediment passes everywhere
        const double erosion =
            erodibility(river, setting, node) * area_power(topology.area(node) * setting.rainfall[node], river.m);
        if (erosion > 0) continue;
        throw Error(
            fmt::format("node {} rises but nothing wears it down (k·A^m is 0), so it has no steady height: give it "
                        "erodibility and rain, or set a talus angle",
                        node));
    }
}

template <Topology T>
SteadyResult solved(const T& topology, const River& river, const Setting& setting, Index max_sweeps,
                    Landscape& landscape) {
    check_setting(topology.size(), landscape, setting);
    check_river(river);
    if (!setting.uplift_factor.value.empty() || !setting.base_level_m.value.empty()) {
        throw Error("a landscape whose uplift or base level has a history has no steady state: step through time");
    }
    check_steady(topology, river, setting);
    const SteadySlope slope(river, setting);
    ExchangeWatch exchange = exchange_watch(topology.size(), patience);
    Drainage drainage;
    DrainBuffers buffers;
    std::vector<double> load;
    SteadyResult result{.sweeps = 0, .converged = false, .frozen_receivers = 0, .frozen = {}};
    while (result.sweeps < max_sweeps) {
        drain_into(topology, landscape, setting, river, exchange.frozen, drainage, buffers);
        const Index changes = observe(exchange, drainage.directions);
        result.converged = result.sweeps > 0 && changes == 0;
        if (result.converged) break;
        if (only_the_same(exchange)) freeze(exchange);
        with_flow(topology, buffers, [&](const auto& edges) {
            if (river.g == 0) return integrate(edges, drainage, slope, landscape);
            integrate_loaded(edges, drainage, river, setting, slope, load, landscape);
        });
        ++result.sweeps;
    }
    result.frozen_receivers = frozen_count(exchange);
    result.frozen = frozen_mask(exchange);
    return result;
}

}  // namespace

SteadyResult solve_steady(const Grid& grid, const River& river, const Setting& setting, Index max_sweeps,
                          Landscape& landscape) {
    return solved(grid, river, setting, max_sweeps, landscape);
}

SteadyResult solve_steady(const Mesh& mesh, const River& river, const Setting& setting, Index max_sweeps,
                          Landscape& landscape) {
    return solved(mesh, river, setting, max_sweeps, landscape);
}

}  // namespace thalweg::evolve
