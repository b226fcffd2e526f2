// SPDX-License-Identifier: GPL-3.0-or-later
#include "thalweg/surface/hillshade.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "thalweg/core/parallel.hpp"

namespace thalweg::surface {
namespace {

/// The 3 × 3 heights around a cell, row by row from the north-west, holes filled with the height in the middle.
std::array<double, 9> around(const Raster& r, Index row, Index col) {
    const double middle = r.values[std::size_t{row} * r.grid.cols + col];
    std::array<double, 9> heights;
    heights.fill(middle);
    for (int i = 0; i < 9; ++i) {
        const std::int64_t y = std::int64_t{row} + i / 3 - 1, x = std::int64_t{col} + i % 3 - 1;
        if (y < 0 || x < 0 || y >= r.grid.rows || x >= r.grid.cols) continue;
        const double height = r.values[static_cast<std::size_t>(y) * r.grid.cols + static_cast<std::size_t>(x)];
        if (!std::isnan(height)) heights[i] = height;
    }
    return heights;
}

double light(const std::array<double, 9>& z, double dx, double dy) {
    const double east = (z[2] + 2 * z[5] + z[8] - z[0] - 2 * z[3] - z[6]) / (8 * dx);
    const double north = (z[0] + 2 * z[1] + z[2] - z[6] - 2 * z[7] - z[8]) / (8 * dy);
    // The sun stands in the direction (−1, 1, √2)/2, the normal is (−east, −north, 1).
    const double cosine =
        (0.5 * east - 0.5 * north + 0.5 * std::numbers::sqrt2) / std::sqrt(1 + east * east + north * north);
    return std::clamp(cosine, 0.0, 1.0);
}

}  // namespace

std::vector<double> hillshade(const Raster& elevation_m) {
    const Grid& grid = elevation_m.grid;
    std::vector<double> shade(grid.size());
    for (Index row = 0; row < grid.rows; ++row) {
        const double dx = grid.east_west[row];
        const double dy = grid.north_south.empty() ? dx : grid.north_south[std::min(row, grid.rows - 2)];
        for (Index col = 0; col < grid.cols; ++col) {
            const Index node = row * grid.cols + col;
            const double height = elevation_m.values[node];
            shade[node] = std::isnan(height) ? height : light(around(elevation_m, row, col), dx, dy);
        }
    }
    return shade;
}

}  // namespace thalweg::surface
