// SPDX-License-Identifier: GPL-3.0-or-later
#include "study/coarser.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace thalweg::study {
namespace {

/// Cells [first, last) of `from` that make cell i of `to`.
struct Block {
    Index first, last;
    Block(Index i, Index from, Index to)
        : first(static_cast<Index>(std::uint64_t{i} * from / to)),
          last(static_cast<Index>((std::uint64_t{i} + 1) * from / to)) {}
    Index middle() const { return (first + last - 1) / 2; }
};

double block_mean(const Raster& raster, const Block& rows, const Block& cols) {
    double sum = 0;
    std::size_t count = 0;
    for (Index r = rows.first; r < rows.last; ++r) {
        for (Index c = cols.first; c < cols.last; ++c) {
            const double value = raster.values[std::size_t{r} * raster.grid.cols + c];
            if (std::isnan(value)) continue;
            sum += value;
            ++count;
        }
    }
    const std::size_t cells = std::size_t{rows.last - rows.first} * (cols.last - cols.first);
    return 2 * count >= cells && count > 0 ? sum / static_cast<double>(count)
                                           : std::numeric_limits<double>::quiet_NaN();
}

Grid coarser_grid(const Grid& grid, Index rows, Index cols) {
    const double taller = double(grid.rows) / rows, wider = double(grid.cols) / cols;
    Grid coarse{.rows = rows, .cols = cols, .cell_area = {}, .east_west = {}, .north_south = {}, .diagonal = {}};
    for (Index row = 0; row < rows; ++row) {
        const Index middle = Block(row, grid.rows, rows).middle();
        coarse.east_west.push_back(grid.east_west[middle] * wider);
        coarse.cell_area.push_back(grid.cell_area[middle] * wider * taller);
        if (row + 1 == rows) break;
        coarse.north_south.push_back(grid.north_south[std::min(middle, grid.rows - 2)] * taller);
        coarse.diagonal.push_back(std::hypot(coarse.east_west.back(), coarse.north_south.back()));
    }
    return coarse;
}

}  // namespace

Raster coarser(const Raster& raster, Index longer_side) {
    const Index longer = std::max(raster.grid.rows, raster.grid.cols);
    if (longer <= longer_side) return raster;
    const auto reduced = [&](Index count) {
        const double share = double(longer_side) / longer;
        return std::clamp<Index>(static_cast<Index>(std::lround(count * share)), std::min<Index>(2, count), count);
    };
    const Index rows = reduced(raster.grid.rows), cols = reduced(raster.grid.cols);
    Raster coarse{.grid = coarser_grid(raster.grid, rows, cols), .placement = raster.placement, .values = {}};
    coarse.placement.cell_width *= double(raster.grid.cols) / cols;
    coarse.placement.cell_height *= double(raster.grid.rows) / rows;
    coarse.values.reserve(coarse.grid.size());
    for (Index row = 0; row < rows; ++row) {
        for (Index col = 0; col < cols; ++col) {
            coarse.values.push_back(block_mean(raster, {row, raster.grid.rows, rows}, {col, raster.grid.cols, cols}));
        }
    }
    return coarse;
}

}  // namespace thalweg::study
