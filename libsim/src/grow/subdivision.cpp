// SPDX-License-Identifier: GPL-3.0-or-later
#include "grow/subdivision.hpp"

#include <algorithm>
#include <cmath>

#include "grow/plane.hpp"

namespace thalweg::grow {

Subdivision::Subdivision(const Polygon& outline) : points_(outline) {
    const auto count = static_cast<Index>(outline.size());
    for (Index i = 0; i < count; ++i) add_pair(i, (i + 1) % count, EdgeKind::outline);
    for (Index i = 0; i < count; ++i) {
        const Index following = (i + 1) % count;
        follow(2 * i, 2 * following);
        follow(2 * following + 1, 2 * i + 1);
    }
}

void Subdivision::reserve(Index edges, Index vertices) {
    sides_.reserve(2 * std::size_t{edges});
    points_.reserve(vertices);
}

Index Subdivision::add_pair(Index from, Index to, EdgeKind kind) {
    const Index half_edge = half_edges();
    sides_.push_back({from, none, none, kind});
    sides_.push_back({to, none, none, kind});
    return half_edge;
}

void Subdivision::follow(Index first, Index second) {
    sides_[first].next = second;
    sides_[second].previous = first;
}

Index Subdivision::insert_vertex(Index half_edge, const Point& place) {
    const Index vertex = vertices();
    points_.push_back(place);
    const Index back = half_edge ^ 1;
    const Index onward = add_pair(vertex, sides_[back].origin, kind(half_edge));
    // An edge that hangs in a polygon turns round at its end: there the half-edge's next is its own other direction.
    const bool turns_round = sides_[half_edge].next == back;
    const Index after = sides_[half_edge].next;
    const Index before = sides_[back].previous;
    sides_[back].origin = vertex;
    follow(half_edge, onward);
    follow(onward ^ 1, back);
    if (turns_round) {
        follow(onward, onward ^ 1);
    } else {
        follow(onward, after);
        follow(before, onward ^ 1);
    }
    return onward;
}

Index Subdivision::connect(Index from, Index to, EdgeKind kind) {
    const Index edge = add_pair(sides_[from].origin, sides_[to].origin, kind);
    const Index before_from = sides_[from].previous;
    const Index before_to = sides_[to].previous;
    follow(before_from, edge);
    follow(edge, to);
    follow(before_to, edge ^ 1);
    follow(edge ^ 1, from);
    return edge;
}

void Subdivision::remove(Index half_edge) {
    const Index back = half_edge ^ 1;
    const Index after_target = sides_[half_edge].next;
    const Index before_target = sides_[back].previous;
    if (sides_[half_edge].previous != back) follow(sides_[half_edge].previous, sides_[back].next);
    if (after_target != back) follow(before_target, after_target);
    sides_[half_edge].next = sides_[back].next = none;
}

double Subdivision::area(Index half_edge) const {
    const Point& reference = points_[sides_[half_edge].origin];  // near coordinates keep their digits
    double twice_area = 0;
    Index at = sides_[half_edge].next;
    Point a = points_[sides_[at].origin] - reference;
    for (; at != half_edge; at = sides_[at].next) {
        const Point b = points_[target(at)] - reference;
        twice_area += cross(a, b);
        a = b;
    }
    return twice_area / 2;
}

namespace {

/// Where a vertex lies as seen along a ray.
struct View {
    double along;
    double across;  ///< positive to the left
};

View view(const Ray& ray, const Point& p) {
    const Point offset = p - ray.start;
    return {dot(ray.direction, offset), cross(ray.direction, offset)};
}

void offer(Hit& nearest, const Hit& hit) {
    if (nearest.half_edge == none || hit.distance < nearest.distance) nearest = hit;
}

/// The meeting of a ray with the side a–b, of which `half_edge` is the number and `order` the place in the walk.
void meet(const Ray& ray, const Point& a, const Point& b, double tolerance, Hit hit, Hit& nearest) {
    const View from = view(ray, a);
    const View to = view(ray, b);
    if (std::abs(from.across) <= tolerance) {
        if (from.along <= 0) return;
        hit.at_origin = true;
        hit.place = a;
        hit.distance = from.along;
        return offer(nearest, hit);
    }
    if (std::abs(to.across) <= tolerance || (from.across > 0) == (to.across > 0)) return;
    const double share = from.across / (from.across - to.across);
    hit.distance = from.along + share * (to.along - from.along);
    if (hit.distance <= 0) return;
    hit.place = a + share * (b - a);
    offer(nearest, hit);
}

/// A hit next to a vertex becomes one in the vertex.
void snap(const Subdivision& basin, double tolerance, Hit& hit) {
    if (hit.half_edge == none || hit.at_origin) return;
    const Index end = basin.next(hit.half_edge);
    if (norm(basin.point(basin.origin(end)) - hit.place) <= tolerance) {
        hit.half_edge = end;
        ++hit.order;
    } else if (norm(basin.point(basin.origin(hit.half_edge)) - hit.place) > tolerance) {
        return;
    }
    hit.at_origin = true;
    hit.place = basin.point(basin.origin(hit.half_edge));
}

}  // namespace

void find_hits(const Subdivision& basin, Index first, std::span<const Index> skipped_edges, std::span<const Ray> rays,
               double tolerance, std::span<Hit> hits) {
    std::fill(hits.begin(), hits.end(), Hit{});
    Index order = 0;
    Index side = first;
    do {
        const bool skipped = std::any_of(skipped_edges.begin(), skipped_edges.end(),
                                         [side](Index edge) { return edge >> 1 == side >> 1; });
        const Point& a = basin.point(basin.origin(side));
        const Point& b = basin.point(basin.target(side));
        for (std::size_t ray = 0; !skipped && ray < rays.size(); ++ray) {
            meet(rays[ray], a, b, tolerance, {.half_edge = side, .order = order}, hits[ray]);
        }
        ++order;
        side = basin.next(side);
    } while (side != first);
    for (Hit& hit : hits) snap(basin, tolerance, hit);
}

}  // namespace thalweg::grow
