// SPDX-License-Identifier: GPL-3.0-or-later
#include "thalweg/study/channel_heads.hpp"

#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>

#include "support/drawn_catchment.hpp"
#include "support/temp_folder.hpp"
#include "support/terrains.hpp"
#include "thalweg/core/error.hpp"
#include "thalweg/io/geodesy.hpp"
#include "thalweg/io/table_file.hpp"
#include "thalweg/study/outlet.hpp"

using namespace thalweg;
using namespace thalweg::study;
using Json = nlohmann::json;
using support::drawn_catchment;
using support::raster_of;
using test::TempFolder;

namespace {

Json analyzed(const Raster& raster, const MeasureOptions& options, const std::filesystem::path& folder) {
    std::filesystem::create_directories(folder);
    return Json::parse(analyze({raster, "drawn.tif", "", "", {}, {}}, options, folder, {}));
}

MeasureOptions from_heads(std::vector<Index> cells) {
    MeasureOptions options;
    options.channels = ChannelRule::heads;
    options.heads = ChannelHeads{.cells = std::move(cells)};
    return options;
}

}  // namespace

TEST_CASE("Heads at the sources of a network by area give all its statistics again", "[heads]") {
    for (const bool holes : {false, true}) {
        auto terrain = support::noise_terrain(40, 50, 11);
        for (Index node = 0; node < terrain.grid.size(); ++node) {
            terrain.elevation_m[node] += 0.2 * terrain.grid.row(node);  // so that rivers become long
        }
        const Raster raster = raster_of(holes ? support::with_holes(terrain, 0.003, 4) : terrain);
        MeasureOptions by_area;
        by_area.channel_area_m2 = 8;
        const RasterMeasurement m = measure_raster(raster, by_area);
        REQUIRE(m.statistics.network.size() > 20);
        const auto channels = channel_nodes(m.terrain, by_area, 8);
        const RasterMeasurement again =
            measure_raster(raster, from_heads(channel::channel_heads(m.terrain.graph, channels)));

        CHECK(again.statistics.network.nodes == m.statistics.network.nodes);
        CHECK(again.statistics.network.strahler == m.statistics.network.strahler);
        CHECK(again.statistics.strahler_of == m.statistics.strahler_of);
        CHECK(again.statistics.shreve_of == m.statistics.shreve_of);
        CHECK(again.statistics.basin_of == m.statistics.basin_of);
        CHECK(again.statistics.channels.share_used == m.statistics.channels.share_used);
        CHECK(again.statistics.channels.source_area_m2 == m.statistics.channels.source_area_m2);
        CHECK(m.statistics.channels.source_area_m2[0] >= 8);
        CHECK(again.segment_drop_m == m.segment_drop_m);
        CHECK(again.statistics.horton.bifurcation.regression == m.statistics.horton.bifurcation.regression);
    }
}

TEST_CASE("A single head makes one river down to the edge, of complete catchments alone", "[heads]") {
    const TempFolder temp;
    // Column 4 is the valley's middle; (1, 4) lies near its top.
    const Json s = analyzed(drawn_catchment(), from_heads({1 * 8 + 4}), temp / "out");
    const Json& c = s["channels"];
    CHECK(c["rule"] == "heads");
    CHECK(c["threshold_area_m2"].is_null());
    CHECK(c["source_area_m2"] == Json({500.0, 500.0, 500.0}));  // the row of the valley that meets there
    CHECK(c["sources"] == 1);
    CHECK(c["links"] == 1);
    CHECK(c["junctions"] == 0);
    CHECK(c["total_length_m"].get<double>() == Approx(60));
    CHECK(c["max_strahler"] == 1);
    REQUIRE(s["basins"].size() == 1);
    CHECK(s["basins"][0]["area_m2"] == 3500.0);
    CHECK(s["notes"].dump().find("do not begin at a drainage area") != std::string::npos);
}

TEST_CASE("Heads in cut terrain alone leave nothing to count, and a note says so", "[heads]") {
    const TempFolder temp;
    const Json s = analyzed(drawn_catchment(), from_heads({2 * 8 + 1}), temp / "out");  // on the western flank
    CHECK(s["channels"]["links"] == 0);
    CHECK(s["channels"]["share_used"] == 0.0);
    CHECK(s["basins"].empty());
    CHECK(s["notes"].dump().find("no complete catchment holds a channel") != std::string::npos);
}

