// SPDX-License-Identifier: GPL-3.0-or-later
#include "thalweg/study/growth_site.hpp"

#include <catch2/catch.hpp>

#include <algorithm>
#include <cmath>

#include "study/trunk.hpp"
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

grow::Dials dials_with(double channel_maintenance_m) {
    grow::Dials dials;
    dials.channel_maintenance_m = channel_maintenance_m;
    return dials;
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
    e.growth.channel_maintenance_m = 900;
    const GrowthSite site = site_of(e);
    const double area = io::geodesic_area({{10, 47}, {10.1, 47}, {10.1, 47.1}, {10, 47.1}});
    CHECK(mesh::polygon_area(site.basin.outline) == Approx(std::abs(area)).epsilon(1e-5));
    CHECK(std::hypot(site.basin.source.x - site.basin.outlet.x, site.basin.source.y - site.basin.outlet.y) ==
          Approx(0.08 * 111177).epsilon(1e-3));
    CHECK_FALSE(site.crs_wkt.empty());
    CHECK(site.basin.bends.size() == 1);
    // A parallel is no straight line on the plane, so the outlet lay beside the outline.
    REQUIRE(site.warnings.size() == 1);
    CHECK_THAT(site.warnings[0], Catch::Contains("its outlet lay 1.21 m off the outline"));
    e.growth.channel_maintenance_m = 4000;  // the bend lies 1.5 km off the straight line
    const GrowthSite straight = site_of(e);
    CHECK(straight.basin.bends.empty());
    CHECK_THAT(straight.warnings.back(), Catch::Contains("0 of the 1 bends drawn are kept"));
}

TEST_CASE("A basin across ±180° is as large as one elsewhere, however its longitudes are written") {
    const TempFolder folder;
    const auto site_about = [&](double west, double middle, double east, double trunk) {
        const auto text = [](double lon, double lat) {
            return "[" + std::to_string(lon) + "," + std::to_string(lat) + "]";
        };
        std::string ring;
        for (const auto& [lon, lat] :
             {std::pair{west, -17.0}, {middle, -17.0}, {east, -17.0}, {east, -16.9}, {west, -16.9}}) {
            ring += text(lon, lat) + ",";
        }
        Experiment e;
        e.basin.outline =
            folder.text("basin.geojson", R"({"type": "Polygon", "coordinates": [[)" + ring + text(west, -17) + "]]}");
        e.basin.trunk = folder.text("trunk.geojson", R"({"type": "LineString", "coordinates": [)" + text(trunk, -17) +
                                                         "," + text(trunk, -16.92) + "]}");
        return site_of(e);
    };
    const GrowthSite elsewhere = site_about(9.95, 10, 10.05, 10.01);
    const auto same = [&](const GrowthSite& site) {
        REQUIRE(site.basin.outline.size() == elsewhere.basin.outline.size());
        for (std::size_t i = 0; i < site.basin.outline.size(); ++i) {
            CHECK(site.basin.outline[i].x == Approx(elsewhere.basin.outline[i].x).margin(1e-3));
            CHECK(site.basin.outline[i].y == Approx(elsewhere.basin.outline[i].y).margin(1e-3));
        }
        CHECK(site.basin.source.x == Approx(elsewhere.basin.source.x).margin(1e-3));
        CHECK(site.basin.outlet.y == Approx(elsewhere.basin.outlet.y).margin(1e-3));
    };
    same(site_about(179.95, 180, -179.95, -179.99));
    same(site_about(179.95, -180, -179.95, -179.99));
    same(site_about(179.95, 180, 180.05, -179.99));
    same(site_about(-180.05, -180, -179.95, 180.01));
    same(site_about(359.95, 0, 0.05, 0.01));
    Experiment e;
    e.basin.outline = folder.text(
        "pole.geojson", R"({"type": "Polygon", "coordinates": [[[0, 80], [90, 80], [180, 80], [-90, 80], [0, 80]]]})");
    e.basin.trunk = std::vector<Point>{{0, 80}, {0, 85}};
    CHECK_THAT(refusal(e), Catch::Contains("basin.outline goes around a pole"));
    e.basin.outline = folder.text("cut.geojson", R"({"type": "MultiPolygon", "coordinates": [
        [[[179, 0], [180, 0], [180, 1], [179, 1], [179, 0]]], [[[-180, 0], [-179, 0], [-179, 1], [-180, 1], [-180, 0]]]]})");
    CHECK_THAT(refusal(e), Catch::Contains("draw it in one piece, with longitudes beyond 180"));
}

