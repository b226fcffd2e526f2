// SPDX-License-Identifier: GPL-3.0-or-later
#include "thalweg/mesh/triangulate.hpp"

#include <fmt/format.h>

#include <cmath>

#include "mesh/assemble.hpp"
#include "mesh/constrained.hpp"
#include "mesh/hilbert.hpp"
#include "mesh/outline.hpp"
#include "thalweg/core/error.hpp"

namespace thalweg::mesh {
namespace {

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
    triangulate_conforming(points, set.outline_count, order, constrained);
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
