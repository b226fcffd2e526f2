// SPDX-License-Identifier: GPL-3.0-or-later
#include "mesh/outline.hpp"

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Polygon_2_algorithms.h>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>
#include <vector>

#include "thalweg/core/error.hpp"
#include "thalweg/mesh/triangulate.hpp"

namespace thalweg::mesh {
namespace {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;

std::vector<Kernel::Point_2> corners_of(const Polygon& ring) {
    std::vector<Kernel::Point_2> corners;
    for (const Point& p : ring) corners.emplace_back(p.x, p.y);
    return corners;
}

bool is_simple(const Polygon& outline) {
    const auto corners = corners_of(outline);
    return CGAL::is_simple_2(corners.begin(), corners.end(), Kernel());
}

struct Side {
    Kernel::Segment_2 segment;
    double west, east, south, north;
    std::size_t ring;
    std::size_t number;  ///< of its first corner
};

std::vector<Side> sides_from_west_to_east(const Rings& rings) {
    std::vector<Side> sides;
    for (std::size_t ring = 0; ring < rings.size(); ++ring) {
        const auto corners = corners_of(rings[ring]);
        for (std::size_t i = 0; i < corners.size(); ++i) {
            const auto& a = corners[i];
            const auto& b = corners[(i + 1) % corners.size()];
            sides.push_back({Kernel::Segment_2(a, b), std::min(a.x(), b.x()), std::max(a.x(), b.x()),
                             std::min(a.y(), b.y()), std::max(a.y(), b.y()), ring, i});
        }
    }
    std::sort(sides.begin(), sides.end(), [](const Side& a, const Side& b) { return a.west < b.west; });
    return sides;
}

/// The first two sides that `may_not_meet` but do; exact. A sweep over the sides by their western ends.
template <class MayNotMeet>
std::optional<std::pair<Side, Side>> meeting(const Rings& rings, MayNotMeet may_not_meet) {
    const std::vector<Side> sides = sides_from_west_to_east(rings);
    for (std::size_t i = 0; i < sides.size(); ++i) {
        for (std::size_t j = i + 1; j < sides.size() && sides[j].west <= sides[i].east; ++j) {
            if (sides[i].north < sides[j].south || sides[j].north < sides[i].south) continue;
            if (may_not_meet(sides[i], sides[j])) return std::pair{sides[i], sides[j]};
        }
    }
    return std::nullopt;
}

bool rings_touch(const Rings& rings) {
    return meeting(rings, [](const Side& a,
                             const Side& b) { return a.ring != b.ring && CGAL::do_intersect(a.segment, b.segment); })
        .has_value();
}

/// A place that two sides which meet have in common; a corner of both only if there is no other.
Kernel::Point_2 common_place(const Side& a, const Side& b) {
    std::optional<Kernel::Point_2> corner_of_both;
    for (const auto& [side, other] : {std::pair{&a, &b}, {&b, &a}}) {
        for (const auto& end : {side->segment.source(), side->segment.target()}) {
            if (!other->segment.has_on(end)) continue;
            if (end != other->segment.source() && end != other->segment.target()) return end;
            corner_of_both = end;
        }
    }
    if (corner_of_both) return *corner_of_both;
    const auto u = a.segment.to_vector(), v = b.segment.to_vector(), w = b.segment.source() - a.segment.source();
    return a.segment.source() + (w.x() * v.y() - w.y() * v.x()) / (u.x() * v.y() - u.y() * v.x()) * u;
}

/// Throws Error that says where a ring without repeated corners meets itself.
[[noreturn]] void refuse_self_meeting(const Polygon& ring) {
    const std::size_t corners = ring.size();
    // Neighbours need no look: where one runs back on the other, the side after or before it meets the other, too.
    const auto found = meeting({ring}, [&](const Side& a, const Side& b) {
        const bool neighbors = (a.number + 1) % corners == b.number || (b.number + 1) % corners == a.number;
        return !neighbors && CGAL::do_intersect(a.segment, b.segment);
    });
    if (!found) throw Error("the outline crosses or touches itself: it must be one simple ring");
    const auto place = common_place(found->first, found->second);
    const auto text = [](const auto& p) { return fmt::format("({}, {})", p.x(), p.y()); };
    throw Error(
        fmt::format("the outline crosses or touches itself at {}, where its sides {}–{} and {}–{} meet: it must be "
                    "one simple ring",
                    text(place), text(found->first.segment.source()), text(found->first.segment.target()),
                    text(found->second.segment.source()), text(found->second.segment.target())));
}

bool on_one_line(const Polygon& ring) {
    const auto corners = corners_of(ring);
    return std::all_of(corners.begin(), corners.end(), [&](const Kernel::Point_2& p) {
        return CGAL::collinear(corners[0], corners[1], p);  // two corners that differ
    });
}

/// The ring without corners that repeat the one before, the last one's being the first.
Polygon without_repeats(const Polygon& ring) {
    Polygon kept;
    for (const Point& p : ring) {
        if (kept.empty() || p != kept.back()) kept.push_back(p);
    }
    while (kept.size() > 1 && kept.back() == kept.front()) kept.pop_back();
    return kept;
}

/// Whether the first corner of one ring, and so all of it, lies inside another.
bool lies_inside(const Polygon& ring, const Polygon& other) {
    const auto corners = corners_of(other);
    const Kernel::Point_2 first(ring[0].x, ring[0].y);
    return CGAL::bounded_side_2(corners.begin(), corners.end(), first, Kernel()) == CGAL::ON_BOUNDED_SIDE;
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
    for (const Point& p : outline) {
        if (!std::isfinite(p.x) || !std::isfinite(p.y)) {
            throw Error(fmt::format("the outline has a corner at ({}, {}): all need finite coordinates", p.x, p.y));
        }
    }
    Polygon checked = without_repeats(outline);
    if (checked.size() < 3) {
        throw Error(fmt::format("an outline needs at least 3 corners in different places, not {}", checked.size()));
    }
    if (on_one_line(checked)) throw Error("the outline encloses no area: its corners lie on one line");
    if (!is_simple(checked)) refuse_self_meeting(checked);
    const double area = polygon_area(checked);
    if (!(std::abs(area) > 0)) throw Error("the outline encloses no area that could be told from rounding");
    if (area < 0) std::reverse(checked.begin(), checked.end());
    return checked;
}

Rings checked_rings(const PolygonPart& domain) {
    Rings rings{checked_outline(domain.outer)};
    for (const Polygon& hole : domain.holes) {
        rings.push_back(checked_outline(hole));
        std::reverse(rings.back().begin(), rings.back().end());
    }
    if (rings_touch(rings)) {
        throw Error(
            "two rings of the outline touch or cross: a hole must lie apart from the outer ring and the others");
    }
    for (std::size_t hole = 1; hole < rings.size(); ++hole) {
        bool misplaced = !lies_inside(rings[hole], rings[0]);
        for (std::size_t other = 1; other < rings.size(); ++other) {
            misplaced = misplaced || (other != hole && lies_inside(rings[hole], rings[other]));
        }
        if (misplaced) {
            throw Error(fmt::format("the hole at ({}, {}) lies outside the outline or inside another hole",
                                    rings[hole][0].x, rings[hole][0].y));
        }
    }
    return rings;
}

}  // namespace thalweg::mesh
