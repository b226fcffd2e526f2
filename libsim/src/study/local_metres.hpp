// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "thalweg/core/raster.hpp"

namespace thalweg::study {

/// A raster's cells on a plane in metres near the origin, for what counts with few digits: meshes and pictures.
struct LocalMetres {
    Point origin;                ///< map coordinates of the plane's (0, 0)
    double unit_m;               ///< of the map's coordinates; NaN where they are degrees
    std::vector<Point> centers;  ///< of the cells
};

/// Projected: from the south-west corner, rounded down to whole map units. Degrees: Lambert's azimuthal equal-area
/// plane about the raster's middle.
LocalMetres local_metres(const Raster&);

}  // namespace thalweg::study
