// SPDX-License-Identifier: GPL-3.0-or-later
#include "thalweg/study/outlet.hpp"

#include <catch2/catch.hpp>

#include <cmath>
#include <nlohmann/json.hpp>

#include "support/drawn_catchment.hpp"
#include "support/temp_folder.hpp"
#include "support/terrains.hpp"
#include "thalweg/core/error.hpp"
#include "thalweg/io/geodesy.hpp"
#include "thalweg/study/analyze.hpp"

using namespace thalweg;
using namespace thalweg::study;
using Json = nlohmann::json;
using support::drawn_catchment;
using support::raster_of;
using test::TempFolder;

namespace {

constexpr Index cols = 8;  // of the drawn catchment, whose middle column 4 gathers five cells in every row from 1 on

Point middle(const Raster& raster, Index row, Index col) { return raster.placement.center(row, col); }

std::string error_of(const Raster& raster, const OutletRequest& request) {
    try {
        catchment_above(raster, request, MeasureOptions{});
    } catch (const Error& error) {
        return error.what();
    }
    return "";
}

}  // namespace

TEST_CASE("The outlet is moved to the river within reach, and not down along it", "[outlet]") {
    const Raster raster = drawn_catchment();
    const auto above = [&](Index row, Index col, double snap_m) {
        return catchment_above(raster, {middle(raster, row, col), snap_m}, MeasureOptions{}).report;
    };
    const OutletReport beside = above(5, 3, 10);
    CHECK(beside.snapped == middle(raster, 5, 4));
    CHECK(beside.moved_m == Approx(10));
    CHECK(beside.area_m2 == Approx(2500));  // five rows of five cells
    CHECK(beside.complete);
    const OutletReport on_it = above(4, 4, 25);  // two cells down 3000 m2 flow, here 2000
    CHECK(on_it.snapped == middle(raster, 4, 4));
    CHECK(on_it.moved_m == 0);
    CHECK(on_it.area_m2 == Approx(2000));
    CHECK(above(5, 3, 9).snapped == middle(raster, 5, 3));
    CHECK(above(5, 3, 9).area_m2 == Approx(200));  // two cells of its flank
    const OutletReport head = above(1, 4, 25);     // 500 m2 here, 1500 two cells down: the nearest with half of that
    CHECK(head.snapped == middle(raster, 2, 4));
    CHECK(head.moved_m == Approx(10));
}

TEST_CASE("What drains to an outlet is what a walk down from every cell says, and nothing else is measured",
          "[outlet]") {
    for (std::uint64_t seed = 0; seed < 20; ++seed) {
        auto terrain = support::noise_terrain(30, 40, seed);
        for (Index node = 0; node < terrain.grid.size(); ++node) {
            terrain.elevation_m[node] += 0.15 * terrain.grid.row(node);
        }
        const Raster raster = raster_of(seed % 2 ? support::with_holes(terrain, 0.01, seed) : terrain);
        MeasureOptions options;
        options.conditioning = seed % 3 ? Conditioning::fill : Conditioning::carve;
        const RasterMeasurement whole = measure_raster(raster, options);
        const Index start = 10 * 40 + 20;
        if (std::isnan(raster.values[start])) continue;
        const Point at = raster.placement.center(10, 20);
        const OutletCatchment cut = catchment_above(raster, {at, 6.0}, options);
        const Index outlet = cell_at(raster, cut.report.snapped);
        double area = 0;
        for (Index node = 0; node < raster.grid.size(); ++node) {
            if (std::isnan(raster.values[node])) continue;
            Index below = node;
            while (below != outlet && whole.terrain.graph.receiver[below] != none)
                below = whole.terrain.graph.receiver[below];
            const Point p = raster.placement.center(raster.grid.row(node), raster.grid.col(node));
            const Index there = cell_at(cut.raster, p);
            const bool inside = there != none && !std::isnan(cut.raster.values[there]);
            REQUIRE(inside == (below == outlet));
            if (!inside) continue;
            area += 1;
            CHECK(cut.raster.values[there] == raster.values[node]);
        }
        CHECK(cut.report.area_m2 == Approx(area));
        CHECK(cut.report.moved_m <= 6.0);
        options.catchment_outlet = cut.outlet;
        const RasterMeasurement alone = measure_raster(cut.raster, options);
        REQUIRE(alone.statistics.basins.size() == 1);
        CHECK(alone.statistics.basins[0].basin.area_m2 == Approx(area));
        CHECK(cut.report.complete == (whole.terrain.complete[outlet] != 0));
    }
}

