// SPDX-License-Identifier: GPL-3.0-or-later
#include "thalweg/surface/heightfield.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "surface/coverage.hpp"
#include "surface/nodes.hpp"
#include "thalweg/core/error.hpp"

namespace thalweg::surface {
namespace {

double interpolate(const std::array<double, 3>& v, const std::array<double, 3>& at) {
    const double sum = at[0] + at[1] + at[2];
    const double value = at[0] / sum * v[0] + at[1] / sum * v[1] + at[2] / sum * v[2];
    if (std::isnan(value)) return value;
    return std::clamp(value, std::min({v[0], v[1], v[2]}), std::max({v[0], v[1], v[2]}));  // against rounding
}

}  // namespace

Grid covering_grid(const Mesh& mesh, Index resolution) {
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
    return plane_grid(cells_across(height), cells_across(width), cell, cell);
}

Raster covering_raster(const Mesh& mesh, Index resolution) {
    Raster raster;
    raster.grid = covering_grid(mesh, resolution);
    raster.placement.west = *std::min_element(mesh.x.begin(), mesh.x.end());
    raster.placement.north = *std::max_element(mesh.y.begin(), mesh.y.end());
    raster.placement.cell_width = raster.grid.east_west[0];
    raster.placement.cell_height = raster.grid.east_west[0];  // square cells; one row has no north-south lengths
    raster.values.assign(raster.grid.size(), std::numeric_limits<double>::quiet_NaN());
    return raster;
}

void interpolate_linear(const Mesh& mesh, std::span<const double> node_values, Raster& raster) {
    check_one_value_per_node(mesh, node_values);
    raster.values.assign(raster.grid.size(), std::numeric_limits<double>::quiet_NaN());
    cover(plane_of(mesh), raster, [&](const Claim& claim) {
        const std::array<Index, 3>& t = mesh.triangles[claim.triangle];
        const std::array<double, 3> corners{node_values[t[0]], node_values[t[1]], node_values[t[2]]};
        for (std::size_t i = 0; i < claim.cells.size(); ++i) {
            raster.values[claim.cells[i]] = interpolate(corners, {claim.at[0][i], claim.at[1][i], claim.at[2][i]});
        }
    });
}

std::vector<double> interpolate_linear_at(const Mesh& mesh, std::span<const double> node_values,
                                          std::span<const Point> points) {
    check_one_value_per_node(mesh, node_values);
    std::vector<double> values(points.size(), std::numeric_limits<double>::quiet_NaN());
    const std::vector<Index> triangle = triangle_of_points(plane_of(mesh), points);
    for (std::size_t i = 0; i < points.size(); ++i) {
        if (triangle[i] == none) continue;
        const std::array<Index, 3>& t = mesh.triangles[triangle[i]];
        values[i] = interpolate({node_values[t[0]], node_values[t[1]], node_values[t[2]]},
                                TriangleTest(plane_of(mesh), t).coordinates(points[i]));
    }
    return values;
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
