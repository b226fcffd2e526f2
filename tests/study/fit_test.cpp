// SPDX-License-Identifier: GPL-3.0-or-later
// What a simulation writes of its slopes, and what a fit reads of them.
#include "thalweg/study/fit.hpp"

#include <fmt/format.h>

#include <catch2/catch.hpp>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>
#include <numbers>
#include <numeric>

#include "support/temp_folder.hpp"
#include "thalweg/io/table_file.hpp"
#include "thalweg/study/run.hpp"
#include "thalweg/study/simulate.hpp"

using namespace thalweg;
using namespace thalweg::study;
using test::error_of;
using test::is_sentence;
using test::TempFolder;
using Json = nlohmann::json;

namespace {

constexpr double uplift = 5e-4;
const double steepest = std::tan(20 * std::numbers::pi / 180);

Experiment island(MeshKind mesh) {
    Experiment e;
    e.domain.size_m = {20000, 16000};
    e.domain.nodes = 3000;
    e.domain.mesh = mesh;
    e.uplift.rate_m_per_yr = uplift;
    e.river.k = 2e-6;
    e.river.m = 0.45;
    e.hillslope.talus_angle_deg = 20;
    e.time.solver = Solver::steady;
    return e;
}

const std::vector<double>& numbers(const Table& table, const std::string& name) {
    for (const Column& c : table.columns) {
        if (c.name == name) return std::get<std::vector<double>>(c.values);
    }
    throw std::out_of_range(name);
}

double sum(const std::vector<double>& values) { return std::accumulate(values.begin(), values.end(), 0.0); }

Json simulated(const Experiment& e, const std::filesystem::path& folder) {
    std::filesystem::create_directories(folder);
    return Json::parse(simulate(e, folder, {}));
}

Json fitted(const std::filesystem::path& target, const std::filesystem::path& folder, const FitOptions& options) {
    std::filesystem::create_directories(folder);
    return Json::parse(fit(target, options, folder, {}).json);
}

}  // namespace

TEST_CASE("Nodes at the talus angle are flagged, stand at its tangent and enter no slope-area bin") {
    const TempFolder temp;
    for (const MeshKind mesh : {MeshKind::tin, MeshKind::raster}) {
        const Experiment e = island(mesh);
        const Json s = simulated(e, temp / (mesh == MeshKind::tin ? "tin" : "raster"));
        const std::filesystem::path folder = temp / (mesh == MeshKind::tin ? "tin" : "raster");
        const Table nodes = io::read_csv(folder / "slope_area_nodes.csv");
        const auto &area = numbers(nodes, "area_m2"), &slope = numbers(nodes, "slope");
        const auto& limited = numbers(nodes, "talus_limited");
        const double all = static_cast<double>(area.size()), flagged = sum(limited);
        CHECK(flagged > 100);
        CHECK(all - flagged > 100);
        Index wrong = 0;
        for (std::size_t i = 0; i < area.size(); ++i) {
            const double law = uplift / *e.river.k * std::pow(area[i], -e.river.m.value());
            const bool at_limit = law > steepest;
            wrong += at_limit != (limited[i] == 1);
            wrong += std::abs(slope[i] / std::min(law, steepest) - 1) > 1e-6;
        }
        // Frozen receivers and what lies upstream of them may be off; there are few.
        CHECK(wrong <= 2 * s["frozen_receivers"].get<Index>());
        CHECK(*std::max_element(slope.begin(), slope.end()) == Approx(steepest).epsilon(1e-9));
        CHECK(sum(numbers(io::read_csv(folder / "slope_area.csv"), "count")) == all - flagged);
        double bins = 0;
        for (const Json& bin : s["terrain"]["slope_area"]["bins"]) bins += bin["count"].get<double>();
        CHECK(bins == all - flagged);
    }
}

TEST_CASE("Nodes that do not fall to their receiver have no slope to be written or fitted") {
    const TempFolder temp;
    Experiment e = island(MeshKind::raster);
    e.initial.noise = NoiseKind::uniform;
    e.initial.amplitude_m = 10;
    e.time.solver = Solver::implicit;
    e.time.step_yr = 1;
    e.time.max_steps = 1;
    const Json s = simulated(e, temp / "out");
    REQUIRE(s["lakes_final"].get<int>() > 10);  // water leaves them uphill
    const Table nodes = io::read_csv(temp / "out/slope_area_nodes.csv");
    CHECK(numbers(nodes, "slope").size() < s["nodes"].get<std::size_t>());
    for (const double slope : numbers(nodes, "slope")) CHECK(slope > 0);
    for (const double area : numbers(nodes, "area_m2")) CHECK(area > 0);
}

