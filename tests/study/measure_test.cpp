// SPDX-License-Identifier: GPL-3.0-or-later
// A drawn terrain of 8 x 8 cells, every number of whose summary was counted by hand, and smaller ones beside it.
#include "thalweg/study/measure.hpp"

#include <catch2/catch.hpp>

#include <chrono>
#include <cmath>
#include <future>
#include <memory>
#include <nlohmann/json.hpp>
#include <numbers>
#include <thread>

#include "support/drawing.hpp"
#include "support/drawn_catchment.hpp"
#include "support/steady_landscape.hpp"
#include "support/temp_folder.hpp"
#include "support/terrains.hpp"
#include "thalweg/core/error.hpp"
#include "thalweg/io/table_file.hpp"
#include "thalweg/study/analyze.hpp"
#include "thalweg/terrain/accumulate.hpp"
#include "thalweg/terrain/d_infinity.hpp"
#include "thalweg/terrain/flats.hpp"
#include "thalweg/terrain/lakes.hpp"
#include "thalweg/terrain/route.hpp"

using namespace thalweg;
using namespace thalweg::study;
using support::draw;
using support::drawn_catchment;
using support::raster_of;
using test::TempFolder;
using Json = nlohmann::json;

namespace {

MeasureOptions channels_from(double area_m2) {
    MeasureOptions options;
    options.channel_area_m2 = area_m2;
    return options;
}

Json analyzed(const Raster& raster, const MeasureOptions& options, const std::filesystem::path& folder) {
    std::filesystem::create_directories(folder);
    return Json::parse(analyze({raster, "drawn.tif", "", "", {}, {}}, options, folder, {}));
}

/// The cells of a written raster are those of a drawing times `unit`; '#' is no data.
void check_cells(const std::filesystem::path& file, const std::string& drawing, double unit = 1) {
    const std::vector<double> found = io::read_raster(file).raster.values;
    const std::vector<double> expected = draw(drawing).values;
    REQUIRE(found.size() == expected.size());
    for (std::size_t i = 0; i < found.size(); ++i) {
        INFO(file.filename().string() << " cell " << i);
        if (std::isnan(expected[i]))
            CHECK(std::isnan(found[i]));
        else
            CHECK(found[i] == Approx(expected[i] * unit).epsilon(1e-12));
    }
}

}  // namespace

TEST_CASE("The default threshold of channels is a thousandth of the area, rounded to 1, 2 or 5 in the logarithm") {
    const std::vector<std::pair<double, double>> cases{
        {1e6, 1000},    {2e6, 2000},    {5e6, 5000},       {1e7, 10000},    {1.41e6, 1000}, {1.42e6, 2000},
        {3.16e6, 2000}, {3.17e6, 5000}, {7.07e6, 5000},    {7.08e6, 10000}, {9.9e6, 10000}, {100, 0.1},
        {1e9, 1e6},     {959.5e6, 1e6}, {152.0766e6, 2e5}, {6.3e6, 5000}};
    for (const auto& [area, threshold] : cases) CHECK(default_channel_area(area) == Approx(threshold).epsilon(1e-12));
}

TEST_CASE("The default threshold is taken of the cells with data, each with its own area") {
    Raster raster = raster_of(support::terrain_of(
        "slope", 20, 20, [](Index r, Index c) { return 90.0 - r - 0.1 * c; }, 10, 10));
    CHECK(data_area(raster) == 40000);
    CHECK(measure_raster(raster, {}).statistics.channels.threshold_area_m2 == Approx(50));
    for (Index node = 160; node < 400; ++node) raster.values[node] = support::nodata;
    CHECK(data_area(raster) == 16000);
    CHECK(measure_raster(raster, {}).statistics.channels.threshold_area_m2 == Approx(20));
    const Raster uneven = raster_of({"uneven", support::uneven_grid(3, 2), {1, 2, 3, 4, support::nodata, 6}});
    CHECK(data_area(uneven) == Approx(2 * 600 + 2 * 595 + 590.0));
}

