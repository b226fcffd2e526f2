// SPDX-License-Identifier: GPL-3.0-or-later
#include "thalweg/core/raster.hpp"

#include <cmath>
#include <limits>

#include "thalweg/core/index.hpp"

namespace thalweg {
namespace {

/// Number of the cell along one axis, `none` outside; what is not a number lies nowhere.
Index along(double cells_from_edge, Index count) {
    if (!(cells_from_edge >= 0 && cells_from_edge <= count)) return none;
    const auto cell = static_cast<Index>(cells_from_edge);
    return cell == count ? count - 1 : cell;
}

}  // namespace

Index cell_at(const Raster& raster, Point point) {
    const Placement& p = raster.placement;
    const Index row = along((p.north - point.y) / p.cell_height, raster.grid.rows);
    Index col = along((point.x - p.west) / p.cell_width, raster.grid.cols);
    if (p.geographic && col == none) {
        const double turned = point.x - 360 * std::floor((point.x - p.west) / 360);
        col = along((turned - p.west) / p.cell_width, raster.grid.cols);
    }
    return row == none || col == none ? none : row * raster.grid.cols + col;
}

Index nearest_cell_with_data(const Raster& raster, Point point) {
    Index nearest = none;
    double least = std::numeric_limits<double>::infinity();
    for (Index cell = 0; cell < raster.grid.size(); ++cell) {
        if (std::isnan(raster.values[cell])) continue;
        const Point center = raster.placement.center(raster.grid.row(cell), raster.grid.col(cell));
        const double distance = std::hypot(center.x - point.x, center.y - point.y);
        if (!(distance < least)) continue;
        least = distance;
        nearest = cell;
    }
    return nearest;
}

}  // namespace thalweg
