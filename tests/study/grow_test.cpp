// SPDX-License-Identifier: GPL-3.0-or-later
#include "thalweg/study/grow.hpp"

#include <catch2/catch.hpp>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <iterator>
#include <nlohmann/json.hpp>

#include "study/grown_outputs.hpp"
#include "support/temp_folder.hpp"
#include "thalweg/core/parallel.hpp"
#include "thalweg/core/random.hpp"
#include "thalweg/grow/elevations.hpp"
#include "thalweg/io/raster_file.hpp"
#include "thalweg/io/vector_file.hpp"
#include "thalweg/study/output_folder.hpp"
#include "thalweg/study/simulate.hpp"
#include "thalweg/study/tables.hpp"
#include "thalweg/study/tree_statistics.hpp"
#include "thalweg/surface/roughness.hpp"

using namespace thalweg;
using namespace thalweg::study;
using test::error_of;
using test::TempFolder;

namespace {

Experiment small_growth() {
    Experiment e;
    e.seed = 7;
    e.basin.outline =
        std::vector<Point>{{0, 0}, {8000, 500}, {12000, 6000}, {7000, 11000}, {1000, 9000}, {-2000, 4000}};
    e.basin.trunk = std::vector<Point>{{0, 0}, {6500, 8500}};
    e.basin.base_level_m = 100;
    e.growth.channel_maintenance_m = 700;
    e.growth.dials.upstream_link = grow::UpstreamLink::turns;
    e.output.resolution = 200;
    return e;
}

GrownTerrain grown(const Experiment& e) { return grown_terrain(e, growth_site(e, Messages{}), Messages{}); }

Json without_seconds(Json summary) {
    summary.erase("seconds");
    return summary;
}

double highest(const Raster& raster) {
    double most = -1e300;
    for (const double z : raster.values) {
        if (!std::isnan(z)) most = std::max(most, z);
    }
    return most;
}

}  // namespace

TEST_CASE("What is grown is written whole, and its summary holds tree and terrain side by side") {
    const TempFolder folder;
    Experiment e = small_growth();
    e.output.mesh_file = MeshFile::ply;
    e.growth.channel_width_m = 5;
    std::filesystem::create_directory(folder / "out");
    const Json s = Json::parse(study::grow(e, folder / "out", Messages{}));
    CHECK(s["links"] == 2 * s["max_shreve"].get<int>() - 1);
    CHECK(s["polygon_area_sum_m2"].get<double>() == Approx(s["basin_area_m2"].get<double>()).epsilon(1e-9));
    CHECK(s["drainage_density_per_m"].get<double>() == Approx(1 / 700.0).epsilon(0.01));
    CHECK(s["tree"]["channels"]["links"] == s["links"]);
    CHECK(s["tree"]["flint_links"]["q"].get<double>() == Approx(-0.6).epsilon(1e-6));
    CHECK(s["tree"]["flint_links"]["p"].get<double>() == Approx(0.1).epsilon(1e-6));
    CHECK(s["tree"]["strahler"][0]["streams"] == s["max_shreve"]);
    CHECK(s["tree"]["hack"]["exponent"].get<double>() > 0.4);
    CHECK(s["terrain"]["measured_on"] == "raster");
    CHECK(s["terrain"]["channels"]["total_length_m"].get<double>() ==
          Approx(s["total_length_m"].get<double>()).epsilon(0.01));
    CHECK(s["terrain"]["channels"]["outlets"] == 1);
    CHECK(s["terrain"]["input"]["area_m2"].get<double>() == Approx(1.03e8).epsilon(1e-3));
    CHECK(s["recovery"]["by_heads"]["recovered_share"].get<double>() >= 0.95);
    CHECK(s["meshes"].size() == 2);
    for (const char* file : {"elevation.tif", "network.gpkg", "mesh.obj", "mesh.ply", "links.csv", "slope_area.csv",
                             "hypsometry.csv", "summary.json", "experiment.toml"}) {
        CHECK(std::filesystem::is_regular_file(folder / "out" / file));
    }
    const auto shapes = io::read_vectors(folder / "out" / "network.gpkg", {.layers = {"links"}, .crs_wkt = {}});
    CHECK(shapes.lines.size() == s["links"].get<std::size_t>());
    const auto polygons = io::read_vectors(folder / "out" / "network.gpkg", {.layers = {"polygons"}, .crs_wkt = {}});
    CHECK(polygons.polygons.size() == 2 * s["links"].get<std::size_t>());
    const auto sources = io::read_vectors(folder / "out" / "network.gpkg", {.layers = {"sources"}, .crs_wkt = {}});
    CHECK(sources.points.size() == s["max_shreve"].get<std::size_t>());
    const Experiment again = read_experiment(folder / "out" / "experiment.toml");
    CHECK(to_toml(again) == to_toml(e));
}

