// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "thalweg/core/point.hpp"

namespace thalweg::grow {

/// Where a network grows: a basin and its main stream, from which all others branch.
struct Basin {
    Polygon outline;          ///< any simple polygon, either orientation, m
    Point outlet;             ///< lower end of the trunk, on the outline, m
    Point source;             ///< upper end of the trunk, inside, m
    double base_level_m = 0;  ///< elevation of the outlet
};

/// The point of a closed outline that is nearest to `p`. No two neighbouring corners may be the same.
Point nearest_on_outline(const Polygon& outline, const Point& p);

/// The basin with its outline counter-clockwise and without repeated corners, and the outlet put onto the outline
/// (where it may lie off by a millionth of the basin's size). Throws Error for an outline that is not a simple polygon
/// of positive area, an outlet off it, a source that is not inside, a trunk that leaves the basin, or a base level that
/// is not finite.
Basin checked_basin(const Basin&);

}  // namespace thalweg::grow