TEST_CASE("A drawn terrain has the numbers that one counts on it") {
    const TempFolder temp;
    const Json s = analyzed(drawn_catchment(), channels_from(200), temp / "out");
    CHECK(s["input"]["rows"] == 8);
    CHECK(s["input"]["cols"] == 8);
    CHECK(s["input"]["valid_cells"] == 57);
    CHECK(s["input"]["nodata_cells"] == 7);
    CHECK(s["input"]["area_m2"] == 5700.0);
    CHECK(s["input"]["elevation_min_m"] == -100.0);
    CHECK(s["input"]["elevation_max_m"] == 25.0);
    CHECK(s["conditioning"]["pits"] == 0);
    CHECK(s["conditioning"]["cells_changed"] == 0);

    const Json& c = s["channels"];
    CHECK(c["threshold_area_m2"] == 200.0);
    CHECK(c["cells"] == 24);  // 21 in the valley, 3 on the north rim; 6 on either flank are cut
    CHECK(c["share_used"].get<double>() == Approx(24.0 / 36));
    CHECK(c["sources"] == 16);
    CHECK(c["links"] == 22);
    CHECK(c["junctions"] == 6);
    CHECK(c["outlets"] == 2);
    CHECK(c["total_length_m"].get<double>() == Approx(220));
    CHECK(c["basin_area_m2"].get<double>() == Approx(4000));
    CHECK(c["drainage_density_per_m"].get<double>() == Approx(0.055));
    CHECK(c["constant_of_channel_maintenance_m"].get<double>() == Approx(4000.0 / 220));
    CHECK(c["max_strahler"] == 2);
    CHECK(c["max_shreve"] == 14);

    REQUIRE(s["basins"].size() == 2);
    const Json &valley = s["basins"][0], &rim = s["basins"][1];
    CHECK(valley["area_m2"] == 3500.0);
    CHECK(valley["relief_m"] == 25.5);
    CHECK(valley["hypsometric_integral"].get<double>() == Approx(4.0 / 7));  // the mean is 492.5 / 35
    CHECK(valley["max_strahler"] == 2);
    CHECK(valley["complete"] == true);
    CHECK(valley["outlet_x"] == 500045.0);
    CHECK(valley["outlet_y"] == 3999925.0);
    CHECK(valley["length_m"].get<double>() == Approx(std::hypot(60, 20)));
    // Lines through the centres cross the border of 5 by 7 cells 14, 10 and twice 22 times.
    const double crossed_m = std::numbers::pi / 8 * 10 * (14 + 10 + 44 / std::sqrt(2.0));
    CHECK(valley["perimeter_m"].get<double>() == Approx(crossed_m));
    CHECK(valley["circularity"].get<double>() == Approx(4 * std::numbers::pi * 3500 / crossed_m / crossed_m));
    CHECK(valley["form_factor"].get<double>() == Approx(3500.0 / 4000));
    CHECK(valley["elongation"].get<double>() == Approx(2 * std::sqrt(3500 / std::numbers::pi) / std::hypot(60, 20)));
    CHECK(valley["relief_ratio"].get<double>() == Approx(25.5 / std::hypot(60, 20)));
    CHECK(valley["ruggedness"].get<double>() == Approx(25.5 / std::sqrt(3500)));
    // 200 m2 from each side meet the middle in each of six rows above the outlet's. Of the uppermost pair, which are
    // alike, the trunk goes on into the eastern one, left of a river that runs south; so six come from the right.
    CHECK(valley["asymmetry_percent"].get<double>() == Approx(100 * 6.0 / 11));
    CHECK(valley["elevation_min_m"] == -0.5);
    CHECK(valley["elevation_max_m"] == 25.0);
    CHECK(valley["elevation_mean_m"].get<double>() == Approx(492.5 / 35));
    CHECK(valley["channel_length_m"].get<double>() == Approx(200));
    CHECK(valley["drainage_density_per_m"].get<double>() == Approx(200.0 / 3500));
    CHECK(valley["sources"] == 14);
    CHECK(valley["max_shreve"] == 14);
    CHECK(rim["channel_length_m"].get<double>() == Approx(20));
    CHECK(rim["sources"] == 2);
    CHECK(rim["area_m2"] == 500.0);
    CHECK(rim["relief_m"] == 20.0);
    CHECK(rim["hypsometric_integral"].get<double>() == Approx(0.6));
    CHECK(rim["outlet_y"] == 3999995.0);
}

