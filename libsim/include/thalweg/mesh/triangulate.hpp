// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "thalweg/core/mesh.hpp"
#include "thalweg/mesh/points.hpp"

namespace thalweg::mesh {

/// Delaunay triangulation of the points with the outline as constraint, as a `Mesh`: nodes renumbered along a Hilbert
/// curve, Voronoi cell areas clipped to the domain (they add up to its area to rounding). Where an outline edge would
/// not be Delaunay by itself, points are added on it.
Mesh triangulate(const Polygon& outline, const PointSet&);

/// Signed area of a polygon, m²; positive when counter-clockwise.
double polygon_area(const Polygon&);

}  // namespace thalweg::mesh
