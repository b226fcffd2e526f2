// SPDX-License-Identifier: GPL-3.0-or-later
// The commands' work from end to end, on small landscapes with known parameters.
#include <catch2/catch.hpp>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>

#include "support/temp_folder.hpp"
#include "thalweg/core/parallel.hpp"
#include "thalweg/study/compare.hpp"
#include "thalweg/study/fit.hpp"
#include "thalweg/study/run.hpp"
#include "thalweg/study/simulate.hpp"

using namespace thalweg;
using namespace thalweg::study;
using test::bytes_of;
using test::error_of;
using test::TempFolder;
using Json = nlohmann::json;

namespace {

const std::filesystem::path jacksboro = THALWEG_SOURCE_DIR "/validation/data/jacksboro.tif";

Experiment island(MeshKind mesh, double n, double m, Index nodes = 4000) {
    Experiment e;
    e.domain.size_m = {20000, 16000};
    e.domain.nodes = nodes;
    e.domain.mesh = mesh;
    e.uplift.rate_m_per_yr = 5e-4;
    e.river.k = n == 1 ? 2e-5 : 6e-6;
    e.river.m = m;
    e.river.n = n;
    e.time.solver = Solver::steady;
    return e;
}

Json simulated(const Experiment& e, const std::filesystem::path& folder) {
    std::filesystem::create_directories(folder);
    return Json::parse(simulate(e, folder, {}));
}

Json fitted(const std::filesystem::path& target, const std::filesystem::path& folder, double n, FitFrom from) {
    FitOptions options;
    options.fit.n = n;
    options.fit.uplift_m_per_yr = 5e-4;
    options.from = from;
    if (from == FitFrom::raster) options.measure.edge_basins = terrain::EdgeBasins::keep;
    std::filesystem::create_directories(folder);
    return Json::parse(fit(target, options, folder, {}).json);
}

double k_ratio(const Json& fit, const Experiment& e) {
    const double area = 3e6;
    const double k_at_area = fit["k_at_reference_area"].get<double>() *
                             std::pow(area / fit["reference_area_m2"].get<double>(), fit["m"].get<double>());
    return k_at_area / (*e.river.k * std::pow(area, *e.river.m));
}

std::vector<std::string> null_paths(const Json& json, const std::string& at = "") {
    std::vector<std::string> found;
    if (json.is_null()) found.push_back(at);
    if (!json.is_structured()) return found;
    for (const auto& [key, value] : json.items()) {
        for (const std::string& path : null_paths(value, at + "/" + key)) found.push_back(path);
    }
    return found;
}

}  // namespace

TEST_CASE("A steady landscape fitted on its nodes gives back k and m") {
    const TempFolder temp;
    for (const MeshKind mesh : {MeshKind::tin, MeshKind::raster}) {
        for (const double n : {1.0, 1.5}) {
            const Experiment e = island(mesh, n, 0.45 * n);
            const std::string name = std::to_string(static_cast<int>(mesh)) + std::to_string(n);
            simulated(e, temp / name);
            const Json f = fitted(temp / name, temp / (name + "fit"), n, FitFrom::nodes);
            CHECK(f["m"].get<double>() == Approx(0.45 * n).margin(1e-3));
            CHECK(k_ratio(f, e) == Approx(1).margin(0.01));
        }
    }
}

TEST_CASE("A landscape of divided flow fitted on its nodes gives back k and m") {
    const TempFolder temp;
    for (const MeshKind mesh : {MeshKind::tin, MeshKind::raster}) {
        Experiment e = island(mesh, 1.2, 0.5, 2000);
        e.river.flow = evolve::Flow::multiple;
        e.river.flow_exponent = 1.5;
        e.time.solver = Solver::implicit;
        e.time.step_yr = 2e5;
        e.time.convergence = 1e-6;
        const std::string name = std::to_string(static_cast<int>(mesh));
        const Json summary = simulated(e, temp / name);
        CHECK(summary["terrain"]["routing"] == "multiple");
        CHECK(std::abs(summary["mass_balance"]["relative_residual"].get<double>()) < 1e-9);
        CHECK(summary["terrain"]["channels"]["links"].get<int>() > 20);
        const Json f = fitted(temp / name, temp / (name + "fit"), 1.2, FitFrom::nodes);
        CHECK(f["m"].get<double>() == Approx(0.5).margin(1e-3));
        CHECK(k_ratio(f, e) == Approx(1).margin(0.01));
    }
    Experiment steady = island(MeshKind::raster, 1, 0.5, 400);
    steady.river.flow = evolve::Flow::multiple;
    CHECK(error_of([&] { simulated(steady, temp / "steady"); }).find("implicit") != std::string::npos);
}