TEST_CASE("At the outlet of a DEM's largest basin the same basin is measured again", "[outlet]") {
    const Raster dem = io::read_raster(THALWEG_SOURCE_DIR "/validation/data/jacksboro.tif").raster;
    MeasureOptions options;
    options.channel_area_m2 = 2e5;
    const RasterMeasurement whole = measure_raster(dem, options);
    const BasinStatistics& largest = whole.statistics.basins.front();
    const Point outlet = dem.placement.center(dem.grid.row(largest.basin.outlet), dem.grid.col(largest.basin.outlet));
    NamedRaster named{dem, "jacksboro.tif", "", "", {}, {}};
    const NamedRaster basin = cut_to_outlet(named, {outlet, 0.0}, options, {});
    const RasterMeasurement alone = measure_raster(basin.raster, options);
    REQUIRE(alone.statistics.basins.size() == 1);
    const BasinStatistics& again = alone.statistics.basins.front();
    CHECK(again.basin.area_m2 == Approx(largest.basin.area_m2).epsilon(1e-12));
    CHECK(again.relief_m == largest.relief_m);
    CHECK(again.hypsometry.integral == Approx(largest.hypsometry.integral).epsilon(1e-12));
    CHECK(again.max_strahler == largest.max_strahler);
    CHECK(basin.outlet->complete);
}

TEST_CASE("A basin that the edge of the data cuts is measured, and said to be cut", "[outlet]") {
    const TempFolder temp;
    const Raster raster = drawn_catchment();
    std::vector<std::string> warnings;
    const Messages messages{.warning = [&](const std::string& text) { warnings.push_back(text); }};
    MeasureOptions options;
    options.channel_area_m2 = 100;
    NamedRaster named{raster, "drawn.tif", "", "", {}, {}};
    const NamedRaster cut = cut_to_outlet(named, {middle(raster, 5, 1), 12.0}, options, messages);  // the western flank
    REQUIRE(warnings.size() == 1);
    CHECK(warnings[0].find("cut off by the edge") != std::string::npos);
    const Json s = Json::parse(analyze(cut, options, temp / "", {}));
    CHECK(s["outlet"]["complete"] == false);
    REQUIRE(s["basins"].size() == 1);
    CHECK(s["basins"][0]["complete"] == false);
    CHECK(s["notes"].dump().find("cut off by the edge") != std::string::npos);
    CHECK(s["outlet"]["area_m2"] == s["basins"][0]["area_m2"]);
    CHECK(s["outlet"]["area_m2"] == s["input"]["area_m2"]);
}

TEST_CASE("Of the holes in a DEM those count that the basin touches", "[outlet]") {
    // Two valleys side by side that fall south, 20 columns each, with holes on their flanks and at the edge.
    Raster raster = raster_of(support::terrain_of("valleys", 30, 40, [](Index r, Index c) {
        return 100 - 2.0 * r + std::abs(static_cast<double>(c % 20) - 10);
    }));
    const auto blank = [&](Index row, Index col, Index height, Index width) {
        for (Index r = row; r < row + height; ++r) {
            for (Index c = col; c < col + width; ++c) raster.values[std::size_t{r} * 40 + c] = support::nodata;
        }
    };
    blank(8, 12, 2, 3);   // inside the west valley
    blank(20, 5, 1, 1);   // the same
    blank(10, 27, 4, 4);  // inside the east valley
    blank(0, 30, 3, 2);   // at the edge of the data: outside
    const auto voids = [&](Index row, Index col) {
        return catchment_above(raster, {middle(raster, row, col), 0}, MeasureOptions{}).void_cells;
    };
    CHECK(voids(28, 10) == 7);
    CHECK(voids(16, 10) == 6);
    CHECK(voids(4, 10) == 0);
    CHECK(voids(28, 30) == 16);
    const TempFolder temp;
    MeasureOptions options;
    NamedRaster dem{};
    dem.raster = raster;
    dem.void_cells = 23;
    const NamedRaster basin = cut_to_outlet(dem, {middle(raster, 28, 10), 0}, options, {});
    CHECK(Json::parse(analyze(basin, options, temp / "", {}))["ingest"]["void_cells"] == 7);
}

TEST_CASE("An outlet beside the data, or on a ridge, is refused in one sentence", "[outlet]") {
    const Raster raster = drawn_catchment();
    CHECK(error_of(raster, {{499999, 3999950}}).find("beside the DEM") != std::string::npos);
    CHECK(error_of(raster, {middle(raster, 3, 0)}).find("no data") != std::string::npos);
    CHECK(error_of(raster, {middle(raster, 1, 2), 0.0}).find("no cell drains") != std::string::npos);
}

TEST_CASE("On the ground the same number of degrees east is shorter in the north", "[outlet]") {
    // One row of lower cells gathers the water; the point lies two columns away from a much larger river.
    const auto moved = [](double north) {
        const auto terrain = support::terrain_of("valley", 9, 9, [](Index r, Index c) {
            return c == 6 ? 1.0 * (8 - r) : 100.0 + 10 * std::abs(c - 6.0) - r;
        });
        Raster raster = raster_of(terrain);
        raster.placement = {10, north, 0.01, 0.01, "", true};
        raster.grid = io::geographic_grid(9, 9, north, 0.01, 0.01);
        return catchment_above(raster, {raster.placement.center(6, 4), 5000.0}, MeasureOptions{}).report.moved_m;
    };
    CHECK(moved(0.05) == Approx(2 * 1113.2).epsilon(1e-3));  // 0.02° on the equator
    CHECK(moved(60.05) == Approx(2 * 558.0).epsilon(1e-3));  // cos 60° and the ellipsoid
}