TEST_CASE("A trunk that was drawn downstream is turned round, and that is said") {
    Experiment e;
    e.basin.outline = square;
    const auto turned = [&](const Point& first, const Point& last) {
        e.basin.trunk = std::vector<Point>{first, last};
        const GrowthSite site = site_of(e);
        const bool is_turned = !site.warnings.empty() && site.warnings[0].find("turned round") != std::string::npos;
        CHECK(site.basin.outlet.y == 0);
        CHECK(site.basin.source == (is_turned ? first : last));
        return is_turned;
    };
    CHECK(turned({500, 800}, {500, 0}));
    CHECK(turned({500, 800}, {500, 10}));   // not quite on the outline
    CHECK(turned({500, 800}, {500, -10}));  // nor inside it
    CHECK(turned({500, 995}, {500, 0}));    // its source is near the outline, too
    CHECK_FALSE(turned({500, 0}, {500, 800}));
    CHECK_FALSE(turned({500, 0}, {500, 995}));
    CHECK_FALSE(turned({500, 5}, {500, 800}));
    e.basin.trunk = std::vector<Point>{{500, 0}, {500, 1000}};
    CHECK_THAT(refusal(e), Catch::Contains("not inside") && Catch::Contains("turn it round"));
}

TEST_CASE("An outline that crosses itself is told where, on the map") {
    const TempFolder folder;
    Experiment e;
    e.basin.outline = folder.text(
        "bow.geojson", R"({"type": "Polygon", "coordinates": [[[10, 47], [11, 48], [11, 47], [10, 48], [10, 47]]]})");
    e.basin.trunk = std::vector<Point>{{10, 47.5}, {10.2, 47.5}};
    CHECK_THAT(refusal(e), Catch::Contains("itself at (10.5, 47.5)"));
    std::vector<Point> repeating;
    for (const Point& p : square) repeating.insert(repeating.end(), {p, p});
    e.basin.outline = repeating;
    e.basin.trunk = std::vector<Point>{{500, 0}, {500, 800}};
    CHECK(site_of(e).basin.outline == square);
}

TEST_CASE("A DEM gives its largest basin's outline, and its main stream as trunk") {
    const Raster dem = valley();
    const GrowthSite site = growth_site(Catchment{dem, 59 * 40 + 20}, dials_with(100));
    CHECK(mesh::polygon_area(site.basin.outline) == Approx(400 * 600));
    CHECK(site.basin.outlet.y == Approx(9000 - 600));
    CHECK(site.basin.outlet.x == Approx(5205));
    CHECK(site.basin.source.x == Approx(5205));
    CHECK(site.basin.source.y > 8800);
    CHECK(site.basin.base_level_m == 102);
    CHECK(site.warnings.empty());
}

TEST_CASE("The trunk follows a main stream that winds out of sight") {
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
    const GrowthSite site = growth_site(Catchment{dem, 59 * 40 + 8}, dials_with(60));
    CHECK(site.warnings.empty());
    CHECK(site.basin.bends.size() <= 3);
    REQUIRE(site.basin.bends.size() >= 1);
    double nearest = 1e9;  // to where the valley turns
    for (const Point& p : site.basin.bends) nearest = std::min(nearest, std::hypot(p.x - 5085, p.y - 8875));
    CHECK(nearest < 80);
    CHECK(site.basin.source.x > 5300);
    CHECK(grow::grow(site.basin, dials_with(60)).stopped == grow::StopReason::density_reached);
}

TEST_CASE("A river that bends out of sight is followed, and seen up to its bend only") {
    // A basin like a horseshoe, and its river in the middle.
    grow::Basin basin{
        .outline = {{0, 0}, {1000, 0}, {1000, 4000}, {3000, 4000}, {3000, 0}, {4000, 0}, {4000, 5000}, {0, 5000}},
        .outlet = {500, 0},
        .source = {500, 100}};
    std::vector<Point> river;
    for (double y = 0; y <= 4500; y += 50) river.push_back({500, y});
    for (double x = 550; x <= 3500; x += 50) river.push_back({x, 4500});
    for (double y = 4450; y >= 500; y -= 50) river.push_back({3500, y});
    grow::Basin followed = basin, seen = basin;
    CHECK(follow_river(river, smoothed(river, 5), dials_with(400), followed) == 1);
    CHECK(followed.source == Point{3500, 500});
    CHECK(followed.bends.size() >= 2);
    CHECK_NOTHROW(grow::check_trunk(followed, dials_with(400)));
    const double share = see_river(river, dials_with(400), seen);
    CHECK(share > 0.39);  // its bend is at 0.39, and one sees a little farther
    CHECK(share < 0.45);
    CHECK(seen.bends.empty());
    // Where no network fits, nothing changes.
    grow::Basin none_fits = basin;
    CHECK(follow_river(river, river, dials_with(1e5), none_fits) == 0);
    CHECK(none_fits.source == basin.source);
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