TEST_CASE("Kept edge basins count whole, and are said to be cut") {
    const TempFolder temp;
    MeasureOptions options = channels_from(200);
    options.edge_basins = terrain::EdgeBasins::keep;
    const Json s = analyzed(drawn_catchment(), options, temp / "out");
    CHECK(s["channels"]["share_used"] == 1.0);
    CHECK(s["channels"]["cells"] == 36);
    REQUIRE(s["basins"].size() == 4);
    CHECK(s["basins"][0]["complete"] == true);
    CHECK(s["basins"][1]["area_m2"] == 800.0);
    CHECK(s["basins"][1]["complete"] == false);
    CHECK(s["basins"][2]["area_m2"] == 700.0);
    CHECK(s["channels"]["basin_area_m2"].get<double>() == Approx(5500));
}

TEST_CASE("Every written raster of a drawn terrain is right in every cell, mouths too") {
    const TempFolder temp;
    analyzed(drawn_catchment(), channels_from(200), temp / "out");
    check_cells(temp / "out/filled.tif", support::drawn_catchment_text);
    check_cells(temp / "out/flow_direction.tif", R"(
        #  0  1  1  0 16 16  0
        #  4  1  1  4 16 16  4
        #  4  1  1  4 16 16  4
        #  4  1  1  4 16 16  4
        #  4  1  1  4 16 16  4
        #  4  1  1  4 16 16  4
        #  8  1  1  4 16 16  4
        0 16  1  1  0 16 16  0)");
    check_cells(temp / "out/drainage_area.tif", R"(
        #  1  1  2  5  2  1  1
        #  1  1  2  5  2  1  1
        #  2  1  2 10  2  1  2
        #  3  1  2 15  2  1  3
        #  4  1  2 20  2  1  4
        #  5  1  2 25  2  1  5
        #  6  1  2 30  2  1  6
        8  1  1  2 35  2  1  7)",
                100);
    check_cells(temp / "out/strahler.tif", R"(
        0 0 0 1 2 1 0 0
        0 0 0 1 2 1 0 0
        0 0 0 1 2 1 0 0
        0 0 0 1 2 1 0 0
        0 0 0 1 2 1 0 0
        0 0 0 1 2 1 0 0
        0 0 0 1 2 1 0 0
        0 0 0 1 2 1 0 0)");
    check_cells(temp / "out/shreve.tif", R"(
        0 0 0 1  2 1 0 0
        0 0 0 1  2 1 0 0
        0 0 0 1  4 1 0 0
        0 0 0 1  6 1 0 0
        0 0 0 1  8 1 0 0
        0 0 0 1 10 1 0 0
        0 0 0 1 12 1 0 0
        0 0 0 1 14 1 0 0)");
}

TEST_CASE("Directions are written in ESRI's codes for all eight neighbours") {
    const TempFolder temp;
    Raster star = raster_of(support::terrain_of(
        "star", 3, 3, [](Index r, Index c) { return r == 1 && c == 1 ? 0 : 5; }, 10, 10));
    MeasureOptions options = channels_from(100);
    options.catchment_outlet = 4;
    analyzed(star, options, temp / "in");
    check_cells(temp / "in/flow_direction.tif", "2 4 8 \n 1 0 16 \n 128 64 32");
    CHECK(measure_raster(star, options).statistics.channels.outlets == 1);
    CHECK(measure_raster(star, options).statistics.strahler_of[4] == 2);
}

