// SPDX-License-Identifier: GPL-3.0-or-later
// One river on a row of cells, its mouth at the left end; the rain is such that the drainage area is any given function
// of the distance from the mouth. So the landscape model solves the one-dimensional equation whose answer is known.
#pragma once

#include "thalweg/evolve/simulate.hpp"

namespace thalweg::validation {

struct SingleRiver {
    Grid grid;
    double step_m;
    std::vector<double> area_m2;
    evolve::Setting setting;
    evolve::Landscape landscape;

    double distance(Index node) const { return node * step_m; }
};

/// `area_of(x)`: drainage area (m²) at x from the mouth, not growing with x.
template <class AreaOf>
SingleRiver single_river(Index steps, double length_m, double uplift_m_per_yr, AreaOf area_of) {
    SingleRiver river;
    river.step_m = length_m / steps;
    river.grid = plane_grid(1, steps + 1, river.step_m, river.step_m);
    for (Index node = 0; node <= steps; ++node) river.area_m2.push_back(area_of(river.distance(node)));
    const double cell = river.step_m * river.step_m;
    for (Index node = 0; node <= steps; ++node) {
        const double from_above = node < steps ? river.area_m2[node + 1] : 0;
        river.setting.rainfall.push_back((river.area_m2[node] - from_above) / cell);
        river.setting.boundary.push_back(node == 0 ? Boundary::base_level : Boundary::interior);
    }
    river.setting.uplift_m_per_yr.assign(steps + 1, uplift_m_per_yr);
    for (Index node = 0; node <= steps; ++node) river.landscape.elevation_m.push_back(1e-9 * node);  // it drains west
    return river;
}

inline void run_for(SingleRiver& river, const evolve::River& law, double years, double step_yr) {
    const auto steps = static_cast<Index>(std::llround(years / step_yr));
    evolve::simulate(river.grid, {law}, river.setting, {.step_yr = years / steps, .max_steps = steps, .convergence = 0},
                     river.landscape);
}

/// Where values that change from above to below `level` pass it: place between two nodes, by interpolation.
inline double crossing(const std::vector<double>& values, double level) {
    for (std::size_t i = 0; i + 1 < values.size(); ++i) {
        if (values[i] >= level && values[i + 1] < level) {
            return static_cast<double>(i) + (values[i] - level) / (values[i] - values[i + 1]);
        }
    }
    return std::numeric_limits<double>::quiet_NaN();
}

}  // namespace thalweg::validation
