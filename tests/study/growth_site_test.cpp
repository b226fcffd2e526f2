// SPDX-License-Identifier: GPL-3.0-or-later
#include "thalweg/study/growth_site.hpp"

#include <catch2/catch.hpp>

#include <cmath>

#include "support/drawn_catchment.hpp"
#include "support/temp_folder.hpp"
#include "thalweg/io/geodesy.hpp"
#include "thalweg/mesh/triangulate.hpp"

using namespace thalweg;
using namespace thalweg::study;
using test::error_of;
using test::TempFolder;

namespace {

const std::vector<Point> square{{0, 0}, {1000, 0}, {1000, 1000}, {0, 1000}};

GrowthSite site_of(const Experiment& e) { return growth_site(e, Messages{}); }

std::string refusal(const Experiment& e) {
    return error_of([&] { site_of(e); });
}

/// A valley of 40 × 60 cells of 10 m that falls to the south: its floor runs in the middle column, its rim is a divide.
Raster valley() {
    constexpr Index rows = 60, cols = 40;
    Raster raster{
        plane_grid(rows, cols, 10, 10),
        {.west = 5000, .north = 9000, .cell_width = 10, .cell_height = 10, .crs_wkt = "", .geographic = false},
        {}};
    for (Index row = 0; row < rows; ++row) {
        for (Index col = 0; col < cols; ++col) {
            raster.values.push_back(100 + 2.0 * (rows - row) + 3 * std::abs(col - 20.0));
        }
    }
    return raster;
}

}  // namespace

TEST_CASE("A basin drawn in the file is taken as it is, a ring that repeats its first corner too") {
    Experiment e;
    e.basin.outline = square;
    e.basin.trunk = std::vector<Point>{{500, 0}, {500, 800}};
    e.basin.base_level_m = 7;
    const GrowthSite site = site_of(e);
    CHECK(site.basin.outline == square);
    CHECK(site.basin.outlet == Point{500, 0});
    CHECK(site.basin.source == Point{500, 800});
    CHECK(site.basin.base_level_m == 7);
    CHECK(site.unit_m == 1);
    CHECK(site.crs_wkt.empty());
    std::vector<Point> closed = square;
    closed.push_back(square[0]);
    e.basin.outline = closed;
    CHECK(site_of(e).basin.outline == square);
}

TEST_CASE("An outline and a trunk from GeoJSON files in degrees lie on a plane in metres") {
    const TempFolder folder;
    Experiment e;
    e.basin.outline = folder.text(
        "basin.geojson",
        R"({"type": "Polygon", "coordinates": [[[10, 47], [10.1, 47], [10.1, 47.1], [10, 47.1], [10, 47]]]})");
    e.basin.trunk = folder.text(
        "trunk.geojson", R"({"type": "LineString", "coordinates": [[10.05, 47], [10.07, 47.03], [10.05, 47.08]]})");
    const GrowthSite site = site_of(e);
    const double area = io::geodesic_area({{10, 47}, {10.1, 47}, {10.1, 47.1}, {10, 47.1}});
    CHECK(mesh::polygon_area(site.basin.outline) == Approx(std::abs(area)).epsilon(1e-5));
    CHECK(std::hypot(site.basin.source.x - site.basin.outlet.x, site.basin.source.y - site.basin.outlet.y) ==
          Approx(0.08 * 111177).epsilon(1e-3));
    CHECK_FALSE(site.crs_wkt.empty());
    // A parallel is no straight line on the plane, so the outlet lay beside the outline.
    REQUIRE(site.warnings.size() == 2);
    CHECK_THAT(site.warnings[0], Catch::Contains("a trunk is straight, and the bends"));
    CHECK_THAT(site.warnings[1], Catch::Contains("its outlet lay 1.21 m off the outline"));
}

TEST_CASE("A DEM gives its largest basin's outline, and its main stream as trunk") {
    const Raster dem = valley();
    const GrowthSite site = growth_site(Catchment{dem, 59 * 40 + 20});
    CHECK(mesh::polygon_area(site.basin.outline) == Approx(400 * 600));
    CHECK(site.basin.outlet.y == Approx(9000 - 600));
    CHECK(site.basin.outlet.x == Approx(5205));
    CHECK(site.basin.source.x == Approx(5205));
    CHECK(site.basin.source.y > 8800);
    CHECK(site.basin.base_level_m == 102);
    CHECK(site.warnings.empty());
}

TEST_CASE("A main stream that winds out of sight ends the trunk at its uppermost place in sight, and that is said") {
    // The valley bends by a right angle half-way up: data are left out of the inner corner.
    Raster dem = valley();
    for (Index row = 0; row < 60; ++row) {
        for (Index col = 0; col < 40; ++col) {
            double& z = dem.values[row * 40 + col];
            if (row > 25 && col > 15) z = std::nan("");
            if (row > 25 && col <= 15) z = 100 + 2.0 * (60 - row) + 3 * std::abs(col - 8.0);
            if (row <= 25) z = 180 + 2.0 * col + 3 * std::abs(row - 12.0);
        }
    }
    const GrowthSite site = growth_site(Catchment{dem, 59 * 40 + 8});
    REQUIRE(site.warnings.size() == 1);
    CHECK_THAT(site.warnings[0], Catch::Contains("a trunk is straight"));
    CHECK(site.basin.source.y > 8700);
    CHECK(site.basin.source.x < 5250);
    CHECK_NOTHROW(grow::checked_basin(site.basin));
}

TEST_CASE("A basin that says too little, too much or nothing sensible is refused with what to do") {
    const TempFolder folder;
    Experiment e;
    CHECK_THAT(refusal(e), Catch::Contains("basin.outline (or basin.dem) is needed"));
    e.basin.outline = square;
    CHECK_THAT(refusal(e), Catch::Contains("basin.trunk is needed"));
    e.basin.trunk = std::vector<Point>{{500, 0}};
    CHECK_THAT(refusal(e), Catch::Contains("basin.trunk has 1 places"));
    e.basin.trunk = std::vector<Point>{{500, 0}, {500, 2000}};
    CHECK_THAT(refusal(e), Catch::Contains("not inside"));
    e.basin.trunk = std::vector<Point>{{500, -20}, {500, 500}};
    CHECK_THAT(refusal(e), Catch::Contains("20 m off the basin's outline"));
    e.basin.dem = "dem.tif";
    CHECK_THAT(refusal(e), Catch::Contains("give these or the DEM"));
    e.basin.dem.reset();
    e.basin.outline = std::vector<Point>{{0, 0}, {1, 0}};
    CHECK_THAT(refusal(e), Catch::Contains("at least three"));
    e.basin.outline = folder.text("line.geojson", R"({"type": "LineString", "coordinates": [[0, 0], [1, 1]]})");
    CHECK_THAT(refusal(e), Catch::Contains("holds 0 polygons"));
    e.basin.outline = folder.text(
        "holed.geojson",
        R"({"type": "Polygon", "coordinates": [[[0,0],[9,0],[9,9],[0,9],[0,0]], [[3,3],[3,6],[6,6],[6,3],[3,3]]]})");
    CHECK_THAT(refusal(e), Catch::Contains("has holes"));
    e.basin.outline = folder / "none.geojson";
    CHECK_THAT(refusal(e), Catch::Contains("none.geojson"));
}
