// SPDX-License-Identifier: GPL-3.0-or-later
#include "mesh/outline.hpp"

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Polygon_2_algorithms.h>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "thalweg/core/error.hpp"
#include "thalweg/mesh/triangulate.hpp"

namespace thalweg::mesh {
namespace {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;

bool is_simple(const Polygon& outline) {
    std::vector<Kernel::Point_2> corners;
    for (const Point& p : outline) corners.emplace_back(p.x, p.y);
    return CGAL::is_simple_2(corners.begin(), corners.end(), Kernel());
}

}  // namespace

double polygon_area(const Polygon& polygon) {
    double twice_area = 0;  // relative to one corner, or map coordinates of millions of metres would eat the digits
    for (std::size_t i = 2; i < polygon.size(); ++i) {
        const Point a{polygon[i - 1].x - polygon[0].x, polygon[i - 1].y - polygon[0].y};
        const Point b{polygon[i].x - polygon[0].x, polygon[i].y - polygon[0].y};
        twice_area += a.x * b.y - a.y * b.x;
    }
    return twice_area / 2;
}

Polygon checked_outline(const Polygon& outline) {
    if (outline.size() < 3) throw Error(fmt::format("an outline needs at least 3 corners, not {}", outline.size()));
    for (const Point& p : outline) {
        if (!std::isfinite(p.x) || !std::isfinite(p.y)) {
            throw Error(fmt::format("the outline has a corner at ({}, {}): all need finite coordinates", p.x, p.y));
        }
    }
    const double area = polygon_area(outline);
    if (!(std::abs(area) > 0)) throw Error("the outline encloses no area: its corners lie on one line");
    if (!is_simple(outline)) {
        throw Error("the outline crosses or touches itself: it must be one simple ring without repeated corners");
    }
    Polygon checked = outline;
    if (area < 0) std::reverse(checked.begin(), checked.end());
    return checked;
}

}  // namespace thalweg::mesh