TEST_CASE("A fit leaves out the nodes that the talus limit holds") {
    const TempFolder temp;
    simulated(island(MeshKind::raster), temp / "s");
    FitOptions options;
    options.fit.uplift_m_per_yr = uplift;
    const Json f = fitted(temp / "s", temp / "f", options);
    CHECK(f["measured_on"] == "nodes");
    CHECK(f["m"].get<double>() == Approx(0.45).margin(1e-3));
    const Table nodes = io::read_csv(temp / "s/slope_area_nodes.csv");
    const auto& limited = numbers(nodes, "talus_limited");
    CHECK(sum(numbers(io::read_csv(temp / "f/fit.csv"), "count")) ==
          static_cast<double>(limited.size()) - sum(limited));
}

TEST_CASE("A written table of nodes is fitted as it stands, without those flagged") {
    const TempFolder temp;
    std::filesystem::create_directory(temp / "s");
    std::string rows = "area_m2,slope,talus_limited\n";
    for (int i = 0; i < 60; ++i) {
        const double area = 1e3 * std::pow(10, 0.05 * i);
        rows += std::to_string(area) + "," + std::to_string(10 * std::pow(area, -0.4)) + ",0\n";
        rows += std::to_string(area) + ",0.7,1\n";
    }
    temp.text("s/slope_area_nodes.csv", rows);
    temp.text("s/summary.json", R"({"converged": true, "mean_rate_m_per_yr": 1e-9})");
    FitOptions options;
    options.fit.uplift_m_per_yr = 1e-3;
    const Json f = fitted(temp / "s", temp / "f", options);
    CHECK(f["theta"].get<double>() == Approx(0.4).margin(1e-4));
    CHECK(f["ks"].get<double>() == Approx(10).epsilon(1e-3));
    CHECK(f["k"].get<double>() == Approx(1e-4).epsilon(1e-3));
    CHECK(f["steady_check"]["converged"] == true);
    CHECK(f["steady_check"]["mean_rate_m_per_yr"] == 1e-9);
    temp.text("s/summary.json", "[]");
    CHECK(is_sentence(error_of([&] { fitted(temp / "s", temp / "g", options); })));
}

TEST_CASE("A simulation whose nodes are missing is not taken for a DEM that was analyzed") {
    const TempFolder temp;
    std::filesystem::create_directory(temp / "s");
    temp.text("s/slope_area.csv", "area_m2,slope,slope_se,count\n1e4,0.1,0.01,9\n1e5,0.05,0.01,9\n1e6,0.02,0.01,9\n");
    temp.text("s/summary.json", R"({"mass_balance": {}})");
    CHECK(error_of([&] { fitted(temp / "s", temp / "f", {}); }).find("slope_area_nodes.csv") != std::string::npos);
}

TEST_CASE("The fit of a study is that of its basin with the study's exponent, uplift and range of areas") {
    const TempFolder temp;
    Experiment land = island(MeshKind::raster);
    land.domain.nodes = 6400;
    land.hillslope.talus_angle_deg.reset();
    land.river.k = 2e-5;
    simulated(land, temp / "land");
    Experiment e;
    e.study.dem = temp / "land/elevation.tif";
    e.study.uplift_m_per_yr = uplift;
    e.study.uplift_sd_m_per_yr = 1e-4;
    e.study.channel_area_m2 = 2e5;
    e.study.area_min_m2 = 1e6;
    e.study.area_max_m2 = 1e7;
    e.river.n = 2;
    e.deposition.g = 0.5;
    e.study.realisations = 2;
    std::filesystem::create_directory(temp / "study");
    run_study(e, Figures::leave_out, temp / "study", {});
    const Json in_study = Json::parse(test::bytes_of(temp / "study/fit/fit.json"));

    FitOptions options;
    options.fit.n = 2;
    options.fit.deposition_g = 0.5;
    options.fit.uplift_m_per_yr = uplift;
    options.fit.uplift_sd_m_per_yr = 1e-4;
    options.fit.area_min_m2 = 1e6;
    options.fit.area_max_m2 = 1e7;
    const Json alone = fitted(temp / "study/basin", temp / "fit", options);
    CHECK(in_study == alone);
    CHECK(in_study["n"] == 2.0);
    CHECK(in_study["deposition_g"] == 0.5);
    CHECK(in_study["uplift_sd_m_per_yr"] == 1e-4);
    CHECK(in_study["area_range_m2"][0].get<double>() >= 1e6);
    CHECK(in_study["area_range_m2"][1].get<double>() <= 1e7);

    // Two realisations have one distance.
    const Json comparison = Json::parse(test::bytes_of(temp / "study/compare/comparison.json"));
    CHECK(comparison["aspects"][1]["scale"].get<double>() > 0);
    CHECK(comparison["aspects"][1]["scale"] == comparison["aspects"][1]["scale_q95"]);

    // What was simulated is what was fitted.
    const Experiment simulated = read_experiment(temp / "study/simulate/experiment.toml");
    CHECK(simulated.river.n == 2);
    CHECK(*simulated.river.k == Approx(in_study["k"].get<double>()).epsilon(1e-12));
    CHECK(*simulated.river.m == Approx(in_study["m"].get<double>()).epsilon(1e-12));
    CHECK(simulated.uplift.rate_m_per_yr == uplift);
}