TEST_CASE("The same experiment grows the same terrain to the last bit, whatever the threads") {
    Experiment e = small_growth();
    e.growth.roughness_m = 3;
    e.growth.roughness_kind = GENERATE(RoughnessKind::noise, RoughnessKind::subdivision);
    const TempFolder folder;
    std::vector<Json> summaries;
    std::vector<std::vector<double>> heights;
    for (const int threads : {1, 2}) {
        const ThreadLimit limit(threads);
        const auto out = folder / std::to_string(threads);
        std::filesystem::create_directory(out);
        summaries.push_back(without_seconds(Json::parse(study::grow(e, out, Messages{}))));
        heights.push_back(io::read_raster(out / "elevation.tif").raster.values);
    }
    CHECK(summaries[0] == summaries[1]);
    for (std::size_t i = 0; i < heights[0].size(); ++i) {
        const bool both_outside = std::isnan(heights[0][i]) && std::isnan(heights[1][i]);
        REQUIRE((both_outside || heights[0][i] == heights[1][i]));
    }
    CHECK(read_text(folder / "1" / "network.gpkg") == read_text(folder / "2" / "network.gpkg"));
    CHECK(read_text(folder / "1" / "mesh.obj") == read_text(folder / "2" / "mesh.obj"));
    e.seed = 8;
    CHECK(grown(e).growth.network.size() != summaries[0]["links"].get<Index>());
}

TEST_CASE("A terrain goes through its vertices, ends at the outline, and stands where the map says") {
    Experiment e = small_growth();
    const GrownTerrain plain = grown(e);
    const grow::SurfaceMesh& mesh = plain.surface.mesh;
    CHECK(highest(plain.elevation) < 1.1 * *std::max_element(mesh.height.begin(), mesh.height.end()));
    std::size_t inside = 0;
    for (const double z : plain.elevation.values) {
        inside += !std::isnan(z);
        if (!std::isnan(z)) REQUIRE(z > 90);
    }
    const double cell = plain.elevation.grid.area(0);
    CHECK(inside * cell == Approx(1.03e8).epsilon(2e-3));
    auto& outline = std::get<std::vector<Point>>(*e.basin.outline);
    auto& trunk = std::get<std::vector<Point>>(*e.basin.trunk);
    for (auto* line : {&outline, &trunk}) {
        for (Point& p : *line) p = {p.x + 500000, p.y + 4000000};
    }
    const GrownTerrain moved = grown(e);
    CHECK(moved.elevation.placement.west == Approx(plain.elevation.placement.west + 500000));
    CHECK(moved.elevation.placement.north == Approx(plain.elevation.placement.north + 4000000));
    CHECK(moved.growth.network.size() == plain.growth.network.size());
}

TEST_CASE("Roughness leaves channels alone, extra tension and width change what they are about") {
    Experiment e = small_growth();
    const GrownTerrain plain = grown(e);
    const auto changed = [&](const Experiment& other) {
        const Raster& raster = grown(other).elevation;
        std::vector<double> change;
        for (std::size_t i = 0; i < raster.values.size(); ++i) {
            if (!std::isnan(raster.values[i])) change.push_back(std::abs(raster.values[i] - plain.elevation.values[i]));
        }
        return change;
    };
    Experiment rough = e;
    rough.growth.roughness_m = 5;
    const auto roughened = changed(rough);
    CHECK(quantile(roughened, 1) <= 5);
    CHECK(quantile(roughened, 0.5) > 0.05);
    CHECK(quantile(roughened, 0) < 0.01);
    Experiment tight = e;
    tight.growth.extra_tension_side = 50;
    CHECK(quantile(changed(tight), 0.9) > 0.1);
    tight.growth.extra_tension_side = 0;
    tight.growth.extra_tension_divide = 50;
    CHECK(quantile(changed(tight), 0.99) > 0.1);
    tight.growth.extra_tension_divide = 0;
    tight.growth.extra_tension_channel = 50;
    CHECK(quantile(changed(tight), 1) > 1e-3);
}

