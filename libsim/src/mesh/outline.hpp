// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "thalweg/core/point.hpp"

namespace thalweg::mesh {

/// The rings around a domain: the outer one counter-clockwise, then those of its holes, clockwise.
using Rings = std::vector<Polygon>;

/// The outline, counter-clockwise, without corners that repeat the one before.
/// Throws Error if it is not a simple polygon of positive area with finite corners, and says where it meets itself.
Polygon checked_outline(const Polygon& outline);

/// The rings of a domain. Throws Error as above for each of them, and if two rings touch, or a hole lies outside the
/// outer ring or in another hole.
Rings checked_rings(const PolygonPart& domain);

}  // namespace thalweg::mesh
