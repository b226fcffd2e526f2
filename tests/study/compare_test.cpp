// SPDX-License-Identifier: GPL-3.0-or-later
// Comparisons of curves drawn by hand, whose distances were computed on paper.
#include "thalweg/study/compare.hpp"

#include <fmt/format.h>

#include <catch2/catch.hpp>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "support/temp_folder.hpp"
#include "support/terrains.hpp"
#include "thalweg/core/statistics.hpp"
#include "thalweg/study/grow.hpp"

using namespace thalweg;
using namespace thalweg::study;
using test::error_of;
using test::TempFolder;
using Json = nlohmann::json;

namespace {

Json ratio(double regression) { return {{"regression", regression}, {"mean_ratio", 17.0}}; }

Json bin(double log_area, double log_slope) {
    return {{"area_m2", std::pow(10, log_area)}, {"slope", std::pow(10, log_slope)}, {"slope_se", 0.01}, {"count", 9}};
}

/// The summary of an analyze run: slope falls from 10^-1 at 10^4 m² to 10^-2 at 10^6 m², the hypsometric curve is the
/// diagonal.
Json drawn_summary() {
    return {{"input", {{"elevation_min_m", 100.0}, {"elevation_max_m", 300.0}}},
            {"channels", {{"threshold_area_m2", 5000.0}}},
            {"strahler", Json::array()},
            {"hypsometry", {{"integral", 0.5}, {"relative_height", {0, 0.5, 1}}, {"relative_area", {1, 0.5, 0}}}},
            {"horton", {{"RB", ratio(4)}, {"RL", ratio(2)}, {"RA", ratio(5)}, {"RS", ratio(1.5)}}},
            {"slope_area", {{"theta", 0.5}, {"bins", {bin(4, -1), bin(6, -2)}}}},
            {"notes", Json::array()}};
}

std::filesystem::path folder_of(const TempFolder& temp, const std::string& name, const Json& summary) {
    std::filesystem::create_directories(temp / name);
    temp.text(name + "/summary.json", summary.dump());
    return temp / name;
}

Json compared(const TempFolder& temp, const std::filesystem::path& a, const std::filesystem::path& b,
              std::optional<double> channel_area_m2 = {}) {
    CompareOptions options;
    options.measure.channel_area_m2 = channel_area_m2;
    std::filesystem::create_directories(temp / "out");
    return Json::parse(compare(a, b, options, temp / "out", {}));
}

double distance(const Json& comparison, const std::string& name) {
    for (const Json& aspect : comparison.at("aspects")) {
        if (aspect.at("name") == name && aspect.at("distance").is_number()) return aspect.at("distance");
    }
    return std::nan("");
}

/// A square DEM of cells of 10 m that falls to the south.
std::filesystem::path slope_of(const TempFolder& temp, const std::string& name, Index size) {
    const auto t = support::terrain_of(name, size, size, [](Index r, Index c) { return 1000.0 - 3.0 * r + 0.1 * c; });
    io::write_raster(temp / name, plane_grid(size, size, 10, 10),
                     {.west = 5e5, .north = 4e6, .cell_width = 10, .cell_height = 10, .crs_wkt = ""}, t.elevation_m,
                     {});
    return temp / name;
}

/// A DEM of square cells over rough ground that falls to the south-east: each cell holds the mean of a terrain drawn on
/// a third of 10 m, so that a file of 30 m has the means of one of 10 m.
std::filesystem::path rough_terrain(const TempFolder& temp, const std::string& name, Index size, double cell_m) {
    const auto height = [](double x, double y) {
        return 400 - 0.05 * (x + y) + 20 * std::sin(x / 90) * std::cos(y / 70) + 6 * std::sin(x / 23 + y / 31);
    };
    const auto places = static_cast<int>(std::lround(cell_m / 10 * 3));
    const auto t = support::terrain_of(name, size, size, [&](Index row, Index col) {
        double sum = 0;
        for (int i = 0; i < places; ++i) {
            for (int j = 0; j < places; ++j) {
                sum += height((col + (i + 0.5) / places) * cell_m, (row + (j + 0.5) / places) * cell_m);
            }
        }
        return sum / (places * places);
    });
    io::write_raster(temp / name, plane_grid(size, size, cell_m, cell_m),
                     {.west = 5e5, .north = 4e6, .cell_width = cell_m, .cell_height = cell_m, .crs_wkt = ""},
                     t.elevation_m, {});
    return temp / name;
}

/// A network and its terrain, as `thalweg grow` writes them.
std::filesystem::path grown_folder(const TempFolder& temp, const std::string& name, std::uint64_t seed) {
    Experiment e;
    e.seed = seed;
    e.basin.outline = std::vector<Point>{{0, 0}, {4000, 500}, {3000, 5000}, {-1000, 4000}};
    e.basin.trunk = std::vector<Point>{{0, 0}, {1500, 3500}};
    e.growth.channel_maintenance_m = 400;
    e.output.resolution = 200;
    std::filesystem::create_directories(temp / name);
    study::grow(e, temp / name, {});
    return temp / name;
}

}  // namespace

