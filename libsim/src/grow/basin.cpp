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

bool is_well_inside(const Polygon& outline, const Point& p) {
    return is_inside(outline, p) && norm(nearest_on_outline(outline, p) - p) > on_outline * bounding_diagonal(outline);
}

void check_source(const Polygon& outline, const Point& source) {
    if (is_well_inside(outline, source)) return;
    throw Error(fmt::format(
        "the trunk's source ({}, {}) is not inside the basin's outline: a trunk runs from its outlet on the "
        "outline up to its source; turn it round if it was drawn downstream",
        source.x, source.y));
}

void check_bends(const Basin& basin) {
    for (std::size_t i = 0; i < basin.bends.size(); ++i) {
        const Point& bend = basin.bends[i];
        if (is_well_inside(basin.outline, bend)) continue;
        throw TrunkError(TrunkFault::bend, i + 1,
                         fmt::format("the trunk's bend ({}, {}) is not inside the basin's outline", bend.x, bend.y));
    }
}

/// The first piece starts at the outlet, which is on the outline and may be a corner.
void check_piece(const Basin& basin, std::size_t piece, const Point& from, const Point& to) {
    for (std::size_t i = 0; i < basin.outline.size(); ++i) {
        const Point& a = basin.outline[i];
        const Point& b = basin.outline[(i + 1) % basin.outline.size()];
        const bool corner_on_trunk =
            a != basin.outlet && mesh::orientation(from, to, a) == 0 && dot(a - from, a - to) < 0;
        const Point foot = nearest_on_segment(a, b, from);
        const bool starts_here = from == basin.outlet && norm(foot - from) <= 1e-9 * norm(b - a);
        const bool crosses = !starts_here && mesh::segments_cross(from, to, a, b);
        if (corner_on_trunk || crosses) {
            throw TrunkError(TrunkFault::piece_leaves, piece,
                             fmt::format("the trunk leaves the basin at the side ({}, {})–({}, {}): the lines from its "
                                         "outlet over its bends to its source must lie inside",
                                         a.x, a.y, b.x, b.y));
        }
    }
}

void check_bend(const std::vector<Point>& trunk, std::size_t place) {
    const Point &before = trunk[place - 1], &bend = trunk[place], &after = trunk[place + 1];
    const Point below = bend - before, above = after - bend;
    if (dot(below, above) > -0.5 * norm(below) * norm(above)) return;
    throw TrunkError(
        TrunkFault::bend, place,
        fmt::format("the trunk turns back at ({}, {}): it may bend by 120 degrees at most", bend.x, bend.y));
}

void check_trunk(const Basin& basin) {
    const std::vector<Point> trunk = trunk_of(basin);
    const double shortest = on_outline * bounding_diagonal(basin.outline);
    for (std::size_t i = 0; i + 1 < trunk.size(); ++i) {
        if (norm(trunk[i + 1] - trunk[i]) <= shortest) {
            throw TrunkError(
                TrunkFault::bend, std::max<std::size_t>(i, 1),
                fmt::format("the trunk has two places at ({}, {}): leave one out", trunk[i].x, trunk[i].y));
        }
        check_piece(basin, i, trunk[i], trunk[i + 1]);
        if (i > 0) check_bend(trunk, i);
        for (std::size_t j = 0; j + 1 < i; ++j) {
            const bool touches =
                norm(nearest_on_segment(trunk[j], trunk[j + 1], trunk[i + 1]) - trunk[i + 1]) < shortest;
            if (!touches && !mesh::segments_cross(trunk[j], trunk[j + 1], trunk[i], trunk[i + 1])) continue;
            throw TrunkError(TrunkFault::piece_crosses, i,
                             fmt::format("the trunk crosses itself between ({}, {}) and ({}, {})", trunk[i].x,
                                         trunk[i].y, trunk[i + 1].x, trunk[i + 1].y));
        }
    }
}

}  // namespace

std::vector<Point> trunk_of(const Basin& basin) {
    std::vector<Point> trunk{basin.outlet};
    trunk.insert(trunk.end(), basin.bends.begin(), basin.bends.end());
    trunk.push_back(basin.source);
    return trunk;
}

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
    for (const Point& place : trunk_of(basin)) {
        if (!std::isfinite(place.x) || !std::isfinite(place.y)) {
            throw Error(
                fmt::format("the trunk has a place at ({}, {}): all need finite coordinates", place.x, place.y));
        }
    }
    if (!std::isfinite(basin.base_level_m)) {
        throw Error(fmt::format("the base level is {} m: it must be a finite elevation", basin.base_level_m));
    }
    checked.outlet = outlet_on_outline(checked.outline, basin.outlet);
    check_source(checked.outline, checked.source);
    check_bends(checked);
    check_trunk(checked);
    return checked;
}

}  // namespace thalweg::grow
