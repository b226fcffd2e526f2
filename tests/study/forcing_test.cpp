// SPDX-License-Identifier: GPL-3.0-or-later
#include <catch2/catch.hpp>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "support/temp_folder.hpp"
#include "thalweg/core/error.hpp"
#include "thalweg/io/table_file.hpp"
#include "thalweg/study/output_folder.hpp"
#include "thalweg/study/simulate.hpp"

using namespace thalweg;
using namespace thalweg::study;
using test::error_of;
using test::TempFolder;
using Json = nlohmann::json;

namespace {

Experiment small_island() {
    Experiment e;
    e.domain.size_m = {3000, 2400};
    e.domain.spacing_m = 200;
    e.domain.mesh = MeshKind::raster;
    e.uplift.rate_m_per_yr = 5e-4;
    e.river.k = 2e-5;
    e.river.m = 0.5;
    e.time.step_yr = 1e4;
    e.time.max_steps = 20;
    e.time.convergence = 0;
    return e;
}

/// The refusal of an experiment whose uplift (or base level) follows a table of this text.
std::string refusal(const TempFolder& temp, const std::string& table, bool base_level = false) {
    const auto path = temp / "history.csv";
    write_text(path, table);
    Experiment e = small_island();
    (base_level ? e.base_level.history : e.uplift.history) = path;
    const std::string text = error_of([&] { simulate(e, temp / "", {}); });
    CHECK(text.find("history.csv") != std::string::npos);
    return text;
}

}  // namespace

TEST_CASE("A history's file is refused by the line in which it is wrong") {
    const TempFolder temp;
    const auto says = [](const std::string& text, const char* part) { return text.find(part) != std::string::npos; };
    CHECK(
        says(refusal(temp, "time_yr,factor\n0,1\n\n10,much\n"), "line 4: factor must be a finite number, not 'much'"));
    CHECK(says(refusal(temp, "time_yr,factor\n0,1\n10,\n"), "line 3: factor must be a finite number, not ''"));
    CHECK(says(refusal(temp, "time_yr,factor\n0,1\nx,2\n20,3\n"), "line 3: time_yr must be"));
    CHECK(says(refusal(temp, "time_yr,factor\n0,1\n10,inf\n"), "line 3: factor must be a finite number, not 'inf'"));
    CHECK(says(refusal(temp, "time_yr,factor\n0,1\n10,2\n5,2\n"), "line 4: time_yr goes back from 10 to 5"));
    CHECK(says(refusal(temp, "time_yr,factor\n0,1\n0,2\n0,3\n"), "line 4: a third row for the year 0"));
    CHECK(says(refusal(temp, "time_yr,rate_m_per_yr\n0,1e-3\n10,-1e-3\n"), "line 3: rate_m_per_yr must be at least 0"));
    CHECK(says(refusal(temp, "time_yr,rate\n0,1\n"), "needs one of the columns rate_m_per_yr and factor"));
    CHECK(says(refusal(temp, "time_yr,rate_m_per_yr,factor\n0,1,1\n"), "needs one of the columns"));
    CHECK(says(refusal(temp, "year,factor\n0,1\n"), "no column time_yr"));
    CHECK(says(refusal(temp, "time_yr,factor\n"), "no row below its header"));
    CHECK(says(refusal(temp, "time_yr,level\n0,1\n", true), "no column elevation_m"));
    CHECK(says(refusal(temp, "time_yr,elevation_m\n0,1\n0,1,3\n", true), "line 3: 3 fields"));

    Experiment e = small_island();
    e.time.solver = Solver::steady;
    e.base_level.history = temp / "history.csv";
    CHECK(says(error_of([&] { simulate(e, temp / "", {}); }), "knows no time"));
    e.time.solver = Solver::implicit;
    e.base_level.history = temp / "none.csv";
    CHECK(says(error_of([&] { simulate(e, temp / "", {}); }), "none.csv"));
}

TEST_CASE(
    "Rates in a history take the place of the experiment's rate, factors multiply it, and both can say the same") {
    const TempFolder temp;
    const auto heights = [&](const char* name, Experiment e, const std::string& table) {
        if (!table.empty()) {
            write_text(temp / "uplift.csv", table);
            e.uplift.history = temp / "uplift.csv";
        }
        std::filesystem::create_directories(temp / name);
        const Json summary = Json::parse(simulate(e, temp / name, {}));
        CHECK(std::abs(summary["mass_balance"]["relative_residual"].get<double>()) < 1e-11);
        return summary["elevation_mean_m"].get<double>();
    };
    const Experiment e = small_island();
    const double plain = heights("plain", e, "");
    CHECK(heights("one", e, "time_yr,factor\n0,1\n1e5,1\n") == plain);
    CHECK(heights("same", e, "time_yr,rate_m_per_yr\n0,5e-4\n") == plain);
    Experiment other = e;
    other.uplift.rate_m_per_yr = 123;
    CHECK(heights("instead", other, "time_yr,rate_m_per_yr\n0,5e-4\n") == plain);
    const double growing = heights("rates", e, "time_yr,rate_m_per_yr\n0,0\n2e5,1e-3\n");
    CHECK(growing == Approx(heights("factors", e, "time_yr,factor\n0,0\n2e5,2\n")).epsilon(1e-12));
    CHECK(growing > 1.2 * plain);  // the same volume, but later
    CHECK(heights("nothing", e, "time_yr,rate_m_per_yr\n0,0\n") < 0.01);
}

TEST_CASE("A history that goes on after the end of the run is warned of") {
    const TempFolder temp;
    write_text(temp / "level.csv", "time_yr,elevation_m\n0,0\n1e5,-10\n3e5,-20\n9e5,-20\n");
    Experiment e = small_island();  // until 2e5 yr
    e.base_level.history = temp / "level.csv";
    std::vector<std::string> warnings;
    const Messages messages{.progress = [](const std::string&) {},
                            .warning = [&](const std::string& text) { warnings.push_back(text); }};
    std::filesystem::create_directories(temp / "a");
    const Json summary = Json::parse(simulate(e, temp / "a", messages));
    REQUIRE(warnings.size() == 1);
    CHECK(std::ranges::count(summary["notes"], Json(warnings[0])) == 1);
    CHECK(warnings[0].find("base_level.history changes until the year 300000") != std::string::npos);
    e.time.max_steps = 30;
    std::filesystem::create_directories(temp / "b");
    simulate(e, temp / "b", messages);
    CHECK(warnings.size() == 1);
}

TEST_CASE("A surface of noise starts on the first base level, and the outlets follow the table") {
    const TempFolder temp;
    write_text(temp / "level.csv", "elevation_m,time_yr\n700,0\n700,100000\n650,200000\n");
    Experiment e = small_island();
    e.base_level.history = temp / "level.csv";
    std::filesystem::create_directories(temp / "out");
    const Json summary = Json::parse(simulate(e, temp / "out", {}));
    const Table history = io::read_csv(temp / "out/history.csv");
    const auto& highest = std::get<std::vector<double>>(history.columns[3].values);
    CHECK(highest.front() > 700);
    CHECK(highest.front() < 710);
    CHECK(summary["terrain"]["input"]["elevation_min_m"].get<double>() == 650);
    CHECK(std::abs(summary["mass_balance"]["relative_residual"].get<double>()) < 1e-10);
}
