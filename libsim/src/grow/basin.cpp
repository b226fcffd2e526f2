// SPDX-License-Identifier: GPL-3.0-or-later
#include "thalweg/grow/basin.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "grow/plane.hpp"
#include "thalweg/core/error.hpp"
#include "thalweg/mesh/predicates.hpp"

namespace thalweg::grow {
namespace {

constexpr double on_outline = 1e-6;  // of the basin's size: nearer points are on the outline

Point nearest_on_segment(const Point& a, const Point& b, const Point& p) {
    const double at = dot(p - a, b - a) / dot(b - a, b - a);
    return at <= 0 ? a : at >= 1 ? b : a + at * (b - a);
}

double bounding_diagonal(const Polygon& outline) {
    Point low = outline[0];
    Point high = outline[0];
    for (const Point& p : outline) {
        low = {std::min(low.x, p.x), std::min(low.y, p.y)};
        high = {std::max(high.x, p.x), std::max(high.y, p.y)};
    }
    return norm(high - low);
}

/// Even–odd rule with exact predicates.
bool is_inside(const Polygon& outline, const Point& p) {
    bool inside = false;
    for (std::size_t i = 0; i < outline.size(); ++i) {
        const Point& a = outline[i];
        const Point& b = outline[(i + 1) % outline.size()];
        if ((a.y > p.y) == (b.y > p.y)) continue;
        const bool upward = b.y > a.y;
        if ((mesh::orientation(a, b, p) > 0) == upward) inside = !inside;
    }
    return inside;
}

/// The outlet on the outline, in a corner if that is as near as can be told.
Point outlet_on_outline(const Polygon& outline, const Point& outlet) {
    const double tolerance = on_outline * bounding_diagonal(outline);
    const Point nearest = nearest_on_outline(outline, outlet);
    if (!(norm(nearest - outlet) <= tolerance)) {
        throw Error(fmt::format("the trunk's outlet ({}, {}) is {:.6g} m off the basin's outline: it must lie on it",
                                outlet.x, outlet.y, norm(nearest - outlet)));
    }
    for (const Point& corner : outline) {
        if (norm(corner - nearest) <= tolerance) return corner;
    }
    return nearest;
}

void check_source(const Polygon& outline, const Point& source) {
    const double off_outline = norm(nearest_on_outline(outline, source) - source);
    if (is_inside(outline, source) && off_outline > on_outline * bounding_diagonal(outline)) return;
    throw Error(fmt::format(
        "the trunk's source ({}, {}) is not inside the basin's outline: a trunk runs from its outlet on the "
        "outline up to its source; turn it round if it was drawn downstream",
        source.x, source.y));
}

/// The source is inside; the outlet may be a corner.
void check_trunk(const Basin& basin) {
    for (std::size_t i = 0; i < basin.outline.size(); ++i) {
        const Point& a = basin.outline[i];
        const Point& b = basin.outline[(i + 1) % basin.outline.size()];
        const bool corner_on_trunk = a != basin.outlet && mesh::orientation(basin.outlet, basin.source, a) == 0 &&
                                     dot(a - basin.outlet, a - basin.source) < 0;
        const Point foot = nearest_on_segment(a, b, basin.outlet);
        const bool starts_here = norm(foot - basin.outlet) <= 1e-9 * norm(b - a);
        const bool crosses = !starts_here && mesh::segments_cross(basin.outlet, basin.source, a, b);
        if (corner_on_trunk || crosses) {
            throw Error(
                fmt::format("the trunk leaves the basin at the side ({}, {})–({}, {}): the straight line from "
                            "its outlet to its source must lie inside",
                            a.x, a.y, b.x, b.y));
        }
    }
}

}  // namespace

Point nearest_on_outline(const Polygon& outline, const Point& p) {
    Point nearest = outline[0];
    for (std::size_t i = 0; i < outline.size(); ++i) {
        const Point on_side = nearest_on_segment(outline[i], outline[(i + 1) % outline.size()], p);
        if (norm(on_side - p) < norm(nearest - p)) nearest = on_side;
    }
    return nearest;
}

Basin checked_basin(const Basin& basin) {
    Basin checked = basin;
    checked.outline = mesh::simple_polygon(basin.outline);
    for (const Point& end : {basin.outlet, basin.source}) {
        if (!std::isfinite(end.x) || !std::isfinite(end.y)) {
            throw Error(fmt::format("the trunk has an end at ({}, {}): both need finite coordinates", end.x, end.y));
        }
    }
    if (!std::isfinite(basin.base_level_m)) {
        throw Error(fmt::format("the base level is {} m: it must be a finite elevation", basin.base_level_m));
    }
    checked.outlet = outlet_on_outline(checked.outline, basin.outlet);
    check_source(checked.outline, checked.source);
    check_trunk(checked);
    return checked;
}

}  // namespace thalweg::grow
