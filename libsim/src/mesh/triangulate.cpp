// SPDX-License-Identifier: GPL-3.0-or-later
#include "thalweg/mesh/triangulate.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "mesh/assemble.hpp"
#include "mesh/constrained.hpp"
#include "thalweg/mesh/hilbert.hpp"
#include "mesh/outline.hpp"
#include "thalweg/core/error.hpp"

namespace thalweg::mesh {
namespace {

using Faces = std::vector<Constrained::Face_handle>;

/// Gives `rings` to all faces that can be reached from those in `reached` without crossing a ring, and returns the
/// faces beyond the rings that bound them.
Faces flood(Faces reached, int rings) {
    Faces beyond;
    while (!reached.empty()) {
        const auto face = reached.back();
        reached.pop_back();
        if (face->info().rings_crossed >= 0) continue;
        face->info().rings_crossed = rings;
        for (int side = 0; side < 3; ++side) {
            const auto other = face->neighbor(side);
            if (other->info().rings_crossed < 0) (face->is_constrained(side) ? beyond : reached).push_back(other);
        }
    }
    return beyond;
}

void count_rings(Constrained& constrained) {
    Faces reached{constrained.infinite_face()};
    for (int rings = 0; !reached.empty(); ++rings) reached = flood(std::move(reached), rings);
}

std::vector<std::array<Index, 3>> triangles_inside(const Constrained& constrained, const std::vector<Index>& rank) {
    std::vector<std::array<Index, 3>> triangles;
    triangles.reserve(2 * rank.size());
    for (auto face : constrained.finite_face_handles()) {
        if (face->info().rings_crossed % 2 == 0) continue;
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

double area_within(const Rings& rings) {
    double area = 0;
    for (const Polygon& ring : rings) area += polygon_area(ring);  // of holes, clockwise: negative
    return area;
}

/// The first point of each ring, and where the last ring ends.
std::vector<Index> ring_starts(const PointSet& set) {
    std::vector<Index> start{0};
    start.insert(start.end(), set.hole_start.begin(), set.hole_start.end());
    start.push_back(set.outline_count);
    if (!std::is_sorted(start.begin(), start.end()) || set.outline_count > set.points.size()) {
        throw Error(fmt::format("the rings of the outline's {} points do not follow each other among {} points",
                                set.outline_count, set.points.size()));
    }
    return start;
}

/// What every later computation relies on: each node has a cell, and the cells cover the domain once.
void check_cells(const Mesh& mesh, double domain) {
    double sum = 0;
    for (Index node = 0; node < mesh.size(); ++node) {
        if (!(mesh.cell_area[node] > 0)) {
            throw Error(
                fmt::format("the point at ({}, {}) has no cell: it lies outside the outline, or too near another",
                            mesh.x[node], mesh.y[node]));
        }
        sum += mesh.cell_area[node];
    }
    if (!(std::abs(sum - domain) <= 1e-9 * domain)) {
        throw Error(fmt::format(
            "the cells cover {} m² of a domain of {} m²: the points on the outline do not follow it", sum, domain));
    }
}

}  // namespace

Mesh triangulate(const Polygon& outline, const PointSet& set) { return triangulate(PolygonPart{outline, {}}, set); }

Mesh triangulate(const PolygonPart& domain, const PointSet& set) {
    Mesh mesh;
    const Rings rings = checked_rings(domain);
    mesh.outline = rings.front();
    std::vector<Point> points = set.points;
    std::vector<Index> order = hilbert_order(points);
    Constrained constrained;
    triangulate_conforming(points, ring_starts(set), order, constrained);
    if (points.size() > order.size()) order = hilbert_order(points);
    count_rings(constrained);

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
    check_cells(mesh, area_within(rings));
    return mesh;
}

}  // namespace thalweg::mesh
