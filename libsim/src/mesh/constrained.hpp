// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <CGAL/Constrained_Delaunay_triangulation_2.h>
#include <CGAL/Delaunay_triangulation_2.h>
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Triangulation_face_base_with_info_2.h>
#include <CGAL/Triangulation_vertex_base_with_info_2.h>

#include <span>
#include <vector>

#include "thalweg/core/index.hpp"
#include "thalweg/core/point.hpp"

namespace thalweg::mesh {

struct Number {
    Index value = none;  ///< place in the list of points that the vertices came from
};
struct Side {
    int rings_crossed = -1;  ///< from infinity to the face; odd inside the domain, −1 if not yet known
};

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using Vertices = CGAL::Triangulation_vertex_base_with_info_2<Number, Kernel>;
using Faces =
    CGAL::Triangulation_face_base_with_info_2<Side, Kernel, CGAL::Constrained_triangulation_face_base_2<Kernel>>;
using Structure = CGAL::Triangulation_data_structure_2<Vertices, Faces>;
using Delaunay = CGAL::Delaunay_triangulation_2<Kernel, Structure>;
using Constrained =
    CGAL::Constrained_Delaunay_triangulation_2<Kernel, Structure,
                                               CGAL::No_constraint_intersection_requiring_constructions_tag>;

/// Puts the points into an empty triangulation, each beside the one before, numbered by their place in the list; gives
/// the vertices of the first so many. Throws Error if two coincide or all lie on one line.
std::vector<Constrained::Vertex_handle> insert_points(Constrained&, std::span<const Point> points, Index first_count,
                                                      std::span<const Index> order);

/// Triangulates the points, inserted in the given order, with rings through the first of them as constraints: ring r
/// through the points ring_start[r] … ring_start[r + 1] − 1. Adds points on the rings until no vertex lies in the
/// diametral disc of one of their edges (Gabriel). Numbers the vertices as `points` does and appends those added.
/// Throws Error if two points coincide or the rings cross.
void triangulate_conforming(std::vector<Point>& points, std::span<const Index> ring_start, std::span<const Index> order,
                            Constrained& constrained);

/// The rings with the points that make their edges Gabriel by themselves. Throws as above.
std::vector<Polygon> conforming_rings(const std::vector<Polygon>& rings);

}  // namespace thalweg::mesh
