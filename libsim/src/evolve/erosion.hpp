// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <cmath>

#include "evolve/compensated_sum.hpp"
#include "evolve/edges.hpp"
#include "evolve/slope_solver.hpp"
#include "thalweg/evolve/river.hpp"

namespace thalweg::evolve {

/// A^m. The square root differs from pow(A, 0.5) by rounding at most.
inline double area_power(double area, double m) {
    if (m == 0.5) return std::sqrt(area);
    return m == 1 ? area : std::pow(area, m);
}

/// What happens to one node in one step.
struct NodeStep {
    double elevation_m;
    double incision_m = 0;
    double talus_m = 0;
    int iterations = 0;
};

/// The node, uplifted to `raised`, above a receiver that has already taken its step. Works with the drop and not with
/// heights, so that a thin layer taken from a high mountain keeps all its digits.
inline NodeStep step_node(double raised, double receiver_m, double length, double c, const River& river) {
    const double drop = raised - receiver_m;
    if (!(drop > 0)) return {raised};
    const SlopeAndIncision solution = solve_slope(drop, length, c, river.n);
    const double slope = std::min(solution.slope, river.talus_slope);
    return {.elevation_m = receiver_m + length * slope,
            .incision_m = solution.incision_m,
            .talus_m = length * (solution.slope - slope),
            .iterations = solution.iterations};
}

/// Sums over the nodes of a step, in the order of the sweep.
struct StepSums {
    CompensatedSum area, uplifted, incised, talus, stored, moved;
    double largest_change = 0;
    int iterations = 0;

    void add(double cell_area, double uplift_m, double change_m, const NodeStep& node) {
        area.add(cell_area);
        uplifted.add(cell_area * uplift_m);
        incised.add(cell_area * node.incision_m);
        talus.add(cell_area * node.talus_m);
        stored.add(cell_area * change_m);
        moved.add(cell_area * std::abs(change_m));
        largest_change = std::max(largest_change, std::abs(change_m));
        iterations = std::max(iterations, node.iterations);
    }

    StepReport report(double dt_yr) const {
        const double total = area.value();
        return {.max_rate_m_per_yr = largest_change / dt_yr,
                .mean_rate_m_per_yr = total > 0 ? moved.value() / total / dt_yr : 0,
                .largest_newton_iterations = iterations,
                .mass = {.uplifted_m3 = uplifted.value(),
                         .eroded_m3 = incised.value(),
                         .talus_m3 = talus.value(),
                         .exported_m3 = incised.value() + talus.value(),
                         .stored_m3 = stored.value()}};
    }
};

template <class Edges>
StepSums erode_along(const Edges& edges, const Drainage& drainage, const River& river, const Setting& setting,
                     double dt_yr, Landscape& landscape) {
    StepSums sums;
    std::vector<double>& elevation = landscape.elevation_m;
    const double dt_k = dt_yr * river.k;
    for (const Index node : drainage.order) {
        const Slot slot = drainage.directions[node];
        if (slot == no_flow) continue;  // base level, or the outlet of a piece that has none
        const double before = elevation[node];
        const double uplift_m = dt_yr * setting.uplift_m_per_yr[node];
        const NodeStep step =
            step_node(before + uplift_m, elevation[edges.neighbor(node, slot)], edges.length(node, slot),
                      dt_k * area_power(drainage.area_m2[node], river.m), river);
        elevation[node] = step.elevation_m;
        sums.add(edges.area(node), uplift_m, step.elevation_m - before, step);
    }
    landscape.time_yr += dt_yr;
    return sums;
}

}  // namespace thalweg::evolve