TEST_CASE("A pit is filled to its pass, cut through, or kept, as asked") {
    const TempFolder temp;
    const char* drawing = R"(
        10 10 10 10 10
        10  9  9  9 10
        10  9  7  9 10
        10  9  9  9 10
        10 10 10 10 8.5)";
    const Raster pit = raster_of({"pit", plane_grid(5, 5, 10, 20), draw(drawing).values});
    const auto conditioned = [&](Conditioning conditioning, const char* name) {
        MeasureOptions options = channels_from(200);
        options.conditioning = conditioning;
        return analyzed(pit, options, temp / name)["conditioning"];
    };
    // The pass is the corner of 8.5 itself, reached from the 9 beside it: the pit of 7 fills to 9.
    const Json filled = conditioned(Conditioning::fill, "fill");
    CHECK(filled["method"] == "fill");
    CHECK(filled["pits"] == 1);
    CHECK(filled["cells_changed"] == 1);
    CHECK(filled["volume_m3"] == 400.0);
    check_cells(temp / "fill/filled.tif", R"(
        10 10 10 10 10
        10  9  9  9 10
        10  9  9  9 10
        10  9  9  9 10
        10 10 10 10 8.5)");
    // The cut falls from the pit through the 9 to the corner, to the height of the pit.
    const Json cut = conditioned(Conditioning::carve, "carve");
    CHECK(cut["method"] == "carve");
    CHECK(cut["cells_changed"] == 2);
    CHECK(cut["volume_m3"].get<double>() == Approx(200 * (2 + 1.5)));
    check_cells(temp / "carve/filled.tif", R"(
        10 10 10 10 10
        10  9  9  9 10
        10  9  7  9 10
        10  9  9  7 10
        10 10 10 10 7)");
    const Json kept = conditioned(Conditioning::none, "none");
    CHECK(kept["method"] == "none");
    CHECK(kept["cells_changed"] == 0);
    CHECK(kept["volume_m3"] == 0.0);
    check_cells(temp / "none/filled.tif", drawing);
    const auto area_of_pit = [&](const char* name) {
        return io::read_raster(temp / (std::string(name) + "/drainage_area.tif")).raster.values[24];
    };
    CHECK(area_of_pit("fill") == Approx(area_of_pit("carve")));
    CHECK(area_of_pit("none") == 400);  // itself and the cell west of it
}

TEST_CASE("What is filled or cut weighs by the area of its own row") {
    const Grid grid = support::uneven_grid(6, 5);
    const auto pit = draw(R"(
        10 10 10  10 10
        10 10 10  10 10
        10  7 10  10 10
        10 10  4  10 10
        10 10  9  10 10
        10 10 8.5 10 10)");
    MeasureOptions options = channels_from(1);
    const ConditioningReport filled = measure_raster(raster_of({"pits", grid, pit.values}), options).conditioning;
    CHECK(filled.pits == 1);
    CHECK(filled.cells_changed == 2);
    CHECK(filled.volume_m3 == Approx(2 * grid.cell_area[2] + 5 * grid.cell_area[3]).epsilon(1e-12));
    options.conditioning = Conditioning::carve;
    const ConditioningReport cut = measure_raster(raster_of({"pits", grid, pit.values}), options).conditioning;
    CHECK(cut.cells_changed == 2);
    CHECK(cut.volume_m3 == Approx(5 * grid.cell_area[4] + 4.5 * grid.cell_area[5]).epsilon(1e-12));
}

TEST_CASE("A basin's hypsometric integral and the areas weigh every cell by its own row") {
    const Grid grid = support::uneven_grid(4, 3);
    const Raster raster = raster_of({"valley", grid, draw("12 10 12 \n 7 6 7 \n 4 3 4 \n 1 0 1").values});
    MeasureOptions options = channels_from(1000);
    options.catchment_outlet = 10;
    const RasterMeasurement m = measure_raster(raster, options);
    const auto& a = grid.cell_area;
    const double area = 3 * (a[0] + a[1] + a[2] + a[3]);
    REQUIRE(m.statistics.basins.size() == 1);
    CHECK(m.area_m2 == Approx(area).epsilon(1e-12));
    CHECK(m.statistics.basins[0].basin.area_m2 == Approx(area).epsilon(1e-12));
    CHECK(m.statistics.basins[0].relief_m == 12);
    const double integral = (34 * a[0] + 20 * a[1] + 11 * a[2] + 2 * a[3]) / area / 12;
    CHECK(m.statistics.basins[0].hypsometry.integral == Approx(integral).epsilon(1e-12));
    CHECK(m.statistics.hypsometry.integral == Approx(integral).epsilon(1e-12));
    CHECK(m.statistics.channels.share_used == 1);
}