TEST_CASE("The slope-area distance is the root mean square over the areas both curves have, in dex") {
    const TempFolder temp;
    Json other = drawn_summary();
    // At 10^5 m² the first curve lies at -1.5, this one at -1.1; at 10^6 m² at -2 and -1.9. Elsewhere only one has
    // values.
    other["slope_area"] = {{"theta", 0.8}, {"bins", {bin(5, -1.1), bin(7, -2.7)}}};
    const auto a = folder_of(temp, "a", drawn_summary()), b = folder_of(temp, "b", other);
    const Json ab = compared(temp, a, b);
    CHECK(distance(ab, "slope_area") == Approx(std::sqrt((0.4 * 0.4 + 0.1 * 0.1) / 2)).epsilon(1e-12));
    CHECK(distance(compared(temp, b, a), "slope_area") == Approx(distance(ab, "slope_area")).epsilon(1e-12));
    CHECK(ab["aspects"][0]["a"] == 0.5);
    CHECK(ab["aspects"][0]["b"] == 0.8);
    CHECK(distance(ab, "hypsometry") == 0);
    CHECK(distance(ab, "horton") == 0);
}

TEST_CASE("Curves without an area in common have no distance, and a note says so") {
    const TempFolder temp;
    Json other = drawn_summary();
    other["slope_area"]["bins"] = {bin(7, -1), bin(8, -2)};
    const Json ab = compared(temp, folder_of(temp, "a", drawn_summary()), folder_of(temp, "b", other));
    CHECK(std::isnan(distance(ab, "slope_area")));
    CHECK(ab["notes"].dump().find("slope_area") != std::string::npos);
}

TEST_CASE("The hypsometric distance is the whole area between the curves, also where they cross") {
    const TempFolder temp;
    const auto a = folder_of(temp, "a", drawn_summary());
    Json bent = drawn_summary();
    bent["hypsometry"]["relative_area"] = {1, 0.2, 0};  // a triangle of height 0.3 over the whole width
    CHECK(distance(compared(temp, a, folder_of(temp, "b", bent)), "hypsometry") == Approx(0.15).epsilon(1e-9));
    Json crossing = drawn_summary();
    crossing["hypsometry"]["relative_height"] = {0, 0.25, 0.5, 0.75, 1};  // 0.2 below, then 0.2 above
    crossing["hypsometry"]["relative_area"] = {1, 0.55, 0.5, 0.45, 0};
    CHECK(distance(compared(temp, folder_of(temp, "c", crossing), a), "hypsometry") == Approx(0.1).epsilon(1e-9));
}

TEST_CASE("The Horton distance takes all four ratios by regression, or those that both sides have") {
    const TempFolder temp;
    const auto a = folder_of(temp, "a", drawn_summary());
    Json other = drawn_summary();
    other["horton"] = {{"RB", ratio(4 * std::exp(0.1))},
                       {"RL", ratio(2 * std::exp(-0.2))},
                       {"RA", ratio(5 * std::exp(0.3))},
                       {"RS", ratio(1.5 * std::exp(-0.4))}};
    CHECK(distance(compared(temp, a, folder_of(temp, "b", other)), "horton") ==
          Approx(std::sqrt((0.01 + 0.04 + 0.09 + 0.16) / 4)).epsilon(1e-12));
    other["horton"]["RS"]["regression"] = nullptr;
    CHECK(distance(compared(temp, folder_of(temp, "b", other), a), "horton") ==
          Approx(std::sqrt((0.01 + 0.04 + 0.09) / 3)).epsilon(1e-12));
}

