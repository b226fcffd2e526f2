// SPDX-License-Identifier: GPL-3.0-or-later
#include "evolve/slope_solver.hpp"
#include "thalweg/evolve/river.hpp"

namespace thalweg::evolve {

SlopeSolution implicit_slope(double drop, double length, double c, double n) {
    if (!(drop > 0)) return {0, 0};
    const SlopeAndIncision solution = solve_slope(drop, length, c, n);
    return {solution.slope, solution.iterations};
}

double MassBalance::relative_residual() const {
    return uplifted_m3 == 0 ? 0 : (uplifted_m3 - exported_m3 - stored_m3) / uplifted_m3;
}

}  // namespace thalweg::evolve
