// SPDX-License-Identifier: GPL-3.0-or-later
#include "thalweg/study/fit_growth.hpp"

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>

#include "support/temp_folder.hpp"
#include "thalweg/mesh/triangulate.hpp"
#include "thalweg/study/channel_heads.hpp"
#include "thalweg/study/compare.hpp"
#include "thalweg/study/fit.hpp"
#include "thalweg/study/grow.hpp"
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
    const GrowthSite own = growth_site(largest_complete_catchment(read_dem(jacksboro, {}, {}).raster, {}), dials_of(e));
    REQUIRE(site.basin.outline.size() == own.basin.outline.size());
    const double area = std::abs(mesh::polygon_area(own.basin.outline));
    CHECK(std::abs(mesh::polygon_area(site.basin.outline)) == Approx(area).epsilon(1e-9));
    CHECK(site.basin.outlet.x == Approx(own.basin.outlet.x).margin(0.01));
    CHECK(site.basin.source.y == Approx(own.basin.source.y).margin(0.01));
    REQUIRE(site.basin.bends.size() == own.basin.bends.size());
    CHECK(site.basin.bends.size() > 3);
    for (std::size_t i = 0; i < site.basin.bends.size(); ++i) {
        CHECK(site.basin.bends[i].x == Approx(own.basin.bends[i].x).margin(1e-6));
        CHECK(site.basin.bends[i].y == Approx(own.basin.bends[i].y).margin(1e-6));
    }
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
    for (const char* key : {"k", "m", "theta", "ks"}) CHECK(fit[key].is_null());
    CHECK(fit["reduced_chi2"].get<double>() > 0);
    CHECK(fit["iterations"] > 2);
    CHECK(fit["converged"] == true);
    CHECK(dials.sidewall_reach_m == estimate("sidewall_reach_m"));
    CHECK(dials.sidewall_reach_m <= fit["measures"]["farthest_ridges_m"].get<double>());
    CHECK(dials.divides == grow::Divides::shares);
    CHECK(dials.divide_above.mean == estimate("divide_above"));
    CHECK(dials.divide_across.delta == estimate("delta_divide_across"));
    CHECK(fit["notes"].size() > 1);
    const std::string written = text_of(folder / "growth.toml");
    CHECK(written.find("[growth]") != std::string::npos);
    CHECK(written.find("[river]") == std::string::npos);  // what grow does not read
    CHECK(site.warnings.empty());                         // all bends of a fitted trunk are kept
}

TEST_CASE("Terrain grown with the dials of a real catchment is as high and as hollow as that") {
    const TempFolder folder;
    fit_growth(jacksboro, {}, folder / "", {});
    Experiment e = read_experiment(folder / "growth.toml");
    const GrowthSite site = growth_site(e, {});
    e.output.resolution = 200;
    struct Shape {
        double relief, integral, lowest;
    };
    const auto shape = [](const Raster& raster) {
        double low = 1e9, high = -1e9, sum = 0, cells = 0;
        for (const double z : raster.values) {
            if (std::isnan(z)) continue;
            low = std::min(low, z);
            high = std::max(high, z);
            sum += z;
            ++cells;
        }
        return Shape{high - low, (sum / cells - low) / (high - low), low};
    };
    const Shape real = shape(largest_complete_catchment(read_dem(jacksboro, {}, {}).raster, {}).raster);
    CHECK(real.relief == Approx(692).margin(1));
    Shape grown{0, 0, 0};
    constexpr int seeds = 8;
    for (e.seed = 1; e.seed <= seeds; ++e.seed) {
        const Shape one = shape(grown_terrain(e, site, {}).elevation);
        Experiment straight = e;
        straight.growth.sidewall_reach_m.reset();
        CHECK(one.lowest > shape(grown_terrain(straight, site, {}).elevation).lowest - 2);  // benches do not sag
        grown.relief += one.relief / seeds;
        grown.integral += one.integral / seeds;
    }
    CHECK(grown.relief == Approx(real.relief).epsilon(0.3));
    CHECK(grown.integral == Approx(real.integral).margin(0.06));
}