TEST_CASE("Fractal roughness displaces no channel, roughens valley sides as far up, and rivers stay where they are") {
    Experiment e = small_growth();
    e.output.resolution = 500;
    const GrownTerrain plain = grown(e);
    e.growth.roughness_m = 8;
    e.growth.roughness_kind = RoughnessKind::subdivision;
    const GrownTerrain rough = grown(e);
    const grow::SurfaceMesh& mesh = rough.surface.mesh;
    Mesh plane;
    plane.x = mesh.x;
    plane.y = mesh.y;
    plane.triangles = mesh.triangles;
    std::vector<double> share;
    for (const std::uint8_t channel : mesh.on_channel) share.push_back(1 - channel);
    std::vector<Point> along;
    for (const grow::Edge& line : mesh.lines) {
        if (line.kind != grow::EdgeKind::channel) continue;
        for (const double s : {0.1, 0.37, 0.5, 0.82}) {
            along.push_back({mesh.x[line.from] + s * (mesh.x[line.to] - mesh.x[line.from]),
                             mesh.y[line.from] + s * (mesh.y[line.to] - mesh.y[line.from])});
        }
    }
    REQUIRE(along.size() > 1000);
    for (const double z : surface::roughness_at(plane, share, {.amplitude_m = 8, .finest_m = 5}, along)) {
        REQUIRE(std::abs(z) < 1e-9);  // a place on a line is there to rounding
    }
    double squares = 0, cells = 0;
    for (std::size_t i = 0; i < rough.elevation.values.size(); ++i) {
        if (std::isnan(rough.elevation.values[i])) continue;
        squares += std::pow(rough.elevation.values[i] - plain.elevation.values[i], 2);
        ++cells;
    }
    const double rms = std::sqrt(squares / cells);
    CHECK(rms > 0.3);
    CHECK(rms < 4);
    MeasureOptions options = measure_options(rough);
    options.heads = grown_heads(rough);
    options.channels = ChannelRule::heads;
    const RasterMeasurement m = measure_raster(rough.elevation, options);
    std::vector<Point> junctions;
    for (const grow::Junction& j : rough.growth.network.junctions) {
        const Point& p = rough.growth.network.vertices[j.vertex];
        junctions.push_back({p.x + rough.growth.network.origin.x, p.y + rough.growth.network.origin.y});
    }
    const double cell = rough.elevation.placement.cell_width;
    const Recovery r = recovery(junctions, grow::total_length(rough.growth.network), m.statistics.network,
                                positions(rough.elevation), 2 * cell);
    CHECK(r.recovered >= 0.9 * r.grown);
    e.growth.roughness_finest_m = 1000;  // beyond the triangles' edges: nothing to divide
    CHECK(grown(e).elevation.values.size() == plain.elevation.values.size());
    double most = 0;
    const auto none_left = grown(e).elevation.values;
    for (std::size_t i = 0; i < none_left.size(); ++i) {
        if (!std::isnan(none_left[i])) most = std::max(most, std::abs(none_left[i] - plain.elevation.values[i]));
    }
    CHECK(most == 0);
}

TEST_CASE("The mesh is as rough as the raster, on channels and on valley sides") {
    Experiment e = small_growth();
    const GrownTerrain plain = grown(e);
    e.growth.roughness_m = 5;
    for (const RoughnessKind kind : {RoughnessKind::noise, RoughnessKind::subdivision}) {
        e.growth.roughness_kind = kind;
        const GrownTerrain rough = grown(e);
        Experiment smooth = e;
        smooth.growth.roughness_m = 0;
        const TriangleSurface with = triangles_of(e, rough), without = triangles_of(smooth, plain);
        REQUIRE(with.size() == without.size());
        const grow::SurfaceMesh& mesh = rough.surface.mesh;
        std::vector<double> sides;
        std::vector<Point> places;
        for (Index i = 0; i < with.size(); ++i) places.push_back({with.x[i], with.y[i]});
        const std::vector<double> expected = roughness_at(e, rough, places);
        for (Index i = 0; i < with.size(); ++i) {
            const double added = with.z[i] - without.z[i];
            REQUIRE(added == Approx(expected[i]).margin(1e-9));
            if (i >= mesh.size()) {
                sides.push_back(std::abs(added));
            } else if (mesh.on_channel[i]) {
                REQUIRE(std::abs(added) < 1e-9);
            }
        }
        CHECK(quantile(sides, 0.5) > 0.05);
        // What it adds is what the raster has, at a cell's centre as at any other place.
        std::vector<Point> centers;
        for (Index cell = 0; cell < rough.elevation.grid.size(); ++cell) {
            const Point p =
                rough.elevation.placement.center(rough.elevation.grid.row(cell), rough.elevation.grid.col(cell));
            centers.push_back({p.x - rough.site.basin.outlet.x, p.y - rough.site.basin.outlet.y});
        }
        const std::vector<double> at = roughness_at(e, rough, centers);
        for (Index cell = 0; cell < rough.elevation.grid.size(); ++cell) {
            if (std::isnan(rough.elevation.values[cell])) continue;
            REQUIRE(at[cell] == Approx(rough.elevation.values[cell] - plain.elevation.values[cell]).margin(1e-6));
        }
    }
}