TEST_CASE("Points become the cells that hold them; those off the data are counted", "[heads]") {
    const Raster raster = drawn_catchment();  // its north-west corner at (500 000, 4 000 000), its column 0 void
    const std::vector<Point> points{{500015, 3999985}, {500011, 3999981}, {500079, 3999921},
                                    {500005, 3999985}, {499999, 3999985}, {500015, 4000001}};
    const ChannelHeads heads = channel_heads_on(raster, points);
    CHECK(heads.cells == std::vector<Index>{9, 63});
    CHECK(heads.given == 6);
    CHECK(heads.outside == 3);
    CHECK(heads.merged == 1);
}

TEST_CASE("Heads in another coordinate system are transformed to the terrain's", "[heads]") {
    const TempFolder temp;
    const io::LocalPlane plane{-84.2, 36.4};
    Raster raster = raster_of(support::terrain_of(
        "slope", 20, 30, [](Index r, Index c) { return 90.0 - r - 0.1 * c; }, 10, 10));
    raster.placement = {.west = -150, .north = 100, .cell_width = 10, .cell_height = 10, .crs_wkt = plane.crs_wkt()};
    const std::vector<Index> cells{31, 340, 599};
    std::vector<Point> metres;
    for (const Index cell : cells) {
        metres.push_back(raster.placement.center(raster.grid.row(cell), raster.grid.col(cell)));
    }
    const io::LocalPlane elsewhere{-85, 37};
    Table table{"heads", {{"id", std::vector<double>{1, 2, 3}}}, GeometryKind::point, {}};
    for (const Point& p : io::reproject(plane.crs_wkt(), elsewhere.crs_wkt(), metres)) table.geometry.push_back({p});
    io::write_geopackage(temp / "heads.gpkg", {table}, elsewhere.crs_wkt());
    CHECK(read_channel_heads(temp / "heads.gpkg", raster, {}).cells == cells);
}

TEST_CASE("Heads are read from the layer of sources where there is one, other points from all layers", "[heads]") {
    const TempFolder temp;
    const Raster raster = drawn_catchment();
    Table lakes{"lakes", {{"id", std::vector<double>{1}}}, GeometryKind::point, {{raster.placement.center(2, 4)}}};
    Table sources{"sources", {{"id", std::vector<double>{1}}}, GeometryKind::point, {{raster.placement.center(1, 4)}}};
    io::write_geopackage(temp / "both.gpkg", {lakes, sources}, "");
    CHECK(read_channel_heads(temp / "both.gpkg", raster, {}).cells == std::vector<Index>{1 * 8 + 4});
    CHECK(read_cells(temp / "both.gpkg", {}, raster, {}).cells == std::vector<Index>{1 * 8 + 4, 2 * 8 + 4});
    CHECK(read_cells(temp / "both.gpkg", {"lakes"}, raster, {}).cells == std::vector<Index>{2 * 8 + 4});
}

TEST_CASE("Heads beside the valley are moved into it, not down it, and merged where they meet", "[heads]") {
    // The valley's middle is column 4, where 5 cells more drain from row to row. Within 15 m of (2, 3) and (2, 5) lie
    // (1, 4), (2, 4) and (3, 4); half of the last one's 15 cells is less than the 10 of (2, 4), which is nearest.
    const Raster raster = drawn_catchment();
    const ChannelHeads given{.cells = {2 * 8 + 3, 2 * 8 + 5, 4 * 8 + 4}, .given = 3};
    const ChannelHeads snapped = snapped_heads(raster, given, 15, {});
    CHECK(snapped.cells == std::vector<Index>{2 * 8 + 4, 4 * 8 + 4});
    CHECK(snapped.merged == 1);
    CHECK(snapped.moved == 2);
    CHECK(snapped.mean_moved_m == Approx(20.0 / 3));
    CHECK(snapped.largest_moved_m == Approx(10));
    CHECK(snapped_heads(raster, given, 5, {}).cells == given.cells);
    CHECK_THROWS_AS(snapped_heads(raster, given, 0, {}), Error);

    const TempFolder temp;
    MeasureOptions options;
    options.channels = ChannelRule::heads;
    options.heads = snapped;
    const Json heads = analyzed(raster, options, temp / "out")["channels"]["heads"];
    CHECK(heads["snap_m"] == 15);
    CHECK(heads["moved"] == 2);
    CHECK(heads["merged"] == 1);
    CHECK(heads["largest_moved_m"].get<double>() == Approx(10));
}
