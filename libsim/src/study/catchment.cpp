// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <limits>

#include "study/cut_out.hpp"
#include "thalweg/core/error.hpp"
#include "thalweg/study/domain.hpp"

namespace thalweg::study {
namespace {

constexpr double nan = std::numeric_limits<double>::quiet_NaN();

template <class T>
std::vector<T> slice(const std::vector<T>& values, Index first, Index count) {
    return {values.begin() + first, values.begin() + first + count};
}

/// Rows and columns [first, first + count) of a raster, with the same measures.
struct Window {
    Index first_row, rows, first_col, cols;
};

Raster crop(const Raster& whole, const Window& w) {
    Raster part;
    part.grid = {.rows = w.rows,
                 .cols = w.cols,
                 .cell_area = slice(whole.grid.cell_area, w.first_row, w.rows),
                 .east_west = slice(whole.grid.east_west, w.first_row, w.rows),
                 .north_south = slice(whole.grid.north_south, w.first_row, w.rows - 1),
                 .diagonal = slice(whole.grid.diagonal, w.first_row, w.rows - 1)};
    part.placement = whole.placement;
    part.placement.west += w.first_col * whole.placement.cell_width;
    part.placement.north -= w.first_row * whole.placement.cell_height;
    for (Index r = 0; r < w.rows; ++r) {
        const auto row = whole.values.begin() + std::size_t{w.first_row + r} * whole.grid.cols + w.first_col;
        part.values.insert(part.values.end(), row, row + w.cols);
    }
    return part;
}

/// Smallest window around the cells labelled 0, with a margin of one cell where the raster has one.
Window window_around(const Grid& grid, std::span<const Index> label) {
    Index top = grid.rows, bottom = 0, left = grid.cols, right = 0;
    for (Index node = 0; node < grid.size(); ++node) {
        if (label[node] != 0) continue;
        top = std::min(top, grid.row(node));
        bottom = std::max(bottom, grid.row(node));
        left = std::min(left, grid.col(node));
        right = std::max(right, grid.col(node));
    }
    top -= top > 0;
    left -= left > 0;
    bottom += bottom + 1 < grid.rows;
    right += right + 1 < grid.cols;
    return {top, bottom - top + 1, left, right - left + 1};
}

}  // namespace

Catchment cut_out(const Raster& dem, std::span<const Index> label, Index outlet) {
    std::vector<double> masked(dem.values.size(), nan);
    for (Index node = 0; node < dem.grid.size(); ++node) {
        if (label[node] == 0) masked[node] = dem.values[node];
    }
    const Window window = window_around(dem.grid, label);
    const Index row = dem.grid.row(outlet) - window.first_row, col = dem.grid.col(outlet) - window.first_col;
    return {.raster = crop({dem.grid, dem.placement, std::move(masked)}, window), .outlet = row * window.cols + col};
}

Catchment largest_complete_catchment(const Raster& dem, const MeasureOptions& options) {
    const RasterMeasurement m = measure_raster(dem, options);
    const auto& basins = m.statistics.basins;
    if (basins.empty() || !basins.front().basin.complete) {
        throw Error(
            "the DEM holds no complete catchment as large as the channel threshold: every river is cut by its edge; "
            "use a larger DEM or a smaller channel area");
    }
    return cut_out(dem, m.statistics.basin_of, basins.front().basin.outlet);
}

}  // namespace thalweg::study
