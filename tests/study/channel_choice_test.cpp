// SPDX-License-Identifier: GPL-3.0-or-later
// Where channels begin, by slope and area and by constant stream drops.
#include <catch2/catch.hpp>

#include <cmath>
#include <nlohmann/json.hpp>

#include "support/drawn_catchment.hpp"
#include "support/temp_folder.hpp"
#include "support/terrains.hpp"
#include "thalweg/core/error.hpp"
#include "thalweg/study/analyze.hpp"

using namespace thalweg;
using namespace thalweg::study;
using Json = nlohmann::json;
using support::raster_of;
using test::TempFolder;

namespace {

Raster jacksboro() { return io::read_raster(THALWEG_SOURCE_DIR "/validation/data/jacksboro.tif").raster; }

RasterMeasurement measured(const Raster& raster, ChannelRule rule, std::optional<double> slope_area_m2 = {}) {
    MeasureOptions options;
    options.channels = rule;
    options.slope_area_m2 = slope_area_m2;
    return measure_raster(raster, options);
}

Json analyzed(const Raster& raster, ChannelRule rule, const std::filesystem::path& folder) {
    MeasureOptions options;
    options.channels = rule;
    std::filesystem::create_directories(folder);
    return Json::parse(analyze({raster, "drawn.tif", "", "", {}, {}}, options, folder, {}));
}

}  // namespace

TEST_CASE("Channels by drops begin at the least area from which on tests pass, and each test counts that area's streams",
          "[channel choice]") {
    const Raster dem = jacksboro();
    const RasterMeasurement m = measured(dem, ChannelRule::drop);
    const auto& tests = m.channel_evidence.drop_tests;
    REQUIRE(tests.size() > 10);
    std::optional<double> least;
    for (const channel::DropTest& test : tests) {
        if (!least && std::abs(test.t) < 2) least = test.threshold;
        MeasureOptions by_area;
        by_area.channel_area_m2 = test.threshold;
        const auto strahler = measure_raster(dem, by_area).statistics.strahler;
        CHECK((strahler.empty() ? 0 : strahler[0].streams) == test.first_order);
        if (test.first_order > 0) CHECK(strahler[0].mean_drop_m == Approx(test.first_mean_m).epsilon(1e-12));
        if (test.threshold > 1e6) break;  // a few rows show it
    }
    REQUIRE(least);
    CHECK(m.statistics.channels.threshold_area_m2 == *least);
    CHECK(m.statistics.channels.rule == ChannelRule::drop);
    CHECK(m.statistics.channels.source_area_m2[0] >= *least);
}

TEST_CASE("Channels by slope and area hold every cell whose own product is enough, and begin at such cells alone",
          "[channel choice]") {
    const double threshold = 3000;
    const RasterMeasurement m = measured(jacksboro(), ChannelRule::slope_area, threshold);
    CHECK(m.channel_evidence.slope_area_m2 == threshold);
    CHECK(m.channel_evidence.drop_tests.empty());
    const auto& t = m.terrain;
    const auto own_product = [&](Index node) {
        const Index below = t.graph.receiver[node];
        if (below == none) return 0.0;
        const double slope = (t.elevation_m[node] - t.elevation_m[below]) / t.graph.length[node];
        return t.drainage_area_m2[node] * slope * slope;
    };
    std::vector<std::uint8_t> begun(t.graph.size(), 0), is_channel(t.graph.size(), 0);
    for (auto node = t.graph.order.rbegin(); node != t.graph.order.rend(); ++node) {
        is_channel[*node] = begun[*node] || own_product(*node) >= threshold;
        if (t.graph.receiver[*node] != none && is_channel[*node]) begun[t.graph.receiver[*node]] = 1;
    }
    Index cells = 0;
    for (const Index node : t.graph.order) {
        const bool used = is_channel[node] && t.complete[node];
        cells += used;
        REQUIRE((m.statistics.strahler_of[node] > 0) == used);
    }
    CHECK(cells > 1000);
    CHECK(std::isnan(m.statistics.channels.threshold_area_m2));
}

TEST_CASE("On slopes that are all alike the slope-area product is a threshold of area", "[channel choice]") {
    // Every cell falls 1 in 5 to the south; columns do not meet.
    const Raster ramp = raster_of(support::terrain_of(
        "ramp", 40, 5, [](Index r, Index c) { return 2.0 * (39 - r) + (c % 2 ? 0 : 40); }, 10, 10));
    MeasureOptions options;
    options.edge_basins = terrain::EdgeBasins::keep;
    options.channels = ChannelRule::slope_area;
    options.slope_area_m2 = 1000 * 0.2 * 0.2;
    const auto by_product = measure_raster(ramp, options).statistics;
    const auto network_of = [&](double area_m2) {
        MeasureOptions by_area;
        by_area.edge_basins = terrain::EdgeBasins::keep;
        by_area.channel_area_m2 = area_m2;
        return measure_raster(ramp, by_area).statistics;
    };
    // The columns in between shed sideways, 40 m in 10 m; a cell of theirs has 100 m² · 4² and begins a channel.
    CHECK(by_product.strahler_of == network_of(1).strahler_of);
    options.slope_area_m2 = 100 * 16 * 1.01;
    const auto steeper = measure_raster(ramp, options).statistics;
    CHECK(steeper.network.size() == 0);  // 40 · 3 cells at most, times 0.04
}

TEST_CASE("Without a threshold for the product, drops choose it, and the summary shows the tests", "[channel choice]") {
    const TempFolder temp;
    const Raster dem = jacksboro();
    const Json s = analyzed(dem, ChannelRule::slope_area, temp / "product");
    const Json& c = s["channels"];
    CHECK(c["rule"] == "slope-area");
    std::optional<double> least;
    for (const Json& test : c["drop_analysis"]) {
        if (!least && test["t"].is_number() && std::abs(test["t"].get<double>()) < 2) least = test["threshold_m2"];
    }
    REQUIRE(least);
    CHECK(c["threshold_slope_area_m2"] == *least);
    CHECK(c["threshold_area_m2"].is_null());
    CHECK(analyzed(dem, ChannelRule::area, temp / "area")["channels"].contains("drop_analysis") == false);
}

TEST_CASE("Terrain on which no threshold has constant drops is refused in one sentence", "[channel choice]") {
    const auto error = [](const Raster& raster) -> std::string {
        try {
            measured(raster, ChannelRule::drop);
        } catch (const Error& e) {
            return e.what();
        }
        return "";
    };
    const Raster ramp = raster_of(support::terrain_of(
        "ramp", 30, 30, [](Index r, Index) { return 30.0 - r; }, 10, 10));
    CHECK(error(ramp).find("give one yourself") != std::string::npos);
    const Raster tiny = raster_of(support::terrain_of(
        "tiny", 3, 3, [](Index r, Index) { return 3.0 - r; }, 10, 10));
    CHECK(error(tiny).find("too small") != std::string::npos);
}
