// SPDX-License-Identifier: GPL-3.0-or-later
#include <catch2/catch.hpp>
#include <cmath>
#include <nlohmann/json.hpp>

#include "support/drawn_catchment.hpp"
#include "support/temp_folder.hpp"
#include "support/terrains.hpp"
#include "thalweg/core/error.hpp"
#include "thalweg/study/analyze.hpp"
#include "thalweg/terrain/derivatives.hpp"

using namespace thalweg;
using namespace thalweg::study;
using support::raster_of;
using Json = nlohmann::json;

namespace {

constexpr Index rows = 12, cols = 15;

/// A plane that falls 0.3 to the south and 0.4 to the east, with one hole.
Raster tilted() {
    Raster raster = raster_of(
        support::terrain_of("tilted", rows, cols, [](Index r, Index c) { return 500 - 10 * (0.3 * r + 0.4 * c); }));
    raster.grid = plane_grid(rows, cols, 10, 10);
    raster.placement.cell_width = raster.placement.cell_height = 10;
    raster.values[5 * cols + 6] = support::nodata;
    return raster;
}

Json analyzed(const Raster& raster, const std::optional<DerivativeOptions>& derivatives,
              const std::filesystem::path& folder) {
    std::filesystem::create_directories(folder);
    MeasureOptions options;
    options.edge_basins = terrain::EdgeBasins::keep;
    options.derivatives = derivatives;
    return Json::parse(analyze({raster, "tilted.tif", "", "", {}, {}}, options, folder, {}));
}

std::vector<double> cells_of(const std::filesystem::path& file) { return io::read_raster(file).raster.values; }

}  // namespace

TEST_CASE("Derivatives of a tilted plane are written and summed up as one counts them", "[derivatives]") {
    const test::TempFolder temp;
    const Json summary = analyzed(tilted(), DerivativeOptions{.relief_radius_m = 20}, temp / "out");
    const Json& d = summary["derivatives"];
    const int inside = (rows - 2) * (cols - 2) - 9;
    CHECK(d["slope"]["cells"] == inside);
    for (const char* key : {"mean", "q05", "median", "q95"}) CHECK(d["slope"][key].get<double>() == Approx(0.5));
    CHECK(d["slope"]["sd"].get<double>() == Approx(0).margin(1e-9));
    CHECK(d["aspect"]["cells"] == inside);
    CHECK(d["aspect"]["mean_direction_deg"].get<double>() == Approx(180 - 53.13010235));
    CHECK(d["aspect"]["resultant_length"].get<double>() == Approx(1));
    CHECK(d["aspect"]["wind_shares"] == Json({0, 0, 0, 1, 0, 0, 0, 0}));  // south-east
    CHECK(d["roughness_m"]["median"].get<double>() == Approx(2 * 10 * (0.3 + 0.4)).epsilon(1e-5));
    CHECK(d["relief_radius_m"] == 20);
    // Within two cells: the farthest down the slope are (1, 1) and (0, 2), with 7 and 8 m each way.
    CHECK(d["local_relief_m"]["q75"].get<double>() == Approx(16));
    CHECK(d["local_relief_m"]["cells"] == rows * cols - 1);
    CHECK(d["profile_curvature_per_m"]["mean"].get<double>() == Approx(0).margin(1e-9));
    CHECK(d["plan_curvature_per_m"]["cells"] == inside);

    const std::vector<double> slope = cells_of(temp / "out" / "slope.tif");
    const std::vector<double> aspect = cells_of(temp / "out" / "aspect.tif");
    const std::vector<double> shade = cells_of(temp / "out" / "hillshade.tif");
    const std::vector<double> relief = cells_of(temp / "out" / "local_relief.tif");
    CHECK(slope[cols + 1] == Approx(0.5));
    CHECK(std::isnan(slope[0]));
    CHECK(std::isnan(slope[4 * cols + 5]));
    CHECK(aspect[cols + 1] == Approx(126.86989765));
    // The sun in the north-west, 45° high, on a normal (0.4, -0.3, 1): (−0.2 − 0.15 + 0.7071)/√1.25.
    CHECK(shade[cols + 1] == std::round(1 + 254 * (-0.35 + std::sqrt(0.5)) / std::sqrt(1.25)));
    CHECK(std::isnan(shade[5 * cols + 6]));
    CHECK(std::isnan(relief[5 * cols + 6]));
    CHECK(relief[3 * cols + 3] == Approx(16));
    for (const char* name : {"profile_curvature.tif", "plan_curvature.tif", "roughness.tif"}) {
        CHECK(cells_of(temp / "out" / name).size() == slope.size());
    }
}

TEST_CASE("Without being asked for there are no derivatives; a radius under a cell is refused", "[derivatives]") {
    const test::TempFolder temp;
    CHECK_FALSE(analyzed(tilted(), {}, temp / "plain").contains("derivatives"));
    CHECK_FALSE(std::filesystem::exists(temp / "plain" / "slope.tif"));
    CHECK_THROWS_WITH(analyzed(tilted(), DerivativeOptions{.relief_radius_m = 4}, temp / "small"),
                      Catch::Contains("less than a cell of 10 m"));
    CHECK(analyzed(tilted(), DerivativeOptions{}, temp / "default")["derivatives"]["relief_radius_m"] == 100);
}

TEST_CASE("What has no derivative is null in the summary, with the reason", "[derivatives]") {
    const test::TempFolder temp;
    Raster level = tilted();
    for (double& each : level.values) each = 7;
    const Json summary = analyzed(level, DerivativeOptions{}, temp / "level");
    CHECK(summary["derivatives"]["slope"]["mean"] == 0);
    CHECK(summary["derivatives"]["aspect"]["cells"] == 0);
    CHECK(summary["derivatives"]["aspect"]["mean_direction_deg"].is_null());
    CHECK(summary["derivatives"]["plan_curvature_per_m"]["median"].is_null());
    CHECK(summary["notes"].dump().find("derivatives:") != std::string::npos);
}
