// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "thalweg/core/point.hpp"

namespace thalweg::mesh {

/// On which side of the line a → b the point c lies: 1 left, −1 right, 0 on it. Exact for any finite coordinates.
int orientation(const Point& a, const Point& b, const Point& c);

/// Whether the segments a–b and c–d cross in a point inside both, exactly; touching or overlapping is no crossing.
bool segments_cross(const Point& a, const Point& b, const Point& c, const Point& d);

/// Whether no two sides of the ring cross or touch but neighbours at their corner; exact. Cost: n log n.
bool is_simple(const Polygon&);

/// The polygon, counter-clockwise, without corners that repeat the one before (the last one's is the first), as many
/// programs write them.
/// Throws Error if it is not a simple polygon of positive area with finite corners, and says where it meets itself.
Polygon simple_polygon(const Polygon&);

/// The rings of a part: the outer one counter-clockwise, then its holes clockwise.
/// Throws Error as above for each of them, and if two rings touch, or a hole lies outside the outer ring or in another.
std::vector<Polygon> simple_rings(const PolygonPart&);

}  // namespace thalweg::mesh