TEST_CASE("Channels wider than their valley and sides flatter than their channel are counted and told") {
    const TempFolder folder;
    Experiment e = small_growth();
    std::vector<std::string> warnings;
    Messages messages;
    messages.warning = [&](const std::string& text) { warnings.push_back(text); };
    const auto warned = [&](const char* out, const char* what) {
        std::filesystem::create_directory(folder / out);
        warnings.clear();
        const Json s = Json::parse(study::grow(e, folder / out, messages));
        Index about = 0;
        for (const std::string& text : warnings) about += text.find(what) != std::string::npos;
        for (const std::string& text : warnings) CHECK(std::ranges::count(s["notes"], Json(text)) == 1);
        return std::pair{about, s["sides_flatter_than_channels"].get<Index>()};
    };
    e.growth.channel_width_m = 5;
    CHECK(warned("narrow", "channels' banks") == std::pair<Index, Index>{0, 0});
    e.growth.channel_width_m = 300;
    CHECK(warned("wide", "channels' banks").first == 1);
    e.growth.dials.flint.p = 0.45;  // between the tangents of 20° and 30°
    const auto [told, flat] = warned("steep", "less steep than their channel");
    const grow::Network& network = grown(e).growth.network;
    Index counted = 0;
    for (Index link = 0; link < network.size(); ++link) {
        const double gradient = 0.45 * std::pow(2.0 * network.magnitude[link] - 1, -0.6);
        counted += (network.sidewall_slope[link][0] < gradient) + (network.sidewall_slope[link][1] < gradient);
    }
    CHECK(told == 1);
    CHECK(flat == counted);
    CHECK(counted > 0);
}

TEST_CASE("Ground below the outlet is measured, and told where it is more than a hundredth of the relief") {
    const TempFolder folder;
    std::vector<std::string> warnings;
    Messages messages;
    messages.warning = [&](const std::string& text) { warnings.push_back(text); };
    const auto dip = [&](const char* out, const Experiment& e) {
        std::filesystem::create_directory(folder / out);
        warnings.clear();
        const Json s = Json::parse(study::grow(e, folder / out, messages));
        double lowest = *e.basin.base_level_m;
        for (const double z : grown(e).elevation.values) {
            if (z < lowest) lowest = z;
        }
        CHECK(s["dip_below_outlet_m"].get<double>() == *e.basin.base_level_m - lowest);
        return s["dip_below_outlet_m"].get<double>();
    };
    const auto told = [&] {
        return std::ranges::any_of(warnings, [](const std::string& w) { return w.find("below its outlet") != w.npos; });
    };
    Experiment e = small_growth();
    dip("even", e);
    CHECK(!told());
    // Ridges of very unlike heights beside each other.
    e.growth.dials.sidewall_angle_deg = 45;
    e.growth.dials.delta_sidewall_angle_deg = 43;
    e.growth.dials.flint.p = 0.02;
    const double loose = dip("unlike", e);
    CHECK(loose > 10);
    CHECK(told());
    e.growth.tension_ridge = 20;
    CHECK(dip("taut", e) < loose / 4);
}

TEST_CASE("Slopes of links keep their digits far above the sea") {
    Experiment e = small_growth();
    const GrownTerrain low = grown(e);
    e.basin.base_level_m = 1e9;
    const GrownTerrain high = grown(e);
    for (Index link = 0; link < low.tree.size(); ++link) {
        REQUIRE(high.tree.drop_m[link] == low.tree.drop_m[link]);
        const double slope = 0.1 * std::pow(2.0 * low.tree.shreve[link] - 1, -0.6);
        REQUIRE(low.tree.drop_m[link] == Approx(slope * low.tree.length_m[link]).epsilon(1e-14));
    }
}

