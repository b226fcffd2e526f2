// SPDX-License-Identifier: GPL-3.0-or-later
#include "study/local_metres.hpp"

#include <cmath>
#include <limits>

#include "thalweg/io/geodesy.hpp"

namespace thalweg::study {
namespace {

std::vector<Point> map_centers(const Raster& raster) {
    std::vector<Point> centers;
    centers.reserve(raster.grid.size());
    for (Index row = 0; row < raster.grid.rows; ++row) {
        for (Index col = 0; col < raster.grid.cols; ++col) centers.push_back(raster.placement.center(row, col));
    }
    return centers;
}

LocalMetres on_the_ellipsoid(const Raster& raster) {
    const Placement& place = raster.placement;
    const Point middle{place.west + raster.grid.cols / 2.0 * place.cell_width,
                       place.north - raster.grid.rows / 2.0 * place.cell_height};
    return {.origin = middle,
            .unit_m = std::numeric_limits<double>::quiet_NaN(),
            .centers = io::to_plane({.longitude_deg = middle.x, .latitude_deg = middle.y}, map_centers(raster))};
}

}  // namespace

LocalMetres local_metres(const Raster& raster) {
    const Placement& place = raster.placement;
    if (place.geographic) return on_the_ellipsoid(raster);
    LocalMetres local{
        .origin = {std::floor(place.west), std::floor(place.north - raster.grid.rows * place.cell_height)},
        .unit_m = raster.grid.east_west[0] / place.cell_width,
        .centers = map_centers(raster)};
    for (Point& p : local.centers) {
        p = {(p.x - local.origin.x) * local.unit_m, (p.y - local.origin.y) * local.unit_m};
    }
    return local;
}

}  // namespace thalweg::study