TEST_CASE("A steady landscape shows its concavity and steepness in chi, on its nodes and as a DEM") {
    const TempFolder temp;
    for (const MeshKind mesh : {MeshKind::tin, MeshKind::raster}) {
        const Experiment e = island(mesh, 1, 0.45, 20000);
        const std::string name = std::to_string(static_cast<int>(mesh));
        const Json on_nodes = simulated(e, temp / name)["terrain"]["chi"];
        CHECK(on_nodes["ksn_median"].get<double>() == Approx(25).epsilon(1e-6));
        CHECK(on_nodes["theta_best"].get<double>() == Approx(0.45).margin(0.002));
        CHECK(on_nodes["theta_best_se"].get<double>() < 0.002);
        const Raster elevation = read_dem(temp / (name + "/elevation.tif"), {}, {}).raster;
        MeasureOptions options;
        options.edge_basins = terrain::EdgeBasins::keep;
        const ChiStatistics on_raster = measure_raster(elevation, options).statistics.chi;
        INFO(name << " ksn " << on_raster.ksn_median << " theta " << on_raster.concavity.linearity.value);
        const bool same_cells = mesh == MeshKind::raster;
        CHECK(on_raster.ksn_median == Approx(25).epsilon(same_cells ? 0.02 : 0.15));
        CHECK(on_raster.concavity.linearity.value == Approx(0.45).margin(same_cells ? 0.01 : 0.05));
    }
}

TEST_CASE("The elevations of a raster run, measured like any DEM, give m within 0.02 and k within a tenth") {
    const TempFolder temp;
    for (const double n : {1.0, 1.5}) {
        Experiment e = island(MeshKind::raster, n, 0.45 * n, 40000);
        const std::string name = std::to_string(n);
        simulated(e, temp / name);
        std::filesystem::copy_file(temp / (name + "/elevation.tif"), temp / (name + ".tif"));
        const Json f = fitted(temp / (name + ".tif"), temp / (name + "fit"), n, FitFrom::raster);
        INFO("n " << n << " m " << f["m"] << " k " << k_ratio(f, e));
        CHECK(f["m"].get<double>() == Approx(0.45 * n).margin(0.02));
        CHECK(k_ratio(f, e) == Approx(1).margin(0.1));
    }
}

TEST_CASE("A simulation's summary adds up and is the same for one thread and for two") {
    const TempFolder temp;
    for (const MeshKind mesh : {MeshKind::tin, MeshKind::raster}) {
        Experiment e = island(mesh, 1, 0.4);
        e.time.solver = Solver::implicit;
        e.time.max_steps = 30;
        e.hillslope.talus_angle_deg = 20;
        const std::string name = std::to_string(static_cast<int>(mesh));
        for (const int threads : {1, 2}) {
            const ThreadLimit limit(threads);
            const Json s = simulated(e, temp / (name + std::to_string(threads)));
            CHECK(s["cell_area_sum_m2"].get<double>() == Approx(20000.0 * 16000).epsilon(1e-9));
            CHECK(s["domain_area_m2"] == 20000.0 * 16000);
            CHECK(std::abs(s["mass_balance"]["relative_residual"].get<double>()) < 1e-9);
            CHECK(s["mass_balance"]["talus_m3"].get<double>() > 0);
            CHECK(s["steps"] == 30);
            CHECK(s["nodes"].get<double>() == Approx(4000).epsilon(0.02));
        }
        for (const char* file : {"elevation.tif", "drainage_area.tif", "network.gpkg", "slope_area_nodes.csv",
                                 "slope_area.csv", "hypsometry.csv", "chi.csv", "links.csv", "experiment.toml"}) {
            INFO(file);
            CHECK(bytes_of(temp / (name + "1/" + file)) == bytes_of(temp / (name + "2/" + file)));
        }
    }
}

