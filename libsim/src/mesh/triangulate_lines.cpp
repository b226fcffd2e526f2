// SPDX-License-Identifier: GPL-3.0-or-later
#include "thalweg/mesh/triangulate_lines.hpp"

#include <fmt/format.h>

#include "mesh/constrained.hpp"
#include "thalweg/core/error.hpp"
#include "thalweg/mesh/hilbert.hpp"

namespace thalweg::mesh {
namespace {

void insert_lines(Constrained& constrained, const std::vector<Constrained::Vertex_handle>& vertices,
                  std::span<const std::array<Index, 2>> lines) {
    for (const auto& [a, b] : lines) {
        if (a >= vertices.size() || b >= vertices.size() || a == b) {
            throw Error(fmt::format("a line joins the points {} and {} of {}: it needs two", a, b, vertices.size()));
        }
        try {
            constrained.insert_constraint(vertices[a], vertices[b]);
        } catch (const Constrained::Intersection_of_constraints_exception&) {
            const auto& p = vertices[a]->point();
            const auto& q = vertices[b]->point();
            throw Error(fmt::format("the line ({}, {})–({}, {}) crosses another", p.x(), p.y(), q.x(), q.y()));
        }
    }
}

/// Marks all faces that can be reached from infinity without crossing a line.
void mark_outside(Constrained& constrained) {
    std::vector<Constrained::Face_handle> waiting{constrained.infinite_face()};
    waiting.front()->info().rings_crossed = 0;
    while (!waiting.empty()) {
        const auto face = waiting.back();
        waiting.pop_back();
        for (int side = 0; side < 3; ++side) {
            const auto beyond = face->neighbor(side);
            if (face->is_constrained(side) || beyond->info().rings_crossed == 0) continue;
            beyond->info().rings_crossed = 0;
            waiting.push_back(beyond);
        }
    }
}

}  // namespace

std::vector<std::array<Index, 3>> triangulate_lines(std::span<const Point> points,
                                                    std::span<const std::array<Index, 2>> lines) {
    Constrained constrained;
    const auto vertices = insert_points(constrained, points, static_cast<Index>(points.size()), hilbert_order(points));
    insert_lines(constrained, vertices, lines);
    mark_outside(constrained);
    std::vector<std::array<Index, 3>> triangles;
    triangles.reserve(constrained.number_of_faces());
    for (const auto face : constrained.finite_face_handles()) {
        if (face->info().rings_crossed == 0) continue;
        triangles.push_back(
            {face->vertex(0)->info().value, face->vertex(1)->info().value, face->vertex(2)->info().value});
    }
    return triangles;
}

}  // namespace thalweg::mesh