TEST_CASE("Slopes are taken over a fortieth of the largest basin's relief, or three steps of the heights") {
    Raster raster = drawn_catchment();
    const RasterMeasurement stepped = measure_raster(raster, channels_from(200));
    CHECK(stepped.vertical_quantum_m == 0.5);
    CHECK(stepped.segment_drop_m == 1.5);  // 2.5 % of 25.5 m would be less
    for (Index node = 0; node < raster.grid.size(); ++node) raster.values[node] += 1e-3 * std::sqrt(node);
    const RasterMeasurement smooth = measure_raster(raster, channels_from(200));
    CHECK(smooth.vertical_quantum_m == 0);
    CHECK(smooth.segment_drop_m == Approx(0.025 * 25.5).margin(2e-4));  // the whole terrain falls 125 m
}

TEST_CASE("The slopes of the summary are those of the carved profiles above the threshold") {
    // 20 rows that fall by 2 m in 10 m to the outlet: one channel, one slope.
    const Raster ramp = raster_of(support::terrain_of(
        "ramp", 20, 3, [](Index r, Index c) { return 2.0 * (19 - r) + (c == 1 ? 0 : 30); }, 10, 10));
    MeasureOptions options = channels_from(600);
    options.catchment_outlet = 19 * 3 + 1;
    const auto points = measure_raster(ramp, options).statistics.slope_area_points;
    REQUIRE_FALSE(points.empty());
    for (const auto& point : points) {
        CHECK(point.slope == Approx(0.2).epsilon(1e-12));
        CHECK(point.area_m2 >= 600);
        CHECK(point.area_m2 <= 6000);
    }
}

TEST_CASE("Another routing writes its own area and begins channels by it, and leaves directions and course alone") {
    const TempFolder temp;
    const Raster dem = raster_of(support::with_holes(support::noise_terrain(40, 50, 3), 0.01, 3));
    const auto boundary = terrain::data_edge(dem.grid, dem.values);
    const std::vector<double> filled = terrain::fill(dem.grid, dem.values, boundary);
    FlowDirections single = terrain::route(dem.grid, filled, boundary);
    terrain::resolve_flats(dem.grid, filled, boundary, single);
    const auto areas = terrain::cell_areas(dem.grid);
    MeasureOptions options = channels_from(30);
    options.edge_basins = terrain::EdgeBasins::keep;
    const Json d8 = analyzed(dem, options, temp / "d8");
    CHECK(d8["routing"] == "d8");
    for (const auto& [routing, name, flow] :
         {std::tuple{Routing::mfd, "mfd", terrain::multiple_flow(dem.grid, filled, single)},
          std::tuple{Routing::dinf, "dinf", terrain::d_infinity(dem.grid, filled, single)}}) {
        options.routing = routing;
        const Json s = analyzed(dem, options, temp / name);
        CHECK(s["routing"] == name);
        CHECK(test::bytes_of(temp / name / "flow_direction.tif") == test::bytes_of(temp / "d8/flow_direction.tif"));
        const std::vector<double> expected = terrain::accumulate(flow, areas);
        const std::vector<double> found = io::read_raster(temp / name / "drainage_area.tif").raster.values;
        const std::vector<double> orders = io::read_raster(temp / name / "strahler.tif").raster.values;
        std::vector<int> channel(expected.size(), 0);
        for (Index start = 0; start < dem.grid.size(); ++start) {
            if (std::isnan(dem.values[start])) continue;
            CHECK(found[start] == expected[start]);
            if (expected[start] < 30) continue;
            for (Index node = start;; node = dem.grid.neighbor(node, single[node])) {
                channel[node] = 1;
                if (single[node] == no_flow) break;
            }
        }
        for (Index node = 0; node < dem.grid.size(); ++node) {
            if (!std::isnan(dem.values[node])) CHECK((orders[node] > 0) == (channel[node] == 1));
        }
        CHECK(s["channels"]["cells"] != d8["channels"]["cells"]);
        CHECK(s["basins"][0]["area_m2"] == d8["basins"][0]["area_m2"]);
    }
}

