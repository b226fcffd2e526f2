// SPDX-License-Identifier: GPL-3.0-or-later
#include "thalweg/core/raster.hpp"

#include <catch2/catch.hpp>

#include <limits>

using namespace thalweg;

namespace {

Raster raster_at(const Placement& placement, Index rows, Index cols) {
    Raster raster;
    raster.grid = plane_grid(rows, cols, 1, 1);
    raster.placement = placement;
    return raster;
}

}  // namespace

TEST_CASE("A point is in the cell that holds it, and on an edge in the eastern or southern one", "[raster]") {
    const Raster raster =
        raster_at({.west = 100, .north = 50, .cell_width = 10, .cell_height = 5, .crs_wkt = {}}, 3, 4);
    CHECK(cell_at(raster, {101, 49}) == 0);
    CHECK(cell_at(raster, {110, 49}) == 1);
    CHECK(cell_at(raster, {109.999, 45.001}) == 0);
    CHECK(cell_at(raster, {109.999, 45}) == 4);
    CHECK(cell_at(raster, {100, 50}) == 0);
    CHECK(cell_at(raster, {140, 35}) == 11);
    for (Index row = 0; row < 3; ++row) {
        for (Index col = 0; col < 4; ++col) CHECK(cell_at(raster, raster.placement.center(row, col)) == row * 4 + col);
    }
}

TEST_CASE("A point beside the raster, or nowhere, is in no cell", "[raster]") {
    const Raster raster =
        raster_at({.west = 100, .north = 50, .cell_width = 10, .cell_height = 5, .crs_wkt = {}}, 3, 4);
    const double nan = std::numeric_limits<double>::quiet_NaN(), infinity = std::numeric_limits<double>::infinity();
    for (const Point p : {Point{99.999, 40}, Point{140.001, 40}, Point{120, 50.001}, Point{120, 34.999}, Point{nan, 40},
                          Point{120, nan}, Point{infinity, 40}, Point{120, -infinity}, Point{1e300, 1e300}}) {
        CHECK(cell_at(raster, p) == none);
    }
}

TEST_CASE("Longitudes may be counted from elsewhere", "[raster]") {
    const Raster pacific = raster_at(
        {.west = 179, .north = 1, .cell_width = 1, .cell_height = 1, .crs_wkt = {}, .geographic = true}, 2, 3);
    CHECK(cell_at(pacific, {-179.5, 0.5}) == 1);
    CHECK(cell_at(pacific, {180.5, 0.5}) == 1);
    CHECK(cell_at(pacific, {-178.5, -0.5}) == 5);
    CHECK(cell_at(pacific, {-177.5, 0.5}) == none);
    CHECK(cell_at(pacific, {178.5, 0.5}) == none);
}

TEST_CASE("The nearest cell with data is found from inside, beside and among voids, the first of two as near") {
    const double nan = std::numeric_limits<double>::quiet_NaN();
    Raster raster{
        plane_grid(2, 3, 10, 10), {.west = 100, .north = 50, .cell_width = 10, .cell_height = 10, .crs_wkt = ""}, {}};
    raster.values = {1, nan, 3, 4, nan, 6};
    CHECK(nearest_cell_with_data(raster, {105, 45}) == 0);
    CHECK(nearest_cell_with_data(raster, {500, 0}) == 5);
    CHECK(nearest_cell_with_data(raster, {114.9, 44}) == 0);
    CHECK(nearest_cell_with_data(raster, {115, 44}) == 0);
    CHECK(nearest_cell_with_data(raster, {115.1, 44}) == 2);
    raster.values.assign(6, nan);
    CHECK(nearest_cell_with_data(raster, {105, 45}) == none);
}