namespace {

/// A grown folder, 435 links on 8 km, with its sources in network.gpkg.
fs::path grown_folder(const TempFolder& folder) {
    Experiment e;
    e.seed = 3;
    e.basin.outline = std::vector<Point>{{0, 0}, {8000, 0}, {8000, 8000}, {0, 8000}};
    e.basin.trunk = std::vector<Point>{{4000, 0}, {4000, 6000}};
    e.basin.base_level_m = 50;
    e.growth.channel_maintenance_m = 600;
    e.output.resolution = 500;
    fs::create_directory(folder / "grown");
    study::grow(e, folder / "grown", {});
    return folder / "grown";
}

}  // namespace

TEST_CASE("A grown folder with its own sources as heads is measured as it grew") {
    const TempFolder folder;
    const fs::path grown = grown_folder(folder);
    const Json tree = Json::parse(text_of(grown / "summary.json"));
    fs::create_directory(folder / "fit");
    GrowthFitOptions options;
    options.heads = grown / "network.gpkg";
    const Json fit = Json::parse(fit_growth(grown, options, folder / "fit", {}));
    CHECK(fit["growth"]["channel_maintenance_m"]["estimate"].get<double>() == Approx(600).epsilon(0.05));
    CHECK(fit["growth"]["flint_q"]["estimate"].get<double>() == Approx(-0.6).margin(0.05));
    CHECK(fit["growth"]["flint_p"]["estimate"].get<double>() == Approx(0.1).epsilon(0.15));
    const auto links = fit["measures"]["exterior_links"]["count"].get<double>() +
                       fit["measures"]["interior_links"]["count"].get<double>();
    CHECK(links == Approx(tree["links"].get<double>()).epsilon(0.05));
    CHECK(fit["measures"]["channel_area_m2"].is_null());
    const GrowthSite site = growth_site(read_experiment(folder / "fit" / "growth.toml"), {});
    CHECK(std::abs(mesh::polygon_area(site.basin.outline)) == Approx(6.4e7).epsilon(0.02));
    CHECK(site.basin.outlet.x == Approx(4000).margin(100));
    CHECK(site.basin.outlet.y == Approx(0).margin(40));
}

TEST_CASE("The slope-area fit and compare take a grown folder") {
    const TempFolder folder;
    const fs::path grown = grown_folder(folder);
    for (const char* name : {"fit", "same", "other"}) fs::create_directory(folder / name);
    const Json fitted = Json::parse(study::fit(grown, {}, folder / "fit", {}).json);
    // The terrain knows no erosion law, but Flint's gradients fall with magnitude as q, and areas grow with magnitude.
    CHECK(fitted["theta"].get<double>() > 0.1);
    CHECK(fitted["theta"].get<double>() < 0.9);
    const Json same = Json::parse(compare(grown, grown, {}, folder / "same", {}));
    std::size_t measured = 0;
    for (const Json& aspect : same["aspects"]) {
        if (!aspect["distance"].is_number()) continue;
        ++measured;
        CHECK(aspect["distance"].get<double>() == Approx(0).margin(1e-12));
    }
    CHECK(measured >= 8);
    const Json other = Json::parse(compare(grown, jacksboro, {}, folder / "other", {}));
    double sum = 0;
    for (const Json& aspect : other["aspects"]) {
        if (aspect["distance"].is_number()) sum += std::abs(aspect["distance"].get<double>());
    }
    CHECK(sum > 0.1);
}

TEST_CASE("An analyze folder whose channels begin at heads asks for them again") {
    const TempFolder folder;
    const fs::path grown = grown_folder(folder);
    fs::create_directory(folder / "measured");
    fs::create_directory(folder / "fit");
    const NamedRaster dem = read_dem(grown / "elevation.tif", {}, {});
    MeasureOptions options;
    options.channels = ChannelRule::heads;
    options.heads = read_channel_heads(grown / "network.gpkg", dem.raster, {});
    analyze(dem, options, folder / "measured", {});
    const std::string error = test::error_of([&] { fit_growth(folder / "measured", {}, folder / "fit", {}); });
    CHECK(error.find("--heads") != std::string::npos);
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