TEST_CASE("The relief distance is the logarithm of the ratio of the reliefs") {
    const TempFolder temp;
    Json other = drawn_summary();
    other["input"] = {{"elevation_min_m", 50.0}, {"elevation_max_m", 150.0}};
    const auto a = folder_of(temp, "a", drawn_summary()), b = folder_of(temp, "b", other);
    CHECK(distance(compared(temp, a, b), "relief") == Approx(std::log(2.0)).epsilon(1e-12));
    CHECK(distance(compared(temp, b, a), "relief") == Approx(std::log(2.0)).epsilon(1e-12));
}

TEST_CASE("Two DEMs are measured with the larger of their default thresholds, or with the user's") {
    const TempFolder temp;
    // 9e4 m² would have 100 m², 3.6e5 m² has 500 m².
    const auto small = slope_of(temp, "small.tif", 30), large = slope_of(temp, "large.tif", 60);
    for (const Json& comparison : {compared(temp, small, large), compared(temp, large, small)}) {
        CHECK(comparison["channel_threshold_area_m2"] == 500.0);
        CHECK(comparison["a"]["channels"]["threshold_area_m2"] == 500.0);
        CHECK(comparison["b"]["channels"]["threshold_area_m2"] == 500.0);
    }
    const Json asked = compared(temp, small, large, 250);
    CHECK(asked["channel_threshold_area_m2"] == 250.0);
    CHECK(asked["a"]["channels"]["threshold_area_m2"] == 250.0);
    CHECK(asked["b"]["channels"]["threshold_area_m2"] == 250.0);
}

TEST_CASE("A side measured before sets the threshold of the other, and two that differ are refused") {
    const TempFolder temp;
    const auto measured = folder_of(temp, "a", drawn_summary());
    const auto dem = slope_of(temp, "dem.tif", 60);
    const Json comparison = compared(temp, dem, measured);
    CHECK(comparison["channel_threshold_area_m2"] == 5000.0);
    CHECK(comparison["a"]["channels"]["threshold_area_m2"] == 5000.0);
    CHECK(compared(temp, measured, dem, 5000)["channel_threshold_area_m2"] == 5000.0);
    Json other = drawn_summary();
    other["channels"]["threshold_area_m2"] = 1000.0;
    const auto finer = folder_of(temp, "b", other);
    CHECK(error_of([&] { compared(temp, measured, finer); }).find("one ruler") != std::string::npos);
    CHECK(error_of([&] { compared(temp, measured, dem, 200); }).find("one ruler") != std::string::npos);
    other["channels"]["threshold_area_m2"] = nullptr;
    const auto from_heads = folder_of(temp, "c", other);
    CHECK(error_of([&] { compared(temp, from_heads, dem); }).find("do not begin at a drainage area") !=
          std::string::npos);
}

TEST_CASE("What a DEM was is told, and by what the sides were measured differently") {
    const TempFolder temp;
    const auto dem = slope_of(temp, "dem.tif", 60);
    Json other = drawn_summary();
    other["routing"] = "mfd";
    other["conditioning"] = {{"method", "none"}};
    other["channels"]["edge_basins"] = "keep";
    other["channels"]["rule"] = "drop";
    other["chi"]["theta"] = 0.5;
    other["input"]["dx_m"] = other["input"]["dy_m"] = 2.0;
    const Json unlike = compared(temp, dem, folder_of(temp, "b", other));
    const Json& input = unlike["a"]["input"];
    CHECK(input["file"] == "dem.tif");
    CHECK(input["rows"] == 60);
    CHECK(input["valid_cells"] == 3600);
    CHECK(input["area_m2"] == 360000.0);
    CHECK(input["dx_m"] == 10.0);
    for (const char* word :
         {"routing: d8 in a, mfd in b", "conditioning: fill in a, none in b",
          "basins that the edge cuts: drop in a, keep in b", "cells of 10 m in a, of 2 m in b",
          "rule that says where channels begin: area in a, drop in b", "theta of chi and ksn: 0.45 in a, 0.5 in b"}) {
        CHECK(unlike["notes"].dump().find(word) != std::string::npos);
    }
    const Json alike = compared(temp, dem, dem);
    for (const Json& note : alike["notes"]) {
        CHECK(note.get<std::string>().find("in b") == std::string::npos);
    }
}