TEST_CASE("What is found again is not told where cells are as coarse as links") {
    const TempFolder folder;
    Experiment e = small_growth();
    for (const Index cells : {12, 200}) {
        e.output.resolution = cells;
        const auto out = folder / std::to_string(cells);
        std::filesystem::create_directory(out);
        const Json s = Json::parse(study::grow(e, out, Messages{}));
        for (const char* by : {"by_area", "by_heads"}) {
            for (const char* key : {"recovered_share", "false_share", "length_ratio"}) {
                CHECK(s["recovery"][by][key].is_null() == (cells == 12));
            }
        }
        const bool explained = s["notes"].dump().find("two cells are longer than the median link") != std::string::npos;
        CHECK(explained == (cells == 12));
    }
}

TEST_CASE("A grown terrain is the start of a simulation on the same outline") {
    const TempFolder folder;
    std::filesystem::create_directory(folder / "growth");
    const Json growth = Json::parse(study::grow(small_growth(), folder / "growth", Messages{}));
    Experiment e;
    e.domain.outline = folder.text("outline.geojson",
                                   R"({"type": "Polygon", "coordinates":
            [[[0, 0], [8000, 500], [12000, 6000], [7000, 11000], [1000, 9000], [-2000, 4000], [0, 0]]]})");
    e.domain.nodes = 5000;
    e.initial.elevation = folder / "growth" / "elevation.tif";
    const Domain start = make_domain(e, Messages{});
    const Raster grown = io::read_raster(folder / "growth" / "elevation.tif").raster;
    std::size_t far = 0;
    for (std::size_t i = 0; i < start.positions_m.size(); ++i) {
        REQUIRE(std::isfinite(start.start.elevation_m[i]));
        const Index cell = cell_at(grown, start.positions_m[i]);
        if (cell == none || std::isnan(grown.values[cell])) continue;
        far += std::abs(grown.values[cell] - start.start.elevation_m[i]) > 25;  // half a cell of a valley side
    }
    CHECK(far < start.positions_m.size() / 50);
    e.uplift.rate_m_per_yr = 0;
    e.river.k = 2e-6;
    e.river.m = 0.5;
    e.hillslope.diffusivity_m2_per_yr = 0.005;
    e.time.step_yr = 10000;
    e.time.max_steps = 5;
    e.time.convergence = 0;
    std::filesystem::create_directory(folder / "simulation");
    const Json worn = Json::parse(study::simulate(e, folder / "simulation", Messages{}));
    CHECK(worn["mass_balance"]["eroded_m3"].get<double>() > 0);
    CHECK(worn["elevation_mean_m"].get<double>() < growth["terrain"]["input"]["elevation_mean_m"].get<double>());
}

TEST_CASE("What cannot be grown is refused before anything is written") {
    const TempFolder folder;
    const auto refusal = [&](const Experiment& e) {
        return error_of([&] { study::grow(e, folder / "none", Messages{}); });
    };
    Experiment e = small_growth();
    e.growth.channel_maintenance_m.reset();
    CHECK_THAT(refusal(e), Catch::Contains("growth.channel_maintenance_m is needed"));
    e = small_growth();
    e.growth.channel_maintenance_m = 1e6;
    CHECK_THAT(refusal(e), Catch::Contains("trunk alone"));
    e = small_growth();
    e.growth.dials.flint.p = 0.6;  // sides are at most 30° steep
    CHECK_THAT(refusal(e), Catch::Contains("growth.flint_p is 0.6") && Catch::Contains("0.577"));
    e = small_growth();
    e.growth.dials.sidewall_angle_deg = 88;
    CHECK_THAT(refusal(e), Catch::Contains("sidewall_angle_deg"));
    e = small_growth();
    e.growth.sidewall_reach_m = -1;
    CHECK_THAT(refusal(e), Catch::Contains("sidewall_reach_m is -1: it must be above 0"));
    e = small_growth();
    e.output.base_depth_m = 3;
    CHECK_THAT(refusal(e), Catch::Contains("output.solid"));
    e = small_growth();
    e.basin.outline = std::vector<Point>{{0, 0}, {10000, 0}, {10000, 5}, {0, 5}};
    e.basin.trunk = std::vector<Point>{{0, 2.5}, {9000, 2.5}};
    e.growth.channel_maintenance_m = 3;
    CHECK_THAT(refusal(e),
               Catch::Contains("narrower (5 m) than a cell (50 m)") && Catch::Contains("resolution = 4001"));
    CHECK_FALSE(std::filesystem::exists(folder / "none"));
}

