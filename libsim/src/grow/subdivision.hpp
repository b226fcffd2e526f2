// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <span>
#include <vector>

#include "thalweg/core/index.hpp"
#include "thalweg/core/point.hpp"
#include "thalweg/grow/links.hpp"

namespace thalweg::grow {

/// The basin cut into polygons: a half-edge structure in flat arrays. Half-edge h and h ^ 1 are the two directions of
/// one edge; the polygon of a half-edge lies to its left and is walked by `next`. Polygons have no numbers: who holds a
/// half-edge holds its polygon.
class Subdivision {
  public:
    /// One polygon; half-edge 2i runs from corner i to the next one.
    explicit Subdivision(const Polygon& counter_clockwise);

    Index next(Index half_edge) const { return sides_[half_edge].next; }
    Index previous(Index half_edge) const { return sides_[half_edge].previous; }
    Index origin(Index half_edge) const { return sides_[half_edge].origin; }
    Index target(Index half_edge) const { return sides_[half_edge ^ 1].origin; }
    EdgeKind kind(Index half_edge) const { return sides_[half_edge & ~Index{1}].kind; }
    const Point& point(Index vertex) const { return points_[vertex]; }
    Index half_edges() const { return static_cast<Index>(sides_.size()); }
    Index vertices() const { return static_cast<Index>(points_.size()); }
    bool is_removed(Index half_edge) const { return sides_[half_edge].next == none; }

    void move_vertex(Index vertex, const Point& to) { points_[vertex] = to; }

    /// Puts a vertex on an edge, for the polygons on both sides. The half-edge then ends there; returns the one that
    /// goes on from it.
    Index insert_vertex(Index half_edge, const Point&);

    /// Cuts the polygon of two half-edges by an edge from the first one's origin to the second one's. Returns the new
    /// half-edge in that direction: to its left lies what runs on along `to`; `from` stays on its right.
    Index connect(Index from, Index to, EdgeKind);

    /// Takes an edge away: the polygons on its sides become one. An end without another edge is left without any.
    void remove(Index half_edge);

    void set_kind(Index half_edge, EdgeKind kind) { sides_[half_edge & ~Index{1}].kind = kind; }

    /// Area of the half-edge's polygon, m².
    double area(Index half_edge) const;

    void reserve(Index edges, Index vertices);

    /// Asks memory for a half-edge, or for what lies around it, without waiting.
    void ask_for(Index half_edge) const { __builtin_prefetch(&sides_[half_edge]); }
    void ask_for_surroundings(Index half_edge) const {
        const HalfEdge& side = sides_[half_edge];
        __builtin_prefetch(&points_[side.origin]);
        __builtin_prefetch(&sides_[sides_[half_edge ^ 1].previous]);
    }

  private:
    /// What a walk around a polygon needs, both directions of an edge in one cache line.
    struct HalfEdge {
        Index origin;
        Index next;
        Index previous;
        EdgeKind kind;  ///< kept with the even one
    };

    Index add_pair(Index from, Index to, EdgeKind);
    void follow(Index first, Index second);

    std::vector<HalfEdge> sides_;
    std::vector<Point> points_;
};

/// A ray from a place inside a polygon or on its rim.
struct Ray {
    Point start;
    Point direction;  ///< of length 1
};

/// Where a ray meets a polygon's side.
struct Hit {
    Index half_edge = none;  ///< the side
    bool at_origin = false;  ///< in its first vertex
    Point place{};
    double distance = 0;  ///< along the ray
    Index order = 0;      ///< of the side on the walk around the polygon
};

/// The first meeting of every ray with the polygon's sides, but not with those given (on which the rays start). A
/// vertex within `tolerance` (m) of a ray or of its meeting place takes the ray. `half_edge` of the hit is `none` if
/// there is no meeting.
void find_hits(const Subdivision&, Index first, std::span<const Index> skipped_edges, std::span<const Ray>,
               double tolerance, std::span<Hit> hits);

}  // namespace thalweg::grow