TEST_CASE("Nothing in a summary is null without a reason in the notes") {
    const TempFolder temp;
    const Json simulation = simulated(island(MeshKind::tin, 1, 0.5, 1000), temp / "s");
    for (const std::string& path : null_paths(simulation)) {
        const std::string first = path.substr(1, path.find('/', 1) - 1);
        const bool terrain = first == "terrain";
        const std::string key = terrain ? path.substr(9, path.find('/', 9) - 9) : first;
        INFO(path);
        bool explained = false;
        for (const auto& note : simulation["notes"]) {
            explained = explained || note.get<std::string>().find(key.substr(0, 4)) != std::string::npos;
        }
        // The steady solver's rates are explained together.
        CHECK((explained || key.find("rate") != std::string::npos));
    }
}

TEST_CASE("Notes speak of what was asked for, and of channels that begin within a few cells") {
    const TempFolder temp;
    const NamedRaster dem = read_dem(jacksboro, {}, {});
    const auto notes = [&](double cells) {
        MeasureOptions options;
        options.channel_area_m2 = cells * 959.5036e6 / (344 * 403);
        std::filesystem::create_directories(temp / "a");
        return Json::parse(analyze(dem, options, temp / "a", {}))["notes"].dump();
    };
    CHECK(notes(100).find("drop_analysis") == std::string::npos);
    CHECK(notes(100).find("cells come together") == std::string::npos);
    CHECK(notes(100).find("ingest:") == std::string::npos);  // no hints is no null
    CHECK(notes(5).find("begin where 5 cells come together") != std::string::npos);
}

TEST_CASE("A study of the embedded DEM runs from measuring to comparing") {
    const TempFolder temp;
    Experiment e = read_experiment(THALWEG_SOURCE_DIR "/validation/jacksboro.toml");
    std::vector<std::string> told, reports;
    const Messages messages{.progress = [&](const std::string& text) { told.push_back(text); },
                            .warning = [](const std::string&) {},
                            .report = [&](const std::string& text) { reports.push_back(text); }};
    const Json manifest = Json::parse(run_study(e, Figures::leave_out, temp / "", messages));
    const auto read = [&](const char* name) { return Json::parse(bytes_of(temp / name)); };

    // Of the box around the catchment only what has data is simulated.
    const std::string nodes = read("simulate/summary.json")["nodes"].dump();
    CHECK(std::ranges::count(told, "simulating " + nodes + " nodes") == 1);
    REQUIRE(reports.size() == 4);
    CHECK(reports[0].starts_with("whole DEM: jacksboro.tif: "));
    CHECK(reports[1].starts_with("its basin: jacksboro.tif: "));
    CHECK(reports[3].starts_with("synthetic: elevation.tif: "));
    CHECK(manifest["notes"] == Json::array());
    CHECK(bytes_of(temp / "experiment.toml").starts_with("# k and m as fitted: simulate/experiment.toml\nseed = "));

    // 344 x 403 cells of 3 seconds: the area from GeographicLib's polygon of the extent.
    const Json measured = read("measure/summary.json");
    CHECK(measured["input"]["geographic"] == true);
    CHECK(measured["input"]["area_m2"].get<double>() == Approx(959.5036e6).epsilon(1e-5));
    CHECK(measured["channels"]["share_used"].get<double>() > 0.7);

    const Json basin = read("basin/summary.json"), synthetic = read("synthetic/summary.json");
    CHECK(basin["basins"].size() == 1);
    CHECK(basin["input"]["valid_cells"] == synthetic["input"]["valid_cells"]);
    CHECK(basin["basins"][0]["area_m2"].get<double>() == measured["basins"][0]["area_m2"].get<double>());
    CHECK(basin["channels"]["threshold_area_m2"] == synthetic["channels"]["threshold_area_m2"]);
    CHECK(synthetic["conditioning"]["pits"] == 0);

    // The synthetic landscape obeys the law that was fitted to the real one.
    const Json fit = read("fit/fit.json");
    CHECK(synthetic["slope_area"]["theta"].get<double>() == Approx(fit["theta"].get<double>()).margin(0.01));
    const Json comparison = read("compare/comparison.json");
    CHECK(comparison["aspects"].size() == 11);
    CHECK(manifest["outputs"].size() > 20);
}

