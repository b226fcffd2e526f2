// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <span>
#include <vector>

#include "thalweg/core/grid.hpp"

namespace thalweg::terrain {

/// A closed depression filled to its pass.
struct StandingWater {
    Index lowest;    ///< its lowest cell (ties: lower index)
    double depth_m;  ///< there
    double area_m2;  ///< under water
};

/// All of them, and in which each cell lies (`none`: dry). Cells under water hang together by sides and corners; those
/// of another level are another water. Numbered by their first cell. Linear.
struct StandingWaters {
    std::vector<StandingWater> waters;
    std::vector<Index> of_cell;
};
StandingWaters standing_waters(const Grid&, std::span<const double> elevation_m, std::span<const double> filled_m);

}  // namespace thalweg::terrain
