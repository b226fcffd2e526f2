// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <vector>

#include "mesh/outline.hpp"
#include "thalweg/mesh/points.hpp"

namespace thalweg::mesh {

/// Into how many pieces a side is cut, none of them longer than a step (but for rounding), lengths along x and y
/// counted in steps of their own.
double pieces_of_side(const Point& a, const Point& b, const Point& step);

/// The rings cut so, evenly: corners, points between them, then `extra` more, each where the gaps are widest; and what
/// else it takes that no point of a ring lies in the diametral disc of a ring's edge.
std::vector<Polygon> divide_rings(const Rings&, const Point& step, int extra);

/// Nothing but the rings' points.
PointSet points_on_rings(const std::vector<Polygon>& rings);

/// A point one spacing away from all the rings' points is 0.86 spacings away from the rings themselves and in no edge's
/// diametral disc, so what is put inside needs no more points on the outline.
PointSet fill_poisson(const Rings&, double spacing, int extra, std::uint64_t seed);

/// Rows of points anchored at the south-west corner of the bounding box, whose width and height are whole numbers of
/// steps; `stretch` is the ratio of the steps along x and y, 1 for squares or equilateral triangles. Points nearer to a
/// point of the rings than 0.7072 steps are left out: these may lie in the diametral disc of an edge.
PointSet fill_lattice(const Rings&, PointPattern, double spacing, double stretch, int extra);

}  // namespace thalweg::mesh