TEST_CASE("Slope–area by cells looks at basins' cells that conditioning left alone, and its line at channels alone") {
    const Grid grid = plane_grid(120, 120, 90, 90);
    const support::SteadyLaw law{.theta = 0.45};
    auto height = support::steady_raster(grid, law, 5);
    for (double& each : height) each += 500;
    MeasureOptions options = channels_from(20.5 * 8100);
    options.edge_basins = terrain::EdgeBasins::keep;
    const TempFolder temp;
    const Json plain = analyzed(raster_of({"steady", grid, height}), options, temp / "a");
    CHECK(plain["slope_area_cells"]["theta"].get<double>() == Approx(0.45).margin(1e-5));
    CHECK(plain["slope_area_cells"]["ks"].get<double>() == Approx(law.slope(1)).epsilon(1e-4));
    CHECK(plain["slope_area_cells"]["fitted_from_m2"] == 20.5 * 8100);
    CHECK(plain["slope_area_links"]["theta"].get<double>() == Approx(0.45).margin(0.02));
    CHECK(plain["slope_area_cells"]["level_share"] == 0);
    CHECK(plain["slope_area_cells"]["turnover_area_m2"].is_null());  // steepest at the smallest area
    CHECK(plain["notes"].dump().find("slope_area_cells") != std::string::npos);

    // What stands under water has no slope of the ground.
    auto pitted = height;
    for (Index node = 0; node < grid.size(); ++node) {
        if (uniform_at(1, 0, node) < 0.02) pitted[node] -= 40;
    }
    const Json filled = analyzed(raster_of({"pitted", grid, pitted}), options, temp / "b");
    CHECK(filled["conditioning"]["cells_changed"].get<int>() > 10);
    const auto cells = [](const Json& summary) {
        int sum = 0;
        for (const Json& bin : summary["slope_area_cells"]["bins"]) sum += bin["count"].get<int>();
        return sum;
    };
    CHECK(cells(filled) < cells(plain));
    CHECK(plain["slope_area_cells"]["cells"] == cells(plain));
    CHECK(plain["slope_area_cells"]["cells_left_out"] == 0);
    const Json& by_cells = filled["slope_area_cells"];
    CHECK(by_cells["level_share"] == 0);
    CHECK(by_cells["cells"] == cells(filled));
    // Filled cells of the basins, and those that flow into one, as the written rasters have them.
    const auto surface = io::read_raster(temp / "b" / "filled.tif").raster.values;
    const auto direction = io::read_raster(temp / "b" / "flow_direction.tif").raster.values;
    const RasterMeasurement measured = measure_raster(raster_of({"pitted", grid, pitted}), options);
    int changed = 0, in_basins = 0;
    for (Index node = 0; node < grid.size(); ++node) {
        if (measured.statistics.basin_of[node] == none || direction[node] == 0) continue;
        Index to = none;
        grid.neighbors(node, [&](Index other, double, Slot slot) {
            if (direction[node] == 1 << slot) to = other;
        });
        ++in_basins;
        changed += surface[node] != pitted[node] || surface[to] != pitted[to];
    }
    CHECK(changed > 10);
    CHECK(by_cells["cells_left_out"] == changed);
    CHECK(by_cells["cells"].get<int>() + changed == in_basins);
    // The line is that of the bins of channels; hillslopes of another law do not bend it.
    std::vector<channel::SlopeAreaBin> of_channels;
    for (const Json& bin : by_cells["bins"]) {
        const double error = bin["slope_se"].is_null() ? std::nan("") : bin["slope_se"].get<double>();
        if (bin["area_m2"] < 20.5 * 8100) continue;
        of_channels.push_back({bin["area_m2"], bin["slope"], error, bin["count"]});
    }
    CHECK(of_channels.size() < by_cells["bins"].size());
    CHECK(by_cells["theta"].get<double>() == Approx(channel::fit_slope_area(of_channels).theta.value).epsilon(1e-9));
    CHECK(by_cells["theta"].get<double>() != plain["slope_area_cells"]["theta"].get<double>());
    // On steps of 30 m some links do not fall.
    auto stepped = height;
    for (double& each : stepped) each = 30 * std::round(each / 30);
    const Statistics coarse = measure_raster(raster_of({"stepped", grid, stepped}), options).statistics;
    const auto level = std::ranges::count_if(coarse.network.drop_m, [](double drop) { return !(drop > 0); });
    CHECK(level > 0);
    CHECK(coarse.slope_area_links.level_share ==
          Approx(static_cast<double>(level) / static_cast<double>(coarse.network.size())));
    const Table written = io::read_csv(temp / "a" / "slope_area_cells.csv");
    CHECK(std::get<std::vector<double>>(written.columns[1].values).size() == plain["slope_area_cells"]["bins"].size());
    CHECK(std::filesystem::exists(temp / "a" / "slope_area_links.csv"));
}