TEST_CASE("Recovery counts junctions as a comparison of all pairs does") {
    Random random(5, 2);
    for (int trial = 0; trial < 20; ++trial) {
        // Rivers side by side: three links that meet each, at random places.
        channel::StreamNetwork found;
        std::vector<Point> places, grown_at;
        found.offset.push_back(0);
        for (Index river = 0; river < 60; ++river) {
            const Index link = 3 * river, node = 4 * river;
            found.downstream.insert(found.downstream.end(), {none, link, link});
            for (const Index upper : {node + 1, node + 2, node + 3}) {
                found.nodes.insert(found.nodes.end(), {upper, upper == node + 1 ? node : node + 1});
                found.offset.push_back(static_cast<Index>(found.nodes.size()));
                found.length_m.push_back(2);
            }
            for (int i = 0; i < 4; ++i) places.push_back({100 * random.uniform() - 50, 100 * random.uniform() - 50});
        }
        for (int i = 0; i < 50; ++i) grown_at.push_back({100 * random.uniform() - 50, 100 * random.uniform() - 50});
        const Recovery r = recovery(
            grown_at, 7, found, [&](Index node) { return places[node]; }, 4);
        const auto near = [&](const Point& a, const Point& b) { return std::hypot(a.x - b.x, a.y - b.y) <= 4; };
        Index recovered = 0, unmatched = 0;
        for (const Point& p : grown_at) {
            bool any = false;
            for (Index river = 0; river < 60; ++river) any = any || near(p, places[4 * river + 1]);
            recovered += any;
        }
        for (Index river = 0; river < 60; ++river) {
            bool any = false;
            for (const Point& p : grown_at) any = any || near(p, places[4 * river + 1]);
            unmatched += !any;
        }
        CHECK(r.grown == 50);
        CHECK(r.found == 60);
        CHECK(r.recovered == recovered);
        CHECK(r.unmatched == unmatched);
        CHECK(r.found_length_m == 360);
        CHECK(r.tree_length_m == 7);
    }
}

TEST_CASE("Frames show the network from the trunk to the whole, and do not change it") {
    const TempFolder folder;
    Experiment e = small_growth();
    std::filesystem::create_directory(folder / "plain");
    std::filesystem::create_directory(folder / "shown");
    const Json plain = Json::parse(study::grow(e, folder / "plain", Messages{}));
    CHECK_FALSE(std::filesystem::exists(folder / "plain" / "frames"));
    e.output.frames = 6;
    const GrownTerrain t = grown(e);
    Json shown = Json::parse(study::grow(e, folder / "shown", Messages{}));
    const Json frames = shown["frames"];
    shown.erase("frames");
    CHECK(without_seconds(shown) == without_seconds(plain));
    REQUIRE(frames.size() == 6);
    REQUIRE(t.stages.size() == 6);
    CHECK(frames[0]["links"] == 1);
    CHECK(frames[5]["links"] == plain["links"]);
    CHECK(frames[5]["total_length_m"] == plain["total_length_m"]);
    const auto count = [](const std::string& text, const std::string& what) {
        std::size_t found = 0;
        for (auto at = text.find(what); at != std::string::npos; at = text.find(what, at + 1)) ++found;
        return found;
    };
    for (std::size_t i = 0; i < 6; ++i) {
        INFO("frame " << i);
        const std::size_t links = frames[i]["links"].get<std::size_t>();
        if (i > 0) CHECK(links > frames[i - 1]["links"].get<std::size_t>());
        CHECK(grow::total_area(t.stages[i]) == Approx(grow::total_area(t.growth.network)).epsilon(1e-9));
        std::ifstream file(folder / "shown" / frames[i]["file"].get<std::string>());
        const std::string svg(std::istreambuf_iterator<char>(file), {});
        CHECK(count(svg, "<polygon ") == 2 * links);
        CHECK(svg.rfind("</svg>") + 7 == svg.size());
        CHECK(count(svg, "#1f5f99") + count(svg, "#c8402f") == links);
        CHECK((count(svg, "#c8402f") > 0) == (i > 0));  // something is new in each but the first
    }
}

TEST_CASE("Frames of a network too large to be drawn are refused") {
    Experiment e = small_growth();
    e.growth.channel_maintenance_m = 30;  // some 180 000 links
    e.output.frames = 2;
    CHECK_THAT(error_of([&] { grown(e); }), Catch::Contains("output.frames") && Catch::Contains("100000 at most"));
}
