// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <vector>

#include "thalweg/core/grid.hpp"
#include "thalweg/core/mesh.hpp"

namespace thalweg::evolve {

/// What diffusion may do at a node.
enum class Creep : std::uint8_t { no_data, moves, fixed };

/// A vector in the plane.
struct Plane {
    double x, y;
};

inline double dot(const Plane& a, const Plane& b) { return a.x * b.x + a.y * b.y; }

/// A piece of the plane with one gradient, Σ h(corner k)·slope[k]. A corner equal to corner 0 stands for none and has
/// the slope 0.
struct Patch {
    std::array<Index, 3> corner;
    double weight_m2;
    std::array<Plane, 3> slope;  // 1/m

    Plane gradient(const std::vector<double>& elevation_m) const {
        const double a = elevation_m[corner[1]] - elevation_m[corner[0]];
        const double b = elevation_m[corner[2]] - elevation_m[corner[0]];
        return {a * slope[1].x + b * slope[2].x, a * slope[1].y + b * slope[2].y};
    }
};

inline Patch patch(const std::array<Index, 3>& corner, double weight_m2, const Plane& first, const Plane& second) {
    return {corner, weight_m2, {Plane{-first.x - second.x, -first.y - second.y}, first, second}};
}

/// The corners of every cell: a quarter of the rectangle between a cell's centre and those of a horizontal and a
/// vertical neighbour. Beyond the grid's edge and towards no data the surface goes on level.
template <class Visit>
void visit_patches(const Grid& grid, const std::vector<Creep>& creep, Visit visit) {
    const auto has_data = [&](Index node) { return creep[node] != Creep::no_data; };
    for (Index row = 0; row < grid.rows; ++row) {
        const double width = grid.east_west[row];
        const double own_height = grid.cell_area[row] / width;
        for (Index col = 0; col < grid.cols; ++col) {
            const Index node = row * grid.cols + col;
            if (!has_data(node)) continue;
            for (const bool south : {false, true}) {
                const bool inside = south ? row + 1 < grid.rows : row > 0;
                const double height = inside ? grid.north_south[south ? row : row - 1] : own_height;
                const Index beside = inside ? (south ? node + grid.cols : node - grid.cols) : node;
                const bool vertical = inside && has_data(beside);
                for (const bool east : {false, true}) {
                    const bool in_row = east ? col + 1 < grid.cols : col > 0;
                    const Index next = in_row ? (east ? node + 1 : node - 1) : node;
                    const bool level = in_row && has_data(next);
                    if (!level && !vertical) continue;
                    visit(patch({node, level ? next : node, vertical ? beside : node}, width * height / 4,
                                {level ? 1 / width : 0, 0}, {0, vertical ? 1 / height : 0}));
                }
            }
        }
    }
}

/// The triangles.
template <class Visit>
void visit_patches(const Mesh& mesh, const std::vector<Creep>& creep, Visit visit) {
    for (const auto& t : mesh.triangles) {
        if (creep[t[0]] == Creep::no_data || creep[t[1]] == Creep::no_data || creep[t[2]] == Creep::no_data) continue;
        const double ax = mesh.x[t[1]] - mesh.x[t[0]], ay = mesh.y[t[1]] - mesh.y[t[0]];
        const double bx = mesh.x[t[2]] - mesh.x[t[0]], by = mesh.y[t[2]] - mesh.y[t[0]];
        const double twice_area = ax * by - ay * bx;
        visit(patch(t, 0.5 * std::abs(twice_area), {by / twice_area, -bx / twice_area},
                    {-ay / twice_area, ax / twice_area}));
    }
}

}  // namespace thalweg::evolve
