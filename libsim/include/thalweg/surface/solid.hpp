// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <span>

#include "thalweg/core/mesh.hpp"
#include "thalweg/core/raster.hpp"
#include "thalweg/core/triangle_surface.hpp"

namespace thalweg::surface {

/// The mesh's triangles at the nodes' heights (m), nodes in the mesh's order; without triangles that have a corner of
/// no data (NaN), and then without nodes that no triangle needs. Throws Error unless there is one height per node.
TriangleSurface triangle_surface(const Mesh&, std::span<const double> heights_m);

/// The triangles between the cells of a grid that have data, by the cells' numbers, by the rule below.
std::vector<std::array<Index, 3>> cell_triangles(const Grid&, std::span<const double> heights_m);

/// A grid's cells as triangles between their centres, which lie at `centers` (m, one per cell): four neighbouring cells
/// make two triangles, cut along the diagonal of smaller fall (equal: from the north-west), three make one where the
/// fourth has no data. Throws Error unless there is one centre and one height per cell.
TriangleSurface triangle_surface(const Grid&, std::span<const Point> centers, std::span<const double> heights_m);

/// The surface with vertical sides down to a flat base at `base_m`, seen from below the same triangles: a closed
/// 2-manifold, every edge shared by two triangles that run along it in opposite directions. Where parts of the surface
/// touch in one vertex only, each gets its own. Linear in the number of triangles.
/// Throws Error for a base that is not below every vertex, or where more than two triangles share an edge.
TriangleSurface closed_solid(const TriangleSurface&, double base_m);

/// Volume within a closed surface, m³ (divergence theorem); positive where its triangles face outward.
double enclosed_volume(const TriangleSurface&);

}  // namespace thalweg::surface