TEST_CASE("A theta that no river has is told with what may have made it") {
    const TempFolder temp;
    const auto notes_at = [&](double theta) {
        const auto folder = temp / fmt::format("theta_{}", theta);
        std::filesystem::create_directories(folder);
        std::ofstream csv(folder / "slope_area.csv");
        csv << "area_m2,slope,slope_se,count\n";
        for (int i = 0; i < 20; ++i) {
            const double area = 1e3 * std::pow(10, 0.1 * i), slope = std::pow(area, -theta);
            csv << fmt::format("{},{},{},9\n", area, slope * (1 + 0.01 * (i % 3 - 1)), 0.01 * slope);
        }
        csv.close();
        std::ofstream(folder / "summary.json") << R"({"dem": {}, "channels": {}, "input": {}})";
        std::vector<std::string> warnings;
        Messages messages;
        messages.warning = [&](const std::string& w) { warnings.push_back(w); };
        std::filesystem::create_directories(folder / "fit");
        const Json json = Json::parse(fit(folder, {}, folder / "fit", messages).json);
        const auto is_odd = [](const std::string& s) { return s.starts_with("theta is "); };
        const auto notes = json["notes"].get<std::vector<std::string>>();
        CHECK(std::ranges::any_of(notes, is_odd) == std::ranges::any_of(warnings, is_odd));
        return std::ranges::any_of(notes, is_odd);
    };
    CHECK(notes_at(0.1));
    CHECK(notes_at(1.2));
    CHECK_FALSE(notes_at(0.45));
}

TEST_CASE("A fit says which ground it is of and what to compare, of a DEM and of the folder of one alike") {
    const TempFolder temp;
    Experiment e = island(MeshKind::raster);
    e.hillslope.talus_angle_deg.reset();
    simulated(e, temp / "island");
    const auto dem = temp / "island/elevation.tif";
    FitOptions options;
    options.fit.uplift_m_per_yr = uplift;
    options.measure.channel_area_m2 = 5e5;
    options.measure.edge_basins = terrain::EdgeBasins::keep;
    std::vector<std::string> lines;
    const Messages messages{.report = [&](const std::string& line) { lines.push_back(line); }};
    std::filesystem::create_directories(temp / "fit");
    const Json of_dem = Json::parse(fit(dem, options, temp / "fit", messages).json);
    std::filesystem::create_directories(temp / "measured");
    const Json summary = Json::parse(analyze(read_dem(dem, {}, {}), options.measure, temp / "measured", {}));
    const double ground_km2 = summary["channels"]["basin_area_m2"].get<double>() / 1e6;
    FitOptions of_folder;
    of_folder.fit.uplift_m_per_yr = uplift;
    const std::string covers = of_dem["covers"];
    CHECK(covers ==
          fmt::format("all catchments, those that the edge cuts too ({:.4g} km2 in all, channels from 0.5 km2 on)",
                      ground_km2));
    CHECK(fitted(temp / "measured", temp / "again", of_folder)["covers"] == covers);
    REQUIRE(lines.size() == 1);
    CHECK(lines[0].starts_with(covers + ": m "));
    CHECK(lines[0].find(fmt::format("k*A0^m = {:.3g} m/yr", of_dem["k_at_reference_area"].get<double>())) !=
          std::string::npos);
}
