// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <limits>
#include <span>

#include "evolve/erosion.hpp"
#include "thalweg/terrain/multiple_flow.hpp"

namespace thalweg::evolve {

/// The receivers of one node once they have taken their step.
struct Receivers {
    std::span<const Index> node;
    std::span<const double> length;
    std::span<const double> share;

    std::size_t size() const { return node.size(); }
};

inline Receivers receivers_of(const terrain::MultipleFlow& flow, Index node) {
    const std::size_t first = flow.offset[node];
    const std::size_t count = flow.offset[node + 1] - first;
    return {std::span(flow.receiver).subspan(first, count), std::span(flow.length).subspan(first, count),
            std::span(flow.share).subspan(first, count)};
}

inline double lowest_of(const Receivers& receivers, std::span<const double> elevation_m) {
    double lowest = std::numeric_limits<double>::infinity();
    for (const Index receiver : receivers.node) lowest = std::min(lowest, elevation_m[receiver]);
    return lowest;
}

/// Height above `datum` at which the talus limit holds towards every receiver.
inline double talus_height(const Receivers& receivers, std::span<const double> elevation_m, double datum,
                           double talus_slope) {
    double height = std::numeric_limits<double>::infinity();
    for (std::size_t r = 0; r < receivers.size(); ++r) {
        height = std::min(height, elevation_m[receivers.node[r]] - datum + talus_slope * receivers.length[r]);
    }
    return height;
}

/// What a node of height `y` above `datum` has become, the talus limit included.
inline NodeStep settle(const Receivers& receivers, std::span<const double> elevation_m, double datum, double y,
                       double incision_m, double talus_slope, int iterations) {
    double height = y;
    if (talus_slope < std::numeric_limits<double>::infinity()) {
        height = std::min(y, talus_height(receivers, elevation_m, datum, talus_slope));
    }
    return {.elevation_m = datum + height, .incision_m = incision_m, .talus_m = y - height, .iterations = iterations};
}

/// n = 1: y·(1 + Σ g) = drop + Σ g·d over the receivers that lie below y, d their heights above the lowest, g = c·w/L.
/// From the assumption that all below the uplifted node do; leaving those out that do not only lowers y, so a few
/// rounds end it.
inline NodeStep step_linear(double raised, const Receivers& receivers, std::span<const double> elevation_m, double c,
                            double talus_slope) {
    const double datum = lowest_of(receivers, elevation_m);
    const double drop = raised - datum;
    if (!(drop > 0)) return {raised};
    double y = drop, highest = drop, incision_m = 0;
    while (highest >= y) {
        const double bound = y;
        double moved = 0, weight = 0;
        highest = 0;
        for (std::size_t r = 0; r < receivers.size(); ++r) {
            const double d = elevation_m[receivers.node[r]] - datum;
            if (d >= bound) continue;
            const double g = c * receivers.share[r] / receivers.length[r];
            moved += g * d;
            weight += g;
            highest = std::max(highest, d);
        }
        y = (drop + moved) / (1 + weight);
        incision_m = weight * y - moved;
    }
    return settle(receivers, elevation_m, datum, y, incision_m, talus_slope, 0);
}

/// n ≠ 1, for two receivers or more.
NodeStep step_power(double raised, const Receivers&, std::span<const double> elevation_m, double c, double n,
                    const SlopeSolver&, double talus_slope);

inline NodeStep step_divided(double raised, const Receivers& receivers, std::span<const double> elevation_m, double c,
                             const River& river, const SlopeSolver& solve) {
    if (receivers.size() == 1) {
        return step_node(raised, elevation_m[receivers.node[0]], receivers.length[0], c, solve, river.talus_slope);
    }
    if (river.n == 1) return step_linear(raised, receivers, elevation_m, c, river.talus_slope);
    return step_power(raised, receivers, elevation_m, c, river.n, solve, river.talus_slope);
}

/// Asks for the receivers of the nodes that come next.
[[gnu::always_inline]] inline void fetch_receivers(const terrain::MultipleFlow& flow, std::span<const Index> order,
                                                   std::size_t at) {
    if (at + 2 * ahead < order.size()) __builtin_prefetch(&flow.offset[order[at + 2 * ahead]]);
    if (at + ahead >= order.size()) return;
    const Index first = flow.offset[order[at + ahead]];
    __builtin_prefetch(flow.receiver.data() + first);
    __builtin_prefetch(flow.length.data() + first);
    __builtin_prefetch(flow.share.data() + first);
}

/// One sweep from the outlets up along divided flow. A node without receiver is left where it is and is in no sum.
template <class Edges>
StepSums erode_divided(const Edges& edges, const Drainage& drainage, const River& river, const SlopeSolver& solve,
                       const Setting& setting, double dt_yr, Landscape& landscape) {
    StepSums sums;
    const std::span<double> elevation = landscape.elevation_m;
    const std::span<const Index> order = drainage.order;
    const double* const relative_k = setting.relative_erodibility.empty() ? nullptr : &setting.relative_erodibility[0];
    for (std::size_t at = 0; at < order.size(); ++at) {
        if (at + ahead < order.size()) fetch(order[at + ahead], drainage, setting, elevation);
        fetch_receivers(drainage.flow, order, at);
        const Index node = order[at];
        const Receivers receivers = receivers_of(drainage.flow, node);
        if (receivers.size() == 0) continue;
        const double before = elevation[node];
        const double uplift_m = dt_yr * setting.uplift_m_per_yr[node];
        const double k = relative_k == nullptr ? river.k : river.k * relative_k[node];
        const NodeStep step = step_divided(before + uplift_m, receivers, elevation,
                                           dt_yr * k * area_power(drainage.area_m2[node], river.m), river, solve);
        elevation[node] = step.elevation_m;
        sums.add(edges.area(node), uplift_m, step.elevation_m - before, step);
    }
    sums.carry();
    landscape.time_yr += dt_yr;
    return sums;
}

/// One step of the river along whichever flow the drainage has.
template <class Edges>
StepSums dig(const Edges& edges, const Drainage& drainage, const River& river, const SlopeSolver& solve,
             const Setting& setting, double dt_yr, Landscape& landscape) {
    if (drainage.flow.size() > 0) return erode_divided(edges, drainage, river, solve, setting, dt_yr, landscape);
    return erode_along(edges, drainage, river, solve, setting, dt_yr, landscape);
}

}  // namespace thalweg::evolve
