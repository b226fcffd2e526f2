// SPDX-License-Identifier: GPL-3.0-or-later
#include "thalweg/study/fit_growth.hpp"

#include <catch2/catch.hpp>
#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>

#include "support/temp_folder.hpp"
#include "thalweg/mesh/triangulate.hpp"
#include "thalweg/study/parameters.hpp"

using namespace thalweg;
using namespace thalweg::study;
using Json = nlohmann::json;
using test::TempFolder;

namespace {

namespace fs = std::filesystem;

const fs::path jacksboro = fs::path(THALWEG_SOURCE_DIR) / "validation/data/jacksboro.tif";

std::string text_of(const fs::path& file) {
    std::ifstream stream(file, std::ios::binary);
    std::ostringstream text;
    text << stream.rdbuf();
    return text.str();
}

}  // namespace

TEST_CASE("A fit of growth writes a basin and dials that read back as they were found") {
    const TempFolder folder;
    const Json fit = Json::parse(fit_growth(jacksboro, {}, folder / "", {}));
    const Experiment e = read_experiment(folder / "growth.toml");
    const GrowthSite site = growth_site(e, {});
    const GrowthSite own = growth_site(largest_complete_catchment(read_dem(jacksboro, {}, {}).raster, {}));
    REQUIRE(site.basin.outline.size() == own.basin.outline.size());
    const double area = std::abs(mesh::polygon_area(own.basin.outline));
    CHECK(std::abs(mesh::polygon_area(site.basin.outline)) == Approx(area).epsilon(1e-9));
    CHECK(site.basin.outlet.x == Approx(own.basin.outlet.x).margin(0.01));
    CHECK(site.basin.source.y == Approx(own.basin.source.y).margin(0.01));
    CHECK(site.basin.base_level_m == own.basin.base_level_m);
    CHECK_FALSE(site.crs_wkt.empty());
    const grow::Dials dials = dials_of(e);
    const auto estimate = [&](const char* dial) { return fit["growth"][dial]["estimate"].get<double>(); };
    CHECK(dials.channel_maintenance_m == estimate("channel_maintenance_m"));
    CHECK(dials.mean_length == estimate("mean_length"));
    CHECK(dials.flint.q == estimate("flint_q"));
    CHECK(dials.lower_bias == estimate("lower_bias"));
    const auto grown = grow::grow(site.basin, dials);
    CHECK(grow::total_area(grown.network) == Approx(area).epsilon(1e-9));
    // C is the basin's area over D8's lengths, which are 5.5 % too long.
    const auto& c = fit["growth"]["channel_maintenance_m"];
    CHECK(area / grow::total_length(grown.network) == Approx(c["estimate"].get<double>()).epsilon(0.02));
    for (const char* key : {"k", "m", "theta", "ks", "reduced_chi2"}) CHECK(fit[key].is_null());
    CHECK(fit["notes"].size() > 1);
}

TEST_CASE("The same seed finds the same dials to the last byte") {
    const TempFolder one, two;
    fit_growth(jacksboro, {}, one / ".", {});
    fit_growth(jacksboro, {}, two / ".", {});
    for (const char* file : {"fit.json", "fit.csv", "growth.toml", "basin.gpkg"}) {
        CHECK(text_of(one / file) == text_of(two / file));
    }
}

TEST_CASE("A folder that was analyzed is measured with its own channels") {
    const TempFolder measured, fitted;
    MeasureOptions options;
    options.channel_area_m2 = 1e6;
    analyze(read_dem(jacksboro, {}, {}), options, measured / ".", {});
    const Json fit = Json::parse(fit_growth(measured / ".", {}, fitted / ".", {}));
    CHECK(fit["measures"]["channel_area_m2"] == 1e6);
    CHECK(fit["measured_on"] == "analyze folder");
    GrowthFitOptions asked;
    asked.measure.channel_area_m2 = 2e6;
    CHECK_THROWS_AS(fit_growth(measured / ".", asked, fitted / ".", {}), Error);
}
