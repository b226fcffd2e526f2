// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "thalweg/core/mesh.hpp"
#include "thalweg/mesh/points.hpp"

namespace thalweg::mesh {

/// Delaunay triangulation of the points with the outline and its holes as constraints (the rings through the first
/// `outline_count` points; only the outer ring becomes `Mesh::outline`), as a `Mesh`: nodes renumbered along a Hilbert
/// curve, Voronoi cells clipped to the domain.
///
/// Where a vertex lies in the diametral disc of an outline edge, points are added on that edge (conforming Gabriel);
/// none are for the points of `points.hpp`. Then every circumcentre lies in the domain, and the cell areas are sums of
/// signed circumcentric pieces |vw|² cot(u) / 8 (Meyer et al. 2003): each positive, their sum the domain's area, to
/// 1e-12 relative as measured; 1e-9 is checked. Edges outside a concave outline are left out. Outline corners must be
/// among the points. The same points give the same mesh to the last bit. Linear along the curve: under 1 µs per node.
/// Throws Error for an outline that is not a simple polygon of positive area, points that coincide or lie outside it,
/// and outline points that do not follow it.
Mesh triangulate(const PolygonPart& domain, const PointSet&);
Mesh triangulate(const Polygon& outline, const PointSet&);

/// Signed area of a polygon, m²; positive when counter-clockwise.
double polygon_area(const Polygon&);

}  // namespace thalweg::mesh
