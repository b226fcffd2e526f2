// SPDX-License-Identifier: GPL-3.0-or-later
// What becomes of closed depressions in a measured DEM.
#include <catch2/catch.hpp>

#include <cmath>

#include "support/drawing.hpp"
#include "support/drawn_catchment.hpp"
#include "support/terrains.hpp"
#include "thalweg/core/error.hpp"
#include "thalweg/study/measure.hpp"

using namespace thalweg;
using namespace thalweg::study;
using support::draw;
using support::raster_of;

namespace {

/// Two closed depressions of cells of 10 m: one 7 m deep of four cells in the west, one 3 m deep of three in the east.
Raster two_lakes() {
    const auto d = draw(R"(
        9 9 9 9 9 9 9
        9 3 2 9 4 5 9
        9 2 8 9 9 5 7
        9 9 9 9 9 9 9)");
    return raster_of({"two lakes", plane_grid(d.rows, d.cols, 10, 10), d.values});
}

RasterMeasurement measured(const Raster& raster, Conditioning conditioning, const Endorheic& endorheic = {},
                           const terrain::BreachLimits& limits = {}) {
    MeasureOptions options;
    options.conditioning = conditioning;
    options.endorheic = endorheic;
    options.breach_limits = limits;
    return measure_raster(raster, options);
}

}  // namespace

TEST_CASE("Depressions that are deep, large or pointed at keep their water, the others are filled", "[conditioning]") {
    const Raster raster = two_lakes();
    const auto kept = [&](const Endorheic& wanted) {
        return measured(raster, Conditioning::fill, wanted).conditioning;
    };
    CHECK(kept({}).endorheic_basins == 0);
    CHECK(kept({}).filled_m3 == Approx(100 * (6 + 7 + 7 + 1 + 3 + 2 + 2)));
    CHECK(kept({.depth_m = 3}).endorheic_basins == 2);
    CHECK(kept({.depth_m = 3.1}).endorheic_basins == 1);
    CHECK(kept({.depth_m = 3.1}).filled_m3 == Approx(100 * (1 + 3 + 2 + 2 - 1)));  // west: all run to 2 but no deeper
    CHECK(kept({.area_m2 = 400}).endorheic_basins == 1);
    CHECK(kept({.depth_m = 8, .area_m2 = 100}).endorheic_basins == 0);
    CHECK(kept({.cells = {1 * 7 + 5}}).endorheic_basins == 1);
    CHECK(kept({.cells = {1 * 7 + 5}}).filled_m3 == Approx(100 * (6 + 7 + 7 + 1)));
    CHECK_THROWS_AS(kept({.cells = {0}}), Error);
}

TEST_CASE("A depression that is kept is a basin of its own, complete, with its lowest cell as the outlet",
          "[conditioning]") {
    // A bowl of 69 cells in the top of a cone: what drains into it never leaves, and nothing comes from the edge.
    const Raster raster = raster_of(support::terrain_of(
        "bowl", 21, 21,
        [](Index r, Index c) {
            const double away = std::hypot(r - 10.0, c - 10.0);
            return away < 5 ? 60 + 6 * away : 100.0 - away;
        },
        10, 10));
    const RasterMeasurement open = measured(raster, Conditioning::fill);
    const RasterMeasurement kept = measured(raster, Conditioning::fill, {.depth_m = 10});
    const Index bottom = 10 * 21 + 10;
    CHECK(open.terrain.graph.receiver[bottom] != none);
    CHECK(kept.terrain.graph.receiver[bottom] == none);
    CHECK(kept.conditioning.endorheic_basins == 1);
    CHECK(kept.conditioning.filled_m3 == 0);
    CHECK(kept.terrain.complete[bottom] == 1);
    bool found = false;
    for (const BasinStatistics& basin : kept.statistics.basins) {
        if (basin.basin.outlet != bottom) continue;
        found = true;
        CHECK(basin.basin.area_m2 == kept.terrain.drainage_area_m2[bottom]);
        CHECK(basin.basin.area_m2 > 69 * 100);  // the bowl itself, and what falls into it
    }
    CHECK(found);
}

TEST_CASE("With limits, what is cheap is breached and the rest filled, and all water leaves", "[conditioning]") {
    for (std::uint64_t seed = 0; seed < 10; ++seed) {
        const Raster raster = raster_of(support::with_holes(support::stepped_terrain(30, 30, 12, seed), 0.01, seed));
        const ConditioningReport filled = measured(raster, Conditioning::fill).conditioning;
        const ConditioningReport cut = measured(raster, Conditioning::breach).conditioning;
        const RasterMeasurement both = measured(raster, Conditioning::breach, {}, {.depth_m = 2, .length_m = 3});
        CHECK(filled.cut_m3 == 0);
        CHECK(cut.filled_m3 == 0);
        CHECK(cut.volume_m3 == cut.cut_m3);
        CHECK(both.conditioning.cut_m3 > 0);
        CHECK(both.conditioning.filled_m3 > 0);
        CHECK(both.conditioning.filled_m3 < filled.filled_m3);
        CHECK(both.conditioning.cut_m3 < cut.cut_m3);
        double leaving = 0;
        for (const Index node : both.terrain.graph.order) {
            const Index below = both.terrain.graph.receiver[node];
            if (below == none) leaving += both.terrain.drainage_area_m2[node];
            if (below != none) REQUIRE(both.terrain.elevation_m[below] <= both.terrain.elevation_m[node]);
        }
        CHECK(leaving == Approx(both.area_m2).epsilon(1e-12));
    }
}
