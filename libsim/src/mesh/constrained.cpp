// SPDX-License-Identifier: GPL-3.0-or-later
#include "mesh/constrained.hpp"

#include <CGAL/Triangulation_conformer_2.h>
#include <fmt/format.h>

#include <algorithm>

#include "thalweg/core/error.hpp"
#include "thalweg/mesh/hilbert.hpp"

namespace thalweg::mesh {
namespace {

using Vertex = Constrained::Vertex_handle;

void constrain_rings(Constrained& constrained, const std::vector<Vertex>& outline, std::span<const Index> ring_start) {
    try {
        for (std::size_t ring = 0; ring + 1 < ring_start.size(); ++ring) {
            const Index first = ring_start[ring];
            const Index last = ring_start[ring + 1] - 1;
            for (Index i = first; i <= last; ++i) {
                constrained.insert_constraint(outline[i], outline[i == last ? first : i + 1]);
            }
        }
    } catch (const Constrained::Intersection_of_constraints_exception&) {
        throw Error("the points on the outline are not in order around it: the line through them crosses itself");
    }
}

void number_added_points(Constrained& constrained, std::vector<Point>& points) {
    if (constrained.number_of_vertices() == points.size()) return;
    for (const Vertex vertex : constrained.finite_vertex_handles()) {
        if (vertex->info().value != none) continue;
        vertex->info().value = static_cast<Index>(points.size());
        points.push_back({vertex->point().x(), vertex->point().y()});
    }
}

/// The vertex at the other end of the outline's edge that leaves `here` and does not lead to `from`.
Vertex next_on_outline(const Constrained& constrained, Vertex from, Vertex here) {
    auto edge = constrained.incident_edges(here);
    for (;; ++edge) {
        const Vertex a = edge->first->vertex(Constrained::cw(edge->second));
        const Vertex b = edge->first->vertex(Constrained::ccw(edge->second));
        const Vertex other = a == here ? b : a;
        if (edge->first->is_constrained(edge->second) && other != from) return other;
    }
}

/// The ring through given points first … last − 1, with what was added on it, in the given sense.
Polygon walk_ring(const Constrained& constrained, const std::vector<Vertex>& vertices, Index first, Index last) {
    std::vector<Index> walk;
    Vertex from = nullptr;
    Vertex here = vertices[first];
    do {
        walk.push_back(here->info().value);
        const Vertex next = next_on_outline(constrained, from, here);
        from = here;
        here = next;
    } while (here != vertices[first]);
    // The first step may have gone either way round: the next of the given points tells which.
    const auto second =
        std::find_if(walk.begin() + 1, walk.end(), [&](Index number) { return number > first && number < last; });
    if (*second != first + 1) std::reverse(walk.begin() + 1, walk.end());
    Polygon ring;
    for (const Index number : walk) ring.push_back({vertices[number]->point().x(), vertices[number]->point().y()});
    return ring;
}

}  // namespace

std::vector<Vertex> insert_points(Constrained& constrained, std::span<const Point> points, Index first_count,
                                  std::span<const Index> order) {
    Delaunay delaunay;  // built without thought of constraints, which is faster, and then handed over
    std::vector<Vertex> first(first_count);
    Delaunay::Face_handle near;
    for (const Index number : order) {
        const Point& p = points[number];
        const Vertex vertex = delaunay.insert(Kernel::Point_2(p.x, p.y), near);
        if (vertex->info().value != none) {
            throw Error(fmt::format("two of the mesh's points lie at the same place ({}, {})", p.x, p.y));
        }
        vertex->info().value = number;
        if (number < first_count) first[number] = vertex;
        near = vertex->face();
    }
    if (delaunay.dimension() < 2) throw Error("the mesh's points all lie on one line");
    constrained.tds().swap(delaunay.tds());
    constrained.set_infinite_vertex(delaunay.infinite_vertex());
    return first;
}

void triangulate_conforming(std::vector<Point>& points, std::span<const Index> ring_start, std::span<const Index> order,
                            Constrained& constrained) {
    const Index outline_count = ring_start.back();
    for (std::size_t ring = 0; ring + 1 < ring_start.size(); ++ring) {
        const Index count = ring_start[ring + 1] - ring_start[ring];
        if (count >= 3 && outline_count <= points.size()) continue;
        throw Error(
            fmt::format("{} of {} points lie on a ring of the outline, which needs 3 or more", count, points.size()));
    }
    const std::vector<Vertex> outline = insert_points(constrained, points, outline_count, order);
    constrain_rings(constrained, outline, ring_start);
    CGAL::make_conforming_Gabriel_2(constrained);
    number_added_points(constrained, points);
}

std::vector<Polygon> conforming_rings(const std::vector<Polygon>& rings) {
    std::vector<Point> points;
    std::vector<Index> ring_start{0};
    for (const Polygon& ring : rings) {
        points.insert(points.end(), ring.begin(), ring.end());
        ring_start.push_back(static_cast<Index>(points.size()));
    }
    Constrained constrained;
    triangulate_conforming(points, ring_start, hilbert_order(points), constrained);
    if (points.size() == ring_start.back()) return rings;
    std::vector<Vertex> vertices(points.size());
    for (const Vertex vertex : constrained.finite_vertex_handles()) vertices[vertex->info().value] = vertex;
    std::vector<Polygon> conforming;
    for (std::size_t ring = 0; ring < rings.size(); ++ring) {
        conforming.push_back(walk_ring(constrained, vertices, ring_start[ring], ring_start[ring + 1]));
    }
    return conforming;
}

}  // namespace thalweg::mesh
