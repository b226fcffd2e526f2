// SPDX-License-Identifier: GPL-3.0-or-later
#include "grow/trunk.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <limits>
#include <span>
#include <vector>

#include "grow/plane.hpp"
#include "thalweg/core/error.hpp"
#include "thalweg/mesh/predicates.hpp"

namespace thalweg::grow {
namespace {

/// The basin in coordinates relative to the outlet, which is a corner of the outline.
Polygon outline_from_outlet(const Basin& basin) {
    Polygon outline;
    bool is_corner = false;
    for (std::size_t i = 0; i < basin.outline.size(); ++i) {
        outline.push_back(basin.outline[i] - basin.outlet);
        is_corner = is_corner || basin.outline[i] == basin.outlet;
    }
    if (is_corner) return outline;
    std::size_t nearest = 0;
    double least = std::numeric_limits<double>::infinity();
    for (std::size_t i = 0; i < outline.size(); ++i) {
        const Point side = outline[(i + 1) % outline.size()] - outline[i];
        const double share = std::clamp(-dot(outline[i], side) / dot(side, side), 0.0, 1.0);
        const double distance = norm(outline[i] + share * side);
        if (distance < least) {
            nearest = i;
            least = distance;
        }
    }
    outline.insert(outline.begin() + static_cast<std::ptrdiff_t>(nearest) + 1, Point{0, 0});
    return outline;
}

Index outlet_corner(const Polygon& outline) {
    return static_cast<Index>(std::find(outline.begin(), outline.end(), Point{0, 0}) - outline.begin());
}

/// What a trunk goes on to beyond its source.
Hit straight_on(const Subdivision& plane, Index outlet, std::span<const Point> trunk, double tolerance) {
    const Point& last = trunk[trunk.size() - 2];
    const Point along = trunk.back() - last;
    const Index corners = plane.half_edges() / 2;
    // A straight trunk starts in the corner of two sides.
    const std::array sides_of_outlet{2 * outlet, 2 * ((outlet + corners - 1) % corners)};
    const auto skipped = std::span(sides_of_outlet).first(trunk.size() == 2 ? 2 : 0);
    const Ray ray{last, (1 / norm(along)) * along};
    Hit hit;
    find_hits(plane, 2 * outlet, skipped, {&ray, 1}, tolerance, {&hit, 1});  // half-edge 2i starts in corner i
    return hit;
}

void check_end(const Basin& basin, std::span<const Point> trunk, const Hit& hit, double shortest) {
    const Point along = trunk.back() - trunk[trunk.size() - 2];
    if (hit.half_edge == none || hit.distance - norm(along) < shortest) {
        throw Error(fmt::format("the trunk's source ({}, {}) is on the basin's outline: it must be inside",
                                basin.source.x, basin.source.y));
    }
    for (std::size_t i = 0; i + 2 < trunk.size(); ++i) {
        const bool touches = norm(nearest_on_segment(trunk[i], trunk[i + 1], hit.place) - hit.place) < shortest;
        if (!touches && !mesh::segments_cross(trunk.back(), hit.place, trunk[i], trunk[i + 1])) continue;
        throw TrunkError(TrunkFault::piece_crosses, trunk.size() - 2,
                         fmt::format("straight on from its source ({}, {}) the trunk meets itself: let it end before",
                                     basin.source.x, basin.source.y));
    }
}

}  // namespace

GrowingTree cut_along_trunk(const Basin& basin, double c) {
    std::vector<Point> trunk = trunk_of(basin);
    for (Point& place : trunk) place = place - basin.outlet;
    double length = 0;
    for (std::size_t i = 1; i < trunk.size(); ++i) length += norm(trunk[i] - trunk[i - 1]);
    c = std::min(c, length);  // with `stop = links` it may be far larger than the basin
    const Polygon outline = outline_from_outlet(basin);
    const Index outlet = outlet_corner(outline);
    GrowingTree tree{.basin = Subdivision(outline), .links = {}, .streams = {}, .junctions = {}, .sources = {}};
    Subdivision& plane = tree.basin;
    const Hit hit = straight_on(plane, outlet, trunk, 1e-9 * c);
    check_end(basin, trunk, hit, 1e-6 * c);
    const Index to = hit.at_origin ? hit.half_edge : plane.insert_vertex(hit.half_edge, hit.place);
    const Index edge = plane.connect(2 * outlet, to, EdgeKind::channel);
    Index piece = edge;
    for (std::size_t i = 1; i < trunk.size(); ++i) piece = plane.insert_vertex(piece, trunk[i]);
    plane.set_kind(piece, EdgeKind::head);
    GrowingLink link;
    link.edge = edge;
    link.length_m = tree.length_m = length;
    link.area_m2 = {plane.area(edge), plane.area(edge ^ 1)};
    tree.links.push_back(link);
    tree.streams.push_back({link.length_m, none});
    return tree;
}

}  // namespace thalweg::grow