TEST_CASE("Comparing is symmetrical, and a terrain does not differ from itself") {
    const TempFolder temp;
    Experiment e = island(MeshKind::raster, 1, 0.5, 10000);
    simulated(e, temp / "a");
    e.seed = 2;
    simulated(e, temp / "b");
    const auto compared = [&](const char* a, const char* b, const char* out) {
        std::filesystem::create_directory(temp / out);
        CompareOptions options;
        options.measure.edge_basins = terrain::EdgeBasins::keep;
        return Json::parse(compare(temp / a, temp / b, options, temp / out, {}));
    };
    const Json ab = compared("a", "b", "ab"), ba = compared("b", "a", "ba"), aa = compared("a", "a", "aa");
    REQUIRE(ab["aspects"].size() == 11);
    for (std::size_t i = 0; i < 11; ++i) {
        INFO(ab["aspects"][i]["name"]);
        REQUIRE(ab["aspects"][i]["distance"].is_number());
        CHECK(ab["aspects"][i]["distance"].get<double>() == Approx(ba["aspects"][i]["distance"].get<double>()));
        CHECK(ab["aspects"][i]["distance"].get<double>() > 0);
        CHECK(aa["aspects"][i]["distance"].get<double>() == 0);
    }
}

TEST_CASE("On the outline of a DEM's basin all water leaves by its one outlet, on a raster and on a TIN") {
    const TempFolder temp;
    for (const MeshKind mesh : {MeshKind::tin, MeshKind::raster}) {
        Experiment e = island(mesh, 1, 0.45);
        e.domain.size_m.clear();
        e.domain.nodes = mesh == MeshKind::tin ? std::optional<Index>(3000) : std::nullopt;
        e.domain.dem = jacksboro;
        const Json s = simulated(e, temp / (mesh == MeshKind::tin ? "tin" : "raster"));
        CHECK(s["terrain"]["channels"]["outlets"] == 1);
        CHECK(s["terrain"]["basins"].size() == 1);
        CHECK(s["terrain"]["basins"][0]["area_m2"].get<double>() ==
              Approx(s["domain_area_m2"].get<double>()).epsilon(1e-9));
        // The outlines differ by the corners of cells only.
        CHECK(s["domain_area_m2"].get<double>() == Approx(152.0766e6).epsilon(0.01));
    }
}

TEST_CASE("A DEM may be the start of a simulation") {
    const TempFolder temp;
    for (const MeshKind mesh : {MeshKind::tin, MeshKind::raster}) {
        Experiment e = island(mesh, 1, 0.45);
        e.domain.size_m.clear();
        e.domain.nodes = mesh == MeshKind::tin ? std::optional<Index>(3000) : std::nullopt;
        e.domain.dem = jacksboro;
        e.domain.initial = InitialSurface::dem;
        e.time.solver = Solver::implicit;
        e.time.step_yr = 1e-3;
        e.time.max_steps = 1;
        const Json s = simulated(e, temp / (mesh == MeshKind::tin ? "tin" : "raster"));
        CHECK(s["elevation_mean_m"].get<double>() == Approx(479.2).epsilon(0.02));
    }
}

