// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <vector>

#include "thalweg/core/index.hpp"
#include "thalweg/core/point.hpp"

namespace thalweg::mesh {

/// Points in a polygon: first along the outline (its corners and points about `spacing` apart), then inside.
struct PointSet {
    std::vector<Point> points;
    Index outline_count;   ///< the first so many lie on the outline, in order around it
};

/// Poisson-disk points (Bridson 2007): no two interior points nearer than `spacing_m`, and no room for another.
/// The same seed gives the same points.
PointSet poisson_disk(const Polygon& outline, double spacing_m, std::uint64_t seed);

/// The same for a wanted number of points, met within 2 % (the spacing is corrected until it is).
/// Throws Error for fewer than 16 or more than 2^31 points, or an outline that is not a simple polygon of positive area.
PointSet poisson_disk_count(const Polygon& outline, Index count, std::uint64_t seed);

}  // namespace thalweg::mesh
