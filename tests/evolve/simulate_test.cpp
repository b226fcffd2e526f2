// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <numeric>

#include "support/lattice_mesh.hpp"
#include "support/settings.hpp"
#include "thalweg/core/error.hpp"
#include "thalweg/evolve/simulate.hpp"

using namespace thalweg;
using namespace thalweg::evolve;

TEST_CASE("The observer sees every step, with the landscape of that moment") {
    const Grid grid = plane_grid(20, 20, 100, 100);
    const Setting setting = support::island(grid, 1e-3);
    Landscape landscape = support::rough_start(setting, 1, 1);
    landscape.time_yr = 500;
    std::vector<StepRecord> records;
    const SimulationResult result =
        simulate(grid, {{.k = 2e-5}}, setting, {.step_yr = 1000, .max_steps = 7, .convergence = 0}, landscape,
                 [&](const StepRecord& record, const SimulationState& state) {
                     const Landscape& now = state.landscape;
                     CHECK(record.elevation_max_m == *std::ranges::max_element(now.elevation_m));
                     const double sum = std::accumulate(now.elevation_m.begin(), now.elevation_m.end(), 0.0);
                     CHECK(record.elevation_mean_m == Approx(sum / now.elevation_m.size()));
                     CHECK(record.time_yr == now.time_yr);
                     records.push_back(record);
                 });
    REQUIRE(records.size() == 7);
    CHECK(records[0].step == 1);
    CHECK(records[0].time_yr == 1500);
    CHECK(records[0].lakes > 0);
    CHECK(records[6].time_yr == 7500);
    CHECK(landscape.time_yr == 7500);
    CHECK(result.steps == 7);
    CHECK(result.stop_reason == StopReason::max_steps);
    CHECK(result.max_rate_m_per_yr == records[6].max_rate_m_per_yr);
    CHECK(result.mean_rate_m_per_yr == records[6].mean_rate_m_per_yr);
    CHECK(result.max_rate_m_per_yr >= result.mean_rate_m_per_yr);
}

TEST_CASE("A run is its steps one by one") {
    const Mesh mesh = support::lattice_mesh(20, 20, 100, 0.2, 1);
    const Setting setting = support::island(mesh, 1e-3);
    const River river{.k = 2e-5, .m = 0.45, .n = 1.3, .talus_slope = 0.7};
    Landscape run = support::rough_start(setting, 1, 1);
    Landscape by_hand = run;
    const SimulationResult result =
        simulate(mesh, {river}, setting, {.step_yr = 1e4, .max_steps = 12, .convergence = 0}, run);
    MassBalance mass;
    for (int i = 0; i < 12; ++i) {
        const Drainage drainage = drain(mesh, by_hand, setting, river.receiver);
        const StepReport report = erode(mesh, drainage, river, setting, 1e4, by_hand);
        mass.uplifted_m3 += report.mass.uplifted_m3;
        mass.talus_m3 += report.mass.talus_m3;
        mass.stored_m3 += report.mass.stored_m3;
    }
    CHECK(run.elevation_m == by_hand.elevation_m);
    CHECK(result.mass.uplifted_m3 == mass.uplifted_m3);
    CHECK(result.mass.talus_m3 == mass.talus_m3);
    CHECK(result.mass.stored_m3 == mass.stored_m3);
}

TEST_CASE("A run stops when the mean rate falls under its share of the mean uplift, at most a step late") {
    const Grid grid = plane_grid(25, 25, 100, 100);
    Setting setting = support::island(grid, 1e-3);
    for (Index node = 0; node < grid.size(); ++node) setting.uplift_m_per_yr[node] *= 0.5 + grid.row(node) / 24.0;
    Landscape landscape = support::rough_start(setting, 1, 1);
    std::vector<double> rates;
    const SimulationResult result =
        simulate(grid, {{.k = 2e-5}}, setting, {.step_yr = 2e4, .max_steps = 5000, .convergence = 0.01}, landscape,
                 [&](const StepRecord& record, const SimulationState&) { rates.push_back(record.mean_rate_m_per_yr); });
    CHECK(result.stop_reason == StopReason::converged);
    CHECK(to_string(result.stop_reason) == "converged");
    CHECK(result.steps == rates.size());
    CHECK(rates.back() <= 0.01 * 1e-3);  // the mean of 0.5 … 1.5 over the inner rows is 1
    for (std::size_t i = 0; i + 2 < rates.size(); ++i) CHECK(rates[i] > 0.01 * 1e-3 * (1 - 1e-12));
}

