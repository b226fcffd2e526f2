// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <vector>

#include "thalweg/core/index.hpp"
#include "thalweg/core/point.hpp"

namespace thalweg::mesh {

/// Points in a polygon: first on the outline, then inside.
struct PointSet {
    std::vector<Point> points;
    Index outline_count;  ///< the first so many lie on the outline, in order around it, counter-clockwise
};

/// Poisson-disk points. On the outline: its corners, evenly spaced points between them at most `spacing_m` apart, and
/// more where the outline comes near itself, so that no point lies in the diametral disc of an outline edge. Inside: no
/// point nearer than `spacing_m` to any other, and no room for another (a gap under a millionth of the spacing apart).
///
/// Bridson's (2007) front on a background grid, its remaining gaps filled by quartering (Ebeida et al. 2012). Linear in
/// the number of points and of grid cells (2 per spacing² of the bounding box); about 0.7 area / spacing² points.
/// The same seed gives the same points on every machine.
/// Throws Error for a spacing that is not positive, or too fine for 32-bit numbers, or an outline that is not a simple
/// polygon of positive area (either orientation).
PointSet poisson_disk(const Polygon& outline, double spacing_m, std::uint64_t seed);

/// The same for a wanted number of points, met within 2 % (under 50 points within one, where the outline's shape leaves
/// only even numbers, say). The spacing is corrected until it is: once or twice, but more often for under 1000 points.
/// Throws Error for fewer than 16 or more than 2^31 points, an outline with more corners than points wanted, or one
/// that is not a simple polygon of positive area.
PointSet poisson_disk_count(const Polygon& outline, Index count, std::uint64_t seed);

}  // namespace thalweg::mesh
