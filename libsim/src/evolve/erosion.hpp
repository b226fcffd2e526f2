// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <cmath>
#include <span>

#include "evolve/compensated_sum.hpp"
#include "evolve/drainage.hpp"
#include "evolve/edges.hpp"
#include "thalweg/evolve/river.hpp"
#include "thalweg/evolve/slope.hpp"

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
inline NodeStep step_node(double raised, double receiver_m, double length, double c, const SlopeSolver& solve,
                          double talus_slope) {
    const double drop = raised - receiver_m;
    if (!(drop > 0)) return {raised};
    const SlopeAndIncision solution = solve(drop, length, c);
    const double slope = std::min(solution.slope, talus_slope);
    return {.elevation_m = receiver_m + length * slope,
            .incision_m = solution.incision_m,
            .talus_m = length * (solution.slope - slope),
            .iterations = solution.iterations};
}

/// Sums over the nodes of a step, in the order of the sweep.
struct StepSums {
    CompensatedSum uplifted, incised, talus, stored;
    double area = 0;
    double moved = 0;
    double largest_change = 0;
    int iterations = 0;

    void add(double cell_area, double uplift_m, double change_m, const NodeStep& node) {
        area += cell_area;
        uplifted.add(cell_area * uplift_m);
        incised.add(cell_area * node.incision_m);
        talus.add(cell_area * node.talus_m);
        stored.add(cell_area * change_m);
        moved += cell_area * std::abs(change_m);
        largest_change = std::max(largest_change, std::abs(change_m));
        iterations = std::max(iterations, node.iterations);
    }

    StepReport report(double dt_yr) const {
        return {.max_rate_m_per_yr = largest_change / dt_yr,
                .mean_rate_m_per_yr = area > 0 ? moved / area / dt_yr : 0,
                .largest_newton_iterations = iterations,
                .mass = {.uplifted_m3 = uplifted.value(),
                         .eroded_m3 = incised.value(),
                         .talus_m3 = talus.value(),
                         .exported_m3 = incised.value() + talus.value(),
                         .stored_m3 = stored.value()}};
    }
};

/// Asks for what the sweep will need of a node.
inline void fetch(Index node, const Drainage& drainage, const Setting& setting, std::span<const double> elevation_m) {
    __builtin_prefetch(&drainage.directions[node]);
    __builtin_prefetch(&drainage.area_m2[node]);
    __builtin_prefetch(&setting.uplift_m_per_yr[node]);
    if (!setting.relative_erodibility.empty()) __builtin_prefetch(&setting.relative_erodibility[node]);
    __builtin_prefetch(&elevation_m[node]);
}

/// One sweep from the outlets up. A node without receiver is left where it is and is in no sum.
template <class Edges>
StepSums erode_along(const Edges& edges, const Drainage& drainage, const River& river, const SlopeSolver& solve,
                     const Setting& setting, double dt_yr, Landscape& landscape) {
    StepSums sums;
    const std::span<double> elevation = landscape.elevation_m;
    const std::span<const Index> order = drainage.order;
    const double dt_k = dt_yr * river.k;
    const double* const relative_k = setting.relative_erodibility.empty() ? nullptr : &setting.relative_erodibility[0];
    for (std::size_t at = 0; at < order.size(); ++at) {
        if (at + ahead < order.size()) fetch(order[at + ahead], drainage, setting, elevation);
        const Index node = order[at];
        const Slot slot = drainage.directions[node];
        if (slot == no_flow) continue;  // base level, or the outlet of a piece that has none
        const double before = elevation[node];
        const double uplift_m = dt_yr * setting.uplift_m_per_yr[node];
        const double dt_k_here = relative_k == nullptr ? dt_k : dt_k * relative_k[node];
        const NodeStep step =
            step_node(before + uplift_m, elevation[edges.neighbor(node, slot)], edges.length(node, slot),
                      dt_k_here * area_power(drainage.area_m2[node], river.m), solve, river.talus_slope);
        elevation[node] = step.elevation_m;
        sums.add(edges.area(node), uplift_m, step.elevation_m - before, step);
    }
    landscape.time_yr += dt_yr;
    return sums;
}

}  // namespace thalweg::evolve
