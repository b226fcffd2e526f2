// SPDX-License-Identifier: GPL-3.0-or-later
#include "mesh/constrained.hpp"

#include <CGAL/Triangulation_conformer_2.h>
#include <fmt/format.h>

#include <algorithm>

#include "mesh/hilbert.hpp"
#include "thalweg/core/error.hpp"

namespace thalweg::mesh {
namespace {

using Vertex = Constrained::Vertex_handle;

/// Inserts the points, each beside the one before; gives the outline's vertices.
std::vector<Vertex> insert_points(Delaunay& delaunay, const std::vector<Point>& points, Index outline_count,
                                  std::span<const Index> order) {
    std::vector<Vertex> outline(outline_count);
    Delaunay::Face_handle near;
    for (const Index number : order) {
        const Point& p = points[number];
        const Vertex vertex = delaunay.insert(Kernel::Point_2(p.x, p.y), near);
        if (vertex->info().value != none) {
            throw Error(fmt::format("two of the mesh's points lie at the same place ({}, {})", p.x, p.y));
        }
        vertex->info().value = number;
        if (number < outline_count) outline[number] = vertex;
        near = vertex->face();
    }
    return outline;
}

void constrain_outline(Constrained& constrained, const std::vector<Vertex>& outline) {
    try {
        for (std::size_t i = 0; i < outline.size(); ++i) {
            constrained.insert_constraint(outline[i], outline[(i + 1) % outline.size()]);
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

}  // namespace

void triangulate_conforming(std::vector<Point>& points, Index outline_count, std::span<const Index> order,
                            Constrained& constrained) {
    if (outline_count < 3 || outline_count > points.size()) {
        throw Error(
            fmt::format("{} of {} points lie on the outline, which needs 3 or more", outline_count, points.size()));
    }
    Delaunay delaunay;  // built without thought of constraints, which is faster, and then handed over
    const std::vector<Vertex> outline = insert_points(delaunay, points, outline_count, order);
    if (delaunay.dimension() < 2) throw Error("the mesh's points all lie on one line");
    constrained.tds().swap(delaunay.tds());
    constrained.set_infinite_vertex(delaunay.infinite_vertex());
    constrain_outline(constrained, outline);
    CGAL::make_conforming_Gabriel_2(constrained);
    number_added_points(constrained, points);
}

std::vector<Point> conforming_ring(std::vector<Point> ring) {
    const std::size_t given = ring.size();
    Constrained constrained;
    triangulate_conforming(ring, static_cast<Index>(given), hilbert_order(ring), constrained);
    if (ring.size() == given) return ring;
    std::vector<Vertex> vertices(ring.size());
    for (const Vertex vertex : constrained.finite_vertex_handles()) vertices[vertex->info().value] = vertex;
    std::vector<Index> walk;
    Vertex from = nullptr;
    Vertex here = vertices[0];
    while (walk.size() < ring.size()) {
        walk.push_back(here->info().value);
        const Vertex next = next_on_outline(constrained, from, here);
        from = here;
        here = next;
    }
    // The first step may have gone either way round: the next of the given points tells which.
    const auto second = std::find_if(walk.begin() + 1, walk.end(), [&](Index number) { return number < given; });
    if (*second != 1) std::reverse(walk.begin() + 1, walk.end());
    std::vector<Point> conforming;
    for (const Index number : walk) conforming.push_back(ring[number]);
    return conforming;
}

}  // namespace thalweg::mesh