TEST_CASE("No step at all leaves the landscape alone") {
    const Grid grid = plane_grid(5, 5, 100, 100);
    const Setting setting = support::island(grid, 1e-3);
    Landscape landscape = support::rough_start(setting, 1, 1);
    const Landscape before = landscape;
    const SimulationResult result = simulate(grid, {{.k = 2e-5}}, setting, {.step_yr = 1, .max_steps = 0}, landscape);
    CHECK(landscape.elevation_m == before.elevation_m);
    CHECK(result.steps == 0);
    CHECK(to_string(result.stop_reason) == "max_steps");
    CHECK(result.mass.relative_residual() == 0);
}

TEST_CASE("Without uplift and rivers nothing moves but by rounding, and the run is soon at rest") {
    const Grid grid = plane_grid(5, 5, 100, 100);
    const Setting setting = support::island(grid, 0);
    Landscape landscape = support::rough_start(setting, 1, 1);
    const Landscape before = landscape;
    const SimulationResult result = simulate(grid, {{.k = 0}}, setting, {.step_yr = 1, .max_steps = 10}, landscape);
    CHECK(result.steps <= 3);
    CHECK(result.stop_reason == StopReason::converged);
    for (Index node = 0; node < 25; ++node)
        CHECK(landscape.elevation_m[node] == Approx(before.elevation_m[node]).epsilon(1e-15));
    CHECK(result.mass.relative_residual() == 0);
}

TEST_CASE("Without uplift a mountain is worn away") {
    const Grid grid = plane_grid(15, 15, 100, 100);
    const Setting setting = support::island(grid, 0);
    Landscape landscape = support::rough_start(setting, 100, 1);
    const SimulationResult result =
        simulate(grid, {{.k = 1e-4}}, setting, {.step_yr = 1e5, .max_steps = 100, .convergence = 1e-3}, landscape);
    CHECK(result.stop_reason == StopReason::max_steps);
    CHECK(*std::ranges::max_element(landscape.elevation_m) < 1e-6);
    CHECK(std::isfinite(result.mean_rate_m_per_yr));
}

TEST_CASE("With Bell's lowest receiver the run comes to rest as well") {
    const Mesh mesh = support::lattice_mesh(25, 25, 200, 0.3, 1);
    const Setting setting = support::island(mesh, 1e-3);
    Landscape landscape = support::rough_start(setting, 1, 1);
    const River river{.k = 2e-5, .receiver = terrain::Receiver::lowest};
    const SimulationResult result =
        simulate(mesh, {river}, setting, {.step_yr = 1e5, .max_steps = 2000, .convergence = 1e-6}, landscape);
    CHECK(result.stop_reason == StopReason::converged);
    CHECK(result.lakes_final == 0);
}

TEST_CASE("A landscape of the wrong size is refused") {
    const Grid grid = plane_grid(5, 5, 100, 100);
    const Setting setting = support::island(grid, 1e-3);
    Landscape landscape{.elevation_m = std::vector<double>(24, 0.0)};
    CHECK_THROWS_AS(simulate(grid, {{.k = 1}}, setting, {.step_yr = 1, .max_steps = 1}, landscape), Error);
    CHECK_THROWS_AS(solve_steady(grid, {.k = 1}, setting, 1, landscape), Error);
    CHECK_THROWS_AS(drain(grid, landscape, setting, terrain::Receiver::steepest), Error);
}