TEST_CASE("Options that say how a DEM is read are refused where no side is a DEM") {
    const TempFolder temp;
    const auto simulated = temp / "simulated";
    std::filesystem::create_directories(simulated);
    std::filesystem::rename(slope_of(temp, "dem.tif", 60), simulated / "elevation.tif");
    temp.text("simulated/slope_area_nodes.csv", "area_m2,slope,talus_limited\n");
    CompareOptions crop;
    crop.read.window = io::Window{5e5, 4e6 - 300, 5e5 + 300, 4e6};
    std::filesystem::create_directories(temp / "out");
    CHECK(test::is_sentence(error_of([&] { compare(simulated, simulated, crop, temp / "out", {}); })));
    CompareOptions keep;
    keep.measure.edge_basins = terrain::EdgeBasins::keep;  // that is how both are measured now
    CHECK(error_of([&] { compare(simulated, simulated, keep, temp / "out", {}); }).empty());
}

TEST_CASE("The finer of two rasters is brought to the coarser one's cells, whichever side it is", "[compare][cells]") {
    const TempFolder temp;
    const auto fine = rough_terrain(temp, "fine.tif", 120, 10), coarse = rough_terrain(temp, "coarse.tif", 40, 30);
    const Json ab = compared(temp, fine, coarse), ba = compared(temp, coarse, fine);
    CHECK(ab["cells"] == Json{{"rule", "common"},
                              {"resampled", "a"},
                              {"a_m", 30.0},
                              {"b_m", 30.0},
                              {"a_before_m", 10.0},
                              {"b_before_m", 30.0}});
    CHECK(ba["cells"]["resampled"] == "b");
    CHECK(ab["a"]["input"]["rows"] == 40);
    CHECK(ab["a"]["input"]["dx_m"] == 30.0);
    CHECK(ab["a"]["input"]["area_m2"] == ab["b"]["input"]["area_m2"]);
    CHECK(ab["notes"].dump().find("'fine.tif' was brought from cells of 10 m") != std::string::npos);
    CHECK(ab["notes"].dump().find("depend on their size") == std::string::npos);
    // The coarse file holds the means of the fine one's cells, so nothing is left between the two.
    for (const Json& aspect : ab["aspects"]) {
        if (aspect["distance"].is_number()) CHECK(aspect["distance"].get<double>() == Approx(0).margin(1e-6));
    }
    CHECK(distance(ab, "hypsometry") == Approx(distance(ba, "hypsometry")).margin(1e-12));
}

TEST_CASE("A warning tells where larger cells leave hardly any of a terrain", "[compare][cells]") {
    const TempFolder temp;
    const auto fine = rough_terrain(temp, "fine.tif", 60, 10), coarse = rough_terrain(temp, "coarse.tif", 60, 30);
    std::string warnings;
    std::filesystem::create_directories(temp / "out");
    compare(coarse, fine, {}, temp / "out", {.warning = [&](const std::string& text) { warnings += text + "\n"; }});
    CHECK(warnings.find("'fine.tif' has 20 rows x 20 columns left") != std::string::npos);
}

TEST_CASE("Each side may keep its own cells, and then a note tells", "[compare][cells]") {
    const TempFolder temp;
    const auto fine = rough_terrain(temp, "fine.tif", 120, 10), coarse = rough_terrain(temp, "coarse.tif", 40, 30);
    CompareOptions own;
    own.cells = CompareCells::own;
    std::filesystem::create_directories(temp / "out");
    const Json ab = Json::parse(compare(fine, coarse, own, temp / "out", {}));
    CHECK(ab["cells"]["rule"] == "own");
    CHECK(ab["cells"]["resampled"] == "neither");
    CHECK(ab["a"]["input"]["rows"] == 120);
    CHECK(ab["notes"].dump().find("cells of 10 m in a, of 30 m in b") != std::string::npos);
    CHECK(ab["notes"].dump().find("give the DEM") == std::string::npos);
}