TEST_CASE("The provenance beside a DEM is cited if it is about that very file") {
    const TempFolder temp;
    std::vector<std::string> warnings;
    const auto origin = [&](const std::string& json) {
        temp.text("dem.tif.json", json);
        return origin_of(temp / "dem.tif", "abc", warnings);
    };
    CHECK_FALSE(origin_of(temp / "dem.tif", "abc", warnings));
    CHECK_FALSE(origin("not JSON"));
    CHECK_FALSE(origin("[1, 2]"));
    CHECK_FALSE(origin(R"({"licence": "somebody else's file"})"));
    CHECK(warnings.empty());
    const auto found = origin(R"({"sha256": "abc", "data": "SRTM", "licence": "public domain", "citation": 3})");
    REQUIRE(found);
    CHECK(found->title == "SRTM");
    CHECK(found->licence == "public domain");
    CHECK(found->citation.empty());
    CHECK_FALSE(origin(R"({"sha256": "abd", "data": "SRTM"})"));
    CHECK(warnings.size() == 1);
}

TEST_CASE("Experiments that contradict themselves are refused with a sentence") {
    const TempFolder temp;
    const auto refusal = [&](auto change) {
        Experiment e = island(MeshKind::tin, 1, 0.5, 1000);
        change(e);
        return error_of([&] { simulate(e, temp / "", {}); });
    };
    CHECK(refusal([](Experiment& e) { e.river.k.reset(); }).find("river.k") != std::string::npos);
    CHECK(refusal([](Experiment& e) { e.river.m.reset(); }).find("river.m") != std::string::npos);
    CHECK(refusal([](Experiment& e) { e.domain.size_m.clear(); }).find("domain.size_m") != std::string::npos);
    CHECK(refusal([](Experiment& e) { e.domain.nodes.reset(); }).find("domain.nodes") != std::string::npos);
    CHECK(refusal([](Experiment& e) { e.domain.spacing_m = 100; }).find("one of them") != std::string::npos);
    CHECK(refusal([](Experiment& e) {
              e.domain.dem = "x.tif";
              e.domain.size_m.clear();
          }).find("x.tif") != std::string::npos);
    CHECK(refusal([](Experiment& e) { e.outlets = Outlets{OutletRule::dem}; }).find("domain.dem") != std::string::npos);
    CHECK(refusal([](Experiment& e) {
              e.domain.mesh = MeshKind::raster;
              e.domain.nodes = 16;
              e.domain.size_m = {1, 1000};
          }).find("whole rows") != std::string::npos);
    Experiment study;
    CHECK(error_of([&] { run_study(study, Figures::leave_out, temp / "", {}); }).find("study.dem") !=
          std::string::npos);
    study.study.source = "copernicus-glo90";
    CHECK(error_of([&] { run_study(study, Figures::leave_out, temp / "", {}); }).find("study.bbox") !=
          std::string::npos);
    study.study.dem = jacksboro;
    CHECK(error_of([&] { run_study(study, Figures::leave_out, temp / "", {}); }).find("exclude") != std::string::npos);
    study.study.source.reset();
    CHECK(error_of([&] { run_study(study, Figures::leave_out, temp / "", {}); }).find("uplift") != std::string::npos);
}

TEST_CASE("A study by growth alone needs no uplift rate, and its grown terrain lies in the studied basin") {
    const TempFolder folder;
    Experiment e;
    e.study.dem = std::filesystem::path(THALWEG_SOURCE_DIR) / "validation/data/jacksboro.tif";
    CHECK_THROWS_AS(run_study(e, Figures::leave_out, folder / "", {}), Error);
    e.study.models = {StudyModel::growth};
    e.growth.dials.upstream_link = grow::UpstreamLink::turns;
    std::vector<std::string> warnings, reports;
    const Messages messages{.warning = [&](const std::string& text) { warnings.push_back(text); },
                            .report = [&](const std::string& text) { reports.push_back(text); }};
    const Json manifest = Json::parse(run_study(e, Figures::leave_out, folder / "", messages));
    CHECK(reports.back().starts_with("grown: elevation.tif: "));
    CHECK(bytes_of(folder / "experiment.toml")
              .starts_with("# The dials of growth as fitted: grow/experiment.toml\nseed = "));
    for (const std::string& warning : warnings) {
        if (warning.starts_with("the grown relief")) CHECK(manifest["notes"] == Json{warning});
    }
    CHECK(manifest["steps"] == Json{"measure", "basin", "growth_fit", "grow", "grown", "compare_grown"});
    const auto read = [&](const char* file) {
        std::ifstream stream(folder / file);
        return Json::parse(stream);
    };
    // The dials were found by the rules that the network then grew by.
    for (const char* file : {"growth_fit/growth.toml", "grow/experiment.toml"}) {
        CHECK(read_experiment(folder / file).growth.dials.upstream_link == grow::UpstreamLink::turns);
    }
    const Json basin = read("basin/summary.json"), grown = read("grown/summary.json");
    const auto number = [](const Json& summary, const char* path) {
        return summary[Json::json_pointer(path)].get<double>();
    };
    CHECK(number(grown, "/input/area_m2") == Approx(number(basin, "/input/area_m2")).epsilon(0.01));
    CHECK(number(grown, "/input/dx_m") * number(grown, "/input/dy_m") ==
          Approx(number(basin, "/input/dx_m") * number(basin, "/input/dy_m")).epsilon(0.02));
    CHECK(number(grown, "/channels/threshold_area_m2") == number(basin, "/channels/threshold_area_m2"));
    CHECK(number(grown, "/channels/total_length_m") == Approx(number(basin, "/channels/total_length_m")).epsilon(0.25));
    CHECK(read("compare_grown/comparison.json")["aspects"].size() > 5);
    CHECK_FALSE(std::filesystem::exists(folder / "simulate"));
    for (const Json& output : manifest["outputs"]) CHECK(output["file"] != "grow/summary.json");
}
