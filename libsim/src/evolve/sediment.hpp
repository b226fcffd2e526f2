// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <cmath>
#include <vector>

#include "evolve/erosion.hpp"

namespace thalweg::evolve {

/// What holds a node where it is.
enum class Hold : std::uint8_t {
    river,   // erosion, deposition and uplift balance, on a slope
    level,   // no slope to its receiver: uplift and deposition only
    filled,  // deposition has reached the water's level
    talus    // the steepest stable slope
};

/// A quantity of a subtree as a function of the height of the receiver at its foot and of the water level there.
struct Answer {
    double constant = 0, by_receiver = 0, by_water = 0;

    void add(const Answer& other) {
        constant += other.constant;
        by_receiver += other.by_receiver;
        by_water += other.by_water;
    }
};

/// What lies below a node, at the end of the step.
struct Foot {
    double receiver_m;
    double water_m;  // the highest ground from the receiver down to the outlet
};

/// What does not change about a node during the step.
struct SedimentNode {
    double raised_m;  // h + dt·u
    double length_m;
    double area_m2;
    double c;      // dt·k·A^m
    double per_q;  // G/A: height laid down per volume of sediment
    bool in_lake;  // when the step begins
};

/// A node's place in an iteration.
struct SedimentState {
    Hold hold = Hold::level;
    bool under_water = false;
    double slope = 0;
    double incision_m = 0;
};

/// Solves a node's own equation, the sediment from above answering as `above` says (to its height and to the water's).
/// With κ = 1 + G·a/A less what the answer takes, the equation is κ·d·S + c·S^n = drop.
class SedimentSolver {
  public:
    SedimentSolver(const SlopeSolver& solve, double talus_slope) : solve_(solve), talus_slope_(talus_slope) {}

    double operator()(const SedimentNode& node, const Foot& foot, const Answer& above, SedimentState& state) const {
        double height = balance(node, foot, above, false, state);
        if (node.in_lake && height > foot.water_m && node.raised_m < foot.water_m) {
            height = foot.water_m;
            state.hold = Hold::filled;
        } else if (height < foot.water_m) {
            height = balance(node, foot, above, true, state);
        }
        const double steepest_m = foot.receiver_m + talus_slope_ * node.length_m;
        if (height > steepest_m) {
            height = steepest_m;
            state.hold = Hold::talus;
        }
        state.under_water = height < foot.water_m;
        return height;
    }

  private:
    /// The height at which uplift, river and sediment balance. Under water the level above hangs on what lies below;
    /// elsewhere it is the node's own height.
    double balance(const SedimentNode& node, const Foot& foot, const Answer& above, bool under_water,
                   SedimentState& state) const {
        const double own = 1 + node.per_q * node.area_m2;
        const double by_height = above.by_receiver + (under_water ? 0 : above.by_water);
        const double water = under_water ? above.by_water * foot.water_m : 0;
        const double kappa = own - node.per_q * by_height;
        // own·(b − h_r) and not own·b − κ·h_r: a thin layer on a high mountain keeps its digits.
        const double sediment = above.constant + water + by_height * foot.receiver_m;
        const double drop = own * (node.raised_m - foot.receiver_m) + node.per_q * sediment;
        if (!(drop > 0)) {
            state = {Hold::level, under_water, 0, 0};
            return foot.receiver_m + drop / kappa;
        }
        const SlopeAndIncision solution = solve_(drop, kappa * node.length_m, node.c);
        state = {Hold::river, under_water, solution.slope, solution.incision_m};
        return foot.receiver_m + node.length_m * solution.slope;
    }

    const SlopeSolver& solve_;
    double talus_slope_;
};

/// How the node's height answers, held as it is, with the tangent of its incision.
inline Answer height_answer(const SedimentNode& node, const Answer& above, const SedimentState& state,
                            const River& river) {
    if (state.hold == Hold::filled) return {0, 0, 1};
    if (state.hold == Hold::talus) return {river.talus_slope * node.length_m, 1, 0};
    const bool wet = state.under_water;
    const double by_height = above.by_receiver + (wet ? 0 : above.by_water);
    const double by_water = wet ? node.per_q * above.by_water : 0;
    const double own = 1 + node.per_q * node.area_m2;
    const double kappa = own - node.per_q * by_height;
    const double source = own * node.raised_m + node.per_q * above.constant;
    if (state.hold == Hold::level) return {source / kappa, 0, by_water / kappa};
    const double rise =
        river.n == 1 ? node.c : river.n * state.incision_m / state.slope;  // of the incision with the slope
    if (!std::isfinite(rise)) return {0, 1, 0};
    const double inverse = 1 / (kappa * node.length_m + rise);
    return {node.length_m * (source - state.incision_m + rise * state.slope) * inverse, rise * inverse,
            node.length_m * by_water * inverse};
}

/// How the sediment that leaves the node answers.
inline Answer sediment_answer(const SedimentNode& node, const Answer& above, const SedimentState& state,
                              const Answer& height) {
    const double by_height = above.by_receiver + (state.under_water ? 0 : above.by_water) - node.area_m2;
    return {above.constant + by_height * height.constant + node.area_m2 * node.raised_m, by_height * height.by_receiver,
            by_height * height.by_water + (state.under_water ? above.by_water : 0)};
}

}  // namespace thalweg::evolve
