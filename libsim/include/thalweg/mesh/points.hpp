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
    /// The first so many lie on the outline: in order around the outer ring, counter-clockwise, and then around each
    /// hole, clockwise.
    Index outline_count;
    std::vector<Index> hole_start = {};  ///< first point of each hole's ring
};

enum class PointPattern {
    poisson,    ///< at random, none nearer than the spacing to another, and no room for more
    hexagonal,  ///< rows of equilateral triangles, one row parallel to x; six neighbours each
    regular     ///< squares along x and y
};

/// Points on the outline: its corners, evenly spaced points between them at most `spacing_m` apart, and more where the
/// outline comes near itself, so that no point lies in the diametral disc of an outline edge.
///
/// Points inside: for `poisson` no point nearer than `spacing_m` to any other, and no room for another (a gap under a
/// millionth of the spacing apart): Bridson's (2007) front on a background grid, its remaining gaps filled by
/// quartering (Ebeida et al. 2012). Linear in the number of points and of grid cells (2 per spacing² of the bounding
/// box); about 0.7 area / spacing² points. The same seed gives the same points on every machine.
/// A lattice's rows and columns are stretched by up to half a step in all to end on the bounding box; of its points
/// those nearer than 0.7 spacings to one on the outline are left out. A rectangle along the axes gets the whole
/// lattice. The seed does not matter to it. Throws Error for a spacing that is not positive, or too fine for 32-bit
/// numbers, or rings that are not simple polygons of positive area (either orientation) apart from each other.
PointSet place_points(const PolygonPart& domain, PointPattern, double spacing_m, std::uint64_t seed);

/// The same for a wanted number of points, met within 2 % (under 50 points within one, where the outline's shape leaves
/// only even numbers, say). The spacing is corrected until it is: once or twice, but more often for under 1000 points;
/// a lattice's steps along x and y may come to differ by up to 6 % for it.
/// Throws Error for fewer than 16 or more than 2^31 points, an outline with more corners than points wanted, or rings
/// as above.
PointSet place_points_count(const PolygonPart& domain, PointPattern, Index count, std::uint64_t seed);

/// Poisson-disk points in a polygon without holes.
PointSet poisson_disk(const Polygon& outline, double spacing_m, std::uint64_t seed);
PointSet poisson_disk_count(const Polygon& outline, Index count, std::uint64_t seed);

}  // namespace thalweg::mesh
