// SPDX-License-Identifier: GPL-3.0-or-later
#include "thalweg/surface/heightfield.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "surface/coverage.hpp"
#include "thalweg/core/error.hpp"

namespace thalweg::surface {
namespace {

Point node_at(const Mesh& mesh, Index node) { return {mesh.x[node], mesh.y[node]}; }

double distance2(const Point& a, const Point& b) { return (a.x - b.x) * (a.x - b.x) + (a.y - b.y) * (a.y - b.y); }

Triangulation plane_of(const Mesh& mesh) { return {mesh.x, mesh.y, mesh.triangles}; }

double interpolate(const std::array<double, 3>& v, const std::array<double, 3>& at) {
    const double sum = at[0] + at[1] + at[2];
    const double value = at[0] / sum * v[0] + at[1] / sum * v[1] + at[2] / sum * v[2];
    if (std::isnan(value)) return value;
    return std::clamp(value, std::min({v[0], v[1], v[2]}), std::max({v[0], v[1], v[2]}));  // against rounding
}

/// Down the distances over the neighbours. The straight line from a corner of the place's own triangle leaves a node's
/// cell only to a neighbour nearer to the place, so the walk ends at the nearest node, after a step or two.
Index walk_to_nearest(const Mesh& mesh, const std::array<Index, 3>& t, const Point& p) {
    const auto nearer = [&](Index a, Index b) {
        const double to_a = distance2(node_at(mesh, a), p);
        const double to_b = distance2(node_at(mesh, b), p);
        return to_a < to_b || (to_a == to_b && a < b);
    };
    Index nearest = *std::min_element(t.begin(), t.end(), nearer);
    for (Index here = none; here != nearest;) {
        here = nearest;
        mesh.neighbors(here, [&](Index other, double, Slot) {
            if (nearer(other, nearest)) nearest = other;
        });
    }
    return nearest;
}

}  // namespace

Raster covering_raster(const Mesh& mesh, Index resolution) {
    if (resolution == 0) throw Error("a raster needs a resolution of at least one cell along its longer side");
    if (mesh.size() == 0) throw Error("a raster cannot cover a mesh without nodes");
    const auto [west, east] = std::minmax_element(mesh.x.begin(), mesh.x.end());
    const auto [south, north] = std::minmax_element(mesh.y.begin(), mesh.y.end());
    const double width = *east - *west;
    const double height = *north - *south;
    const double cell = std::max(width, height) / resolution;
    const auto cells_across = [&](double length) {
        return static_cast<Index>(std::max(1.0, std::ceil(length / cell - 1e-9)));  // whole numbers stay themselves
    };
    Raster raster;
    raster.grid = plane_grid(cells_across(height), cells_across(width), cell, cell);
    raster.placement.west = *west;
    raster.placement.north = *north;
    raster.placement.cell_width = cell;
    raster.placement.cell_height = cell;
    raster.values.assign(raster.grid.size(), std::numeric_limits<double>::quiet_NaN());
    return raster;
}

void interpolate_linear(const Mesh& mesh, std::span<const double> node_values, Raster& raster) {
    if (node_values.size() != mesh.size()) {
        throw Error(fmt::format("{} values for the {} nodes of the mesh", node_values.size(), mesh.size()));
    }
    raster.values.assign(raster.grid.size(), std::numeric_limits<double>::quiet_NaN());
    cover(plane_of(mesh), raster, [&](const Claim& claim) {
        const std::array<Index, 3>& t = mesh.triangles[claim.triangle];
        const std::array<double, 3> corners{node_values[t[0]], node_values[t[1]], node_values[t[2]]};
        for (std::size_t i = 0; i < claim.cells.size(); ++i) {
            raster.values[claim.cells[i]] = interpolate(corners, {claim.at[0][i], claim.at[1][i], claim.at[2][i]});
        }
    });
}

std::vector<Index> nearest_node(const Mesh& mesh, const Raster& raster) {
    std::vector<Index> nearest(raster.grid.size(), none);
    cover(plane_of(mesh), raster, [&](const Claim& claim) {
        for (const Index cell : claim.cells) {
            const Point center = raster.placement.center(raster.grid.row(cell), raster.grid.col(cell));
            nearest[cell] = walk_to_nearest(mesh, mesh.triangles[claim.triangle], center);
        }
    });
    return nearest;
}

}  // namespace thalweg::surface