TEST_CASE("Cells that differ by a few per cent are left alone", "[compare][cells]") {
    const TempFolder temp;
    const auto one = rough_terrain(temp, "one.tif", 60, 10), other = rough_terrain(temp, "other.tif", 60, 10.4);
    const Json ab = compared(temp, one, other);
    CHECK(ab["cells"]["resampled"] == "neither");
    CHECK(ab["a"]["input"]["rows"] == 60);
    CHECK(ab["notes"].dump().find("depend on their size") == std::string::npos);
}

TEST_CASE("A finer terrain of which only the measures are left is warned of", "[compare][cells]") {
    const TempFolder temp;
    Json measured = drawn_summary();
    measured["input"]["dx_m"] = measured["input"]["dy_m"] = 2.0;
    const auto folder = folder_of(temp, "measured", measured);
    const auto dem = rough_terrain(temp, "dem.tif", 60, 10);
    std::vector<std::string> warnings;
    std::filesystem::create_directories(temp / "out");
    const Json ab = Json::parse(compare(folder, dem, {}, temp / "out",
                                        {.warning = [&](const std::string& text) { warnings.push_back(text); }}));
    CHECK(ab["cells"]["resampled"] == "neither");
    const std::string advice = "give the DEM that '" + folder.string() + "' was measured on";
    CHECK(std::ranges::count_if(warnings, [&](const auto& text) { return text.find(advice) != std::string::npos; }) ==
          1);
}

TEST_CASE("A study whose model has cells of another size is told how to have them alike", "[compare][cells]") {
    const TempFolder temp;
    Json basin = drawn_summary(), made = drawn_summary();
    basin["input"]["dx_m"] = basin["input"]["dy_m"] = 90.0;
    made["input"]["dx_m"] = made["input"]["dy_m"] = 30.0;
    made["input"]["rows"] = 400;
    made["input"]["cols"] = 600;
    std::filesystem::create_directories(temp / "out");
    const Json ab = Json::parse(compare(folder_of(temp, "basin", basin), folder_of(temp, "grown", made),
                                        {.read = {}, .measure = {}, .model_of_b = temp / "grow"}, temp / "out", {}));
    const std::string note = ab["notes"][0];
    CHECK(note.find("ask for output.resolution = 200,") != std::string::npos);
    CHECK(note.find((temp / "grown").string()) == std::string::npos);  // by then it has another name
}

TEST_CASE("A grown terrain on larger cells still leaves at its outlet alone, so that all of it counts",
          "[compare][cells]") {
    const TempFolder temp;
    grown_folder(temp, "grown", 1);
    const auto coarse = rough_terrain(temp, "coarse.tif", 60, 60);
    const Json ab = compared(temp, temp / "grown", coarse, 1e5);
    CHECK(ab["cells"]["resampled"] == "a");
    CHECK(ab["cells"]["a_before_m"] == Approx(25.0));
    CHECK(ab["cells"]["a_m"].get<double>() == Approx(60).epsilon(0.02));
    CHECK(ab["a"]["channels"]["share_used"] == 1.0);
    CHECK(ab["a"]["channels"]["outlets"] == 1);
    const double basin_m2 = 1.775e+07;  // by the shoelace formula
    CHECK(ab["a"]["channels"]["basin_area_m2"].get<double>() == Approx(basin_m2).epsilon(0.01));
}

