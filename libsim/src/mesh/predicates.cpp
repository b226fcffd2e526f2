// SPDX-License-Identifier: GPL-3.0-or-later
#include "thalweg/mesh/predicates.hpp"

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Polygon_2_algorithms.h>

#include <vector>

#include "mesh/outline.hpp"

namespace thalweg::mesh {
namespace {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;

Kernel::Point_2 exact(const Point& p) { return {p.x, p.y}; }

}  // namespace

int orientation(const Point& a, const Point& b, const Point& c) {
    return static_cast<int>(CGAL::orientation(exact(a), exact(b), exact(c)));
}

bool segments_cross(const Point& a, const Point& b, const Point& c, const Point& d) {
    return orientation(a, b, c) * orientation(a, b, d) < 0 && orientation(c, d, a) * orientation(c, d, b) < 0;
}

bool is_simple(const Polygon& polygon) {
    std::vector<Kernel::Point_2> corners;
    for (const Point& p : polygon) corners.push_back(exact(p));
    return CGAL::is_simple_2(corners.begin(), corners.end(), Kernel());
}

Polygon simple_polygon(const Polygon& polygon) { return checked_outline(polygon); }

std::vector<Polygon> simple_rings(const PolygonPart& part) { return checked_rings(part); }

}  // namespace thalweg::mesh