TEST_CASE("What reads the routed terrain meanwhile is waited for before the terrain goes, even if a statistic fails") {
    const Raster raster = raster_of(support::noise_terrain(6, 6, 1));
    MeasureOptions options;
    options.channels = ChannelRule::drop;  // of which so small a terrain has none: refused once water is routed
    bool called = false, outlived = false;
    const auto read_meanwhile = [&](const RoutedTerrain& terrain) {
        called = true;
        // It lives as long as the terrain: a function that the terrain holds is all that knows of it.
        auto life = std::make_shared<int>();
        const std::weak_ptr<int> terrain_life = life;
        const_cast<RoutedTerrain&>(terrain).offset_m = [life = std::move(life)](Index, Index) { return Point{}; };
        return std::async(std::launch::async, [&outlived, terrain_life] {
            for (int look = 0; look < 100 && !outlived; ++look) {
                std::this_thread::sleep_for(std::chrono::milliseconds(2));
                outlived = terrain_life.expired();
            }
        });
    };
    CHECK_THROWS_AS(measure_raster(raster, options, read_meanwhile), Error);
    CHECK(called);
    CHECK_FALSE(outlived);
}

TEST_CASE("What fails meanwhile fails the measuring, once it is done") {
    const auto fail = [](const RoutedTerrain&) {
        return std::async(std::launch::async, [] { throw Error("the disk is full"); });
    };
    CHECK(test::error_of([&] { measure_raster(drawn_catchment(), channels_from(200), fail); }) == "the disk is full");
}

TEST_CASE("Slope–area by cells takes the drainage area of the routing that was asked for") {
    const Grid grid = plane_grid(60, 70, 90, 90);
    const Raster raster = raster_of({"steady", grid, support::steady_raster(grid, {.theta = 0.45, .scatter = 0.3}, 6)});
    for (const Routing routing : {Routing::d8, Routing::dinf, Routing::mfd}) {
        MeasureOptions options = channels_from(20.5 * 8100);
        options.edge_basins = terrain::EdgeBasins::keep;
        options.routing = routing;
        const RasterMeasurement m = measure_raster(raster, options);
        const auto& area = routing == Routing::d8 ? m.terrain.drainage_area_m2 : m.terrain.divided_area_m2;
        std::vector<channel::SlopeAreaPoint> points;
        for (Index node = 0; node < grid.size(); ++node) {
            const Index to = m.terrain.graph.receiver[node];
            if (m.statistics.basin_of[node] == none || to == none) continue;
            if (m.terrain.elevation_m[node] != raster.values[node] || m.terrain.elevation_m[to] != raster.values[to]) {
                continue;
            }
            const double slope = (raster.values[node] - raster.values[to]) / m.terrain.graph.length[node];
            points.push_back({area[node], slope});
        }
        const auto expected = channel::slope_area_bins(points);
        const auto& found = m.statistics.slope_area_nodes.law.bins;
        REQUIRE(found.size() == expected.size());
        for (std::size_t bin = 0; bin < found.size(); ++bin) {
            CHECK(found[bin].count == expected[bin].count);
            CHECK(found[bin].area_m2 == Approx(expected[bin].area_m2));
        }
    }
}