TEST_CASE("A difference is judged by those between realisations with other seeds", "[compare][scale]") {
    const TempFolder temp;
    const auto grown = grown_folder(temp, "grown", 1), dem = rough_terrain(temp, "dem.tif", 120, 25);
    CompareOptions options;
    options.measure.channel_area_m2 = 1e5;
    options.realisations = 3;
    std::filesystem::create_directories(temp / "judged");
    const Json judged = Json::parse(compare(dem, grown, options, temp / "judged", {}));
    CHECK(judged["realisations"] == 3);
    CHECK(std::distance(std::filesystem::directory_iterator(temp / "judged"), {}) == 1);  // nothing of them is left

    // The same by hand: the terrains of the next three seeds, compared in pairs.
    const auto second = grown_folder(temp, "second", 2), third = grown_folder(temp, "third", 3),
               fourth = grown_folder(temp, "fourth", 4);
    const Json pairs[] = {compared(temp, second, third, 1e5), compared(temp, second, fourth, 1e5),
                          compared(temp, third, fourth, 1e5)};
    const Json plain = compared(temp, dem, grown, 1e5);
    int with_scale = 0;
    for (std::size_t k = 0; k < judged["aspects"].size(); ++k) {
        const Json& aspect = judged["aspects"][k];
        INFO(aspect["name"]);
        CHECK(aspect["distance"] == plain["aspects"][k]["distance"]);
        CHECK(plain["aspects"][k]["scale"].is_null());
        CHECK(plain["aspects"][k]["verdict"] == "not judged");
        CHECK(aspect["scale"].is_null() == aspect["distance"].is_null());
        if (aspect["distance"].is_null()) continue;  // the drawn DEM has no second order
        ++with_scale;
        std::vector<double> distances;
        for (const Json& pair : pairs) distances.push_back(pair["aspects"][k]["distance"]);
        std::ranges::sort(distances);
        CHECK(aspect["scale"].get<double>() == Approx(distances[1]).epsilon(1e-12));
        const double own = aspect["distance"];
        const auto as_far = std::ranges::count_if(distances, [&](double each) { return each >= own; });
        CHECK(aspect["share_as_far"].get<double>() == Approx(static_cast<double>(as_far) / 3));
        const double values[] = {pairs[0]["aspects"][k]["a"], pairs[0]["aspects"][k]["b"], pairs[1]["aspects"][k]["b"]};
        CHECK(aspect["model_mean"].get<double>() == Approx((values[0] + values[1] + values[2]) / 3).epsilon(1e-12));
        CHECK(aspect["model_sd"].get<double>() == Approx(standard_deviation(values)).epsilon(1e-9));
        CHECK(aspect["verdict"] == "not judged");  // three pairs cannot tell what is rare
    }
    CHECK(with_scale > 5);
}

TEST_CASE("From twenty realisations on a difference that is rarer than one in twenty is beyond them",
          "[compare][scale]") {
    const TempFolder temp;
    const auto grown = grown_folder(temp, "grown", 1), dem = rough_terrain(temp, "dem.tif", 120, 25);
    CompareOptions options;
    options.measure.channel_area_m2 = 1e5;
    options.realisations = 20;
    std::filesystem::create_directories(temp / "judged");
    const Json judged = Json::parse(compare(dem, grown, options, temp / "judged", {}));
    int beyond = 0, within = 0;
    for (const Json& aspect : judged["aspects"]) {
        if (aspect["scale"].is_null()) continue;
        const bool is_rare = aspect["share_as_far"].get<double>() < 0.05;
        (is_rare ? beyond : within) += 1;
        CHECK(aspect["verdict"] == (is_rare ? "beyond the model's own scatter" : "within the model's own scatter"));
        if (is_rare) CHECK(aspect["distance"].get<double>() > aspect["scale_q95"].get<double>() * (1 - 1e-12));
    }
    CHECK(beyond > 0);  // a rough surface is no grown terrain
    CHECK(beyond + within > 5);
}

TEST_CASE("A common threshold of a few cells is warned of", "[compare]") {
    const TempFolder temp;
    const auto a = rough_terrain(temp, "a.tif", 60, 30), b = rough_terrain(temp, "b.tif", 60, 30);
    const auto warned = [&](double area_m2) {
        std::vector<std::string> warnings;
        CompareOptions options;
        options.measure.channel_area_m2 = area_m2;
        const auto folder = temp / fmt::format("with_{}", area_m2);
        std::filesystem::create_directories(folder);
        Messages messages;
        messages.warning = [&](const std::string& w) { warnings.push_back(w); };
        compare(a, b, options, folder, messages);
        return std::ranges::any_of(warnings, [](const std::string& w) { return w.starts_with("channels begin at"); });
    };
    CHECK(warned(5 * 900));
    CHECK_FALSE(warned(20 * 900));
}

TEST_CASE("One realisation, or none to be had, is refused", "[compare][scale]") {
    const TempFolder temp;
    const auto dem = slope_of(temp, "dem.tif", 60);
    CompareOptions options;
    std::filesystem::create_directories(temp / "out");
    options.realisations = 20;
    CHECK(error_of([&] { compare(dem, dem, options, temp / "out", {}); }).find("neither side") != std::string::npos);
    options.realisations = 1;
    CHECK(error_of([&] { compare(dem, dem, options, temp / "out", {}); }).find("at least 2") != std::string::npos);
    CHECK(std::filesystem::is_empty(temp / "out"));
}
