// SPDX-License-Identifier: GPL-3.0-or-later
#include "thalweg/mesh/triangulate.hpp"

#include <CGAL/Constrained_Delaunay_triangulation_2.h>
#include <CGAL/Delaunay_triangulation_2.h>
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Triangulation_conformer_2.h>
#include <CGAL/Triangulation_face_base_with_info_2.h>
#include <CGAL/Triangulation_vertex_base_with_info_2.h>
#include <fmt/format.h>

#include <cmath>

#include "mesh/assemble.hpp"
#include "mesh/hilbert.hpp"
#include "mesh/outline.hpp"
#include "thalweg/core/error.hpp"

namespace thalweg::mesh {
namespace {

struct Number {
    Index value = none;
};
struct Side {
    bool outside = false;
};

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using Vertices = CGAL::Triangulation_vertex_base_with_info_2<Number, Kernel>;
using Faces =
    CGAL::Triangulation_face_base_with_info_2<Side, Kernel, CGAL::Constrained_triangulation_face_base_2<Kernel>>;
using Structure = CGAL::Triangulation_data_structure_2<Vertices, Faces>;
using Delaunay = CGAL::Delaunay_triangulation_2<Kernel, Structure>;
using Constrained =
    CGAL::Constrained_Delaunay_triangulation_2<Kernel, Structure,
                                               CGAL::No_constraint_intersection_requiring_constructions_tag>;

/// Inserts the points in the given order, each beside the one before; gives the outline's vertices.
std::vector<Delaunay::Vertex_handle> insert_points(Delaunay& delaunay, const PointSet& set,
                                                   const std::vector<Index>& order) {
    std::vector<Delaunay::Vertex_handle> outline(set.outline_count);
    Delaunay::Face_handle near;
    for (const Index number : order) {
        const Point& p = set.points[number];
        const auto vertex = delaunay.insert(Kernel::Point_2(p.x, p.y), near);
        if (vertex->info().value != none) {
            throw Error(fmt::format("two of the mesh's points lie at the same place ({}, {})", p.x, p.y));
        }
        vertex->info().value = number;
        if (number < set.outline_count) outline[number] = vertex;
        near = vertex->face();
    }
    return outline;
}

/// The Delaunay triangulation is built without thought of constraints, which is faster, then handed over.
void take_over(Delaunay& delaunay, Constrained& constrained) {
    constrained.tds().swap(delaunay.tds());
    constrained.set_infinite_vertex(delaunay.infinite_vertex());
}

void constrain_outline(Constrained& constrained, const std::vector<Delaunay::Vertex_handle>& outline) {
    try {
        for (std::size_t i = 0; i < outline.size(); ++i) {
            constrained.insert_constraint(outline[i], outline[(i + 1) % outline.size()]);
        }
    } catch (const Constrained::Intersection_of_constraints_exception&) {
        throw Error("the points on the outline are not in order around it: the line through them crosses itself");
    }
}

/// Numbers the vertices that conforming has added, after the given ones.
void number_added_points(Constrained& constrained, std::vector<Point>& points) {
    if (constrained.number_of_vertices() == points.size()) return;
    for (auto vertex : constrained.finite_vertex_handles()) {
        if (vertex->info().value != none) continue;
        vertex->info().value = static_cast<Index>(points.size());
        points.push_back({vertex->point().x(), vertex->point().y()});
    }
}

/// Marks what can be reached from the infinite face without crossing the outline.
void mark_outside(Constrained& constrained) {
    std::vector<Constrained::Face_handle> reached{constrained.infinite_face()};
    reached.front()->info().outside = true;
    while (!reached.empty()) {
        const auto face = reached.back();
        reached.pop_back();
        for (int side = 0; side < 3; ++side) {
            const auto other = face->neighbor(side);
            if (face->is_constrained(side) || other->info().outside) continue;
            other->info().outside = true;
            reached.push_back(other);
        }
    }
}

std::vector<std::array<Index, 3>> triangles_inside(const Constrained& constrained, const std::vector<Index>& rank) {
    std::vector<std::array<Index, 3>> triangles;
    triangles.reserve(2 * rank.size());
    for (auto face : constrained.finite_face_handles()) {
        if (face->info().outside) continue;
        const auto node = [&](int corner) { return rank[face->vertex(corner)->info().value]; };
        triangles.push_back({node(0), node(1), node(2)});
    }
    return triangles;
}

void place_nodes(Mesh& mesh, const std::vector<Point>& points, const std::vector<Index>& order) {
    for (const Index number : order) {
        mesh.x.push_back(points[number].x);
        mesh.y.push_back(points[number].y);
    }
}

std::vector<Index> inverse(const std::vector<Index>& order) {
    std::vector<Index> rank(order.size());
    for (Index i = 0; i < order.size(); ++i) rank[order[i]] = i;
    return rank;
}

/// What every later computation relies on: each node has a cell, and the cells cover the domain once.
void check_cells(const Mesh& mesh) {
    double sum = 0;
    for (Index node = 0; node < mesh.size(); ++node) {
        if (!(mesh.cell_area[node] > 0)) {
            throw Error(
                fmt::format("the point at ({}, {}) has no cell: it lies outside the outline, or too near another",
                            mesh.x[node], mesh.y[node]));
        }
        sum += mesh.cell_area[node];
    }
    const double domain = polygon_area(mesh.outline);
    if (!(std::abs(sum - domain) <= 1e-9 * domain)) {
        throw Error(fmt::format(
            "the cells cover {} m² of a domain of {} m²: the points on the outline do not follow it", sum, domain));
    }
}

}  // namespace

Mesh triangulate(const Polygon& outline, const PointSet& set) {
    Mesh mesh;
    mesh.outline = checked_outline(outline);
    std::vector<Point> points = set.points;
    std::vector<Index> order = hilbert_order(points);
    Constrained constrained;
    {
        Delaunay delaunay;
        const auto outline_vertices = insert_points(delaunay, set, order);
        take_over(delaunay, constrained);
        constrain_outline(constrained, outline_vertices);
    }
    CGAL::make_conforming_Gabriel_2(constrained);
    number_added_points(constrained, points);
    if (points.size() > order.size()) order = hilbert_order(points);
    mark_outside(constrained);

    const std::vector<Index> rank = inverse(order);
    place_nodes(mesh, points, order);
    mesh.on_outline.resize(points.size());
    for (Index number = 0; number < points.size(); ++number) {
        mesh.on_outline[rank[number]] = number < set.outline_count || number >= set.points.size();
    }
    mesh.triangles = triangles_inside(constrained, rank);
    sort_triangles(mesh);
    connect_neighbors(mesh);
    measure_cells(mesh);
    check_cells(mesh);
    return mesh;
}

}  // namespace thalweg::mesh
