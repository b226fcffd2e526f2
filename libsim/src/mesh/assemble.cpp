// SPDX-License-Identifier: GPL-3.0-or-later
#include "mesh/assemble.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "thalweg/core/error.hpp"

namespace thalweg::mesh {
namespace {

using Triangle = std::array<Index, 3>;

void start_with_lowest(Triangle& corners) {
    std::rotate(corners.begin(), std::min_element(corners.begin(), corners.end()), corners.end());
}

/// Calls visit(a, b) for the three sides of every triangle: an edge inside the domain comes twice, once each way.
template <class Visit>
void visit_directed_edges(const Mesh& mesh, Visit visit) {
    for (const Triangle& t : mesh.triangles) {
        visit(t[0], t[1]);
        visit(t[1], t[2]);
        visit(t[2], t[0]);
    }
}

double length_between(const Mesh& mesh, Index a, Index b) {
    const double dx = mesh.x[a] - mesh.x[b];
    const double dy = mesh.y[a] - mesh.y[b];
    return std::sqrt(dx * dx + dy * dy);  // squares forget the sign: the same bits from both ends
}

}  // namespace

void sort_triangles(Mesh& mesh) {
    std::vector<Index> start(mesh.size() + 1, 0);
    for (Triangle& t : mesh.triangles) {
        start_with_lowest(t);
        ++start[t[0] + 1];
    }
    std::partial_sum(start.begin(), start.end(), start.begin());
    std::vector<Triangle> sorted(mesh.triangles.size());
    std::vector<Index> next(start.begin(), start.end() - 1);
    for (const Triangle& t : mesh.triangles) sorted[next[t[0]]++] = t;
    for (Index node = 0; node < mesh.size(); ++node) {
        std::sort(sorted.begin() + start[node], sorted.begin() + start[node + 1]);
    }
    mesh.triangles.swap(sorted);
}

void connect_neighbors(Mesh& mesh) {
    // Every edge is entered from both its triangles, so inside the domain twice: room for all, then duplicates go.
    std::vector<Index> start(mesh.size() + 1, 0);
    visit_directed_edges(mesh, [&](Index a, Index b) {
        ++start[a + 1];
        ++start[b + 1];
    });
    std::partial_sum(start.begin(), start.end(), start.begin());
    std::vector<Index> entries(start.back());
    std::vector<Index> next(start.begin(), start.end() - 1);
    visit_directed_edges(mesh, [&](Index a, Index b) {
        entries[next[a]++] = b;
        entries[next[b]++] = a;
    });
    mesh.offset.assign(1, 0);
    mesh.offset.reserve(mesh.size() + 1);
    mesh.neighbor_list.clear();
    mesh.neighbor_list.reserve(entries.size() / 2 + mesh.size());
    for (Index node = 0; node < mesh.size(); ++node) {
        const auto first = entries.begin() + start[node];
        const auto last = entries.begin() + start[node + 1];
        std::sort(first, last);
        mesh.neighbor_list.insert(mesh.neighbor_list.end(), first, std::unique(first, last));
        mesh.offset.push_back(static_cast<Index>(mesh.neighbor_list.size()));
        if (mesh.offset[node + 1] - mesh.offset[node] >= no_flow) {
            throw Error(
                fmt::format("the point at ({}, {}) has more than 254 neighbours: the outline needs points at a "
                            "spacing more like that of the points inside",
                            mesh.x[node], mesh.y[node]));
        }
    }
    mesh.length_list.resize(mesh.neighbor_list.size());
    for (Index node = 0; node < mesh.size(); ++node) {
        for (Index at = mesh.offset[node]; at < mesh.offset[node + 1]; ++at) {
            mesh.length_list[at] = length_between(mesh, node, mesh.neighbor_list[at]);
        }
    }
}

void measure_cells(Mesh& mesh) {
    mesh.cell_area.assign(mesh.size(), 0);
    for (const Triangle& t : mesh.triangles) {
        std::array<Point, 3> side;  // side[k] runs from corner k + 1 to corner k + 2, opposite corner k
        for (std::size_t k = 0; k < 3; ++k) {
            const Index from = t[(k + 1) % 3];
            const Index to = t[(k + 2) % 3];
            side[k] = {mesh.x[to] - mesh.x[from], mesh.y[to] - mesh.y[from]};
        }
        const double twice_area = side[0].x * side[1].y - side[0].y * side[1].x;
        for (std::size_t k = 0; k < 3; ++k) {
            const Point& a = side[(k + 1) % 3];
            const Point& b = side[(k + 2) % 3];
            const double cotangent = -(a.x * b.x + a.y * b.y) / twice_area;
            const double piece = (side[k].x * side[k].x + side[k].y * side[k].y) * cotangent / 8;
            mesh.cell_area[t[(k + 1) % 3]] += piece;
            mesh.cell_area[t[(k + 2) % 3]] += piece;
        }
    }
}

}  // namespace thalweg::mesh
