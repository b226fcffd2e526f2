// SPDX-License-Identifier: GPL-3.0-or-later
#include <catch2/catch.hpp>

#include <algorithm>
#include <cmath>
#include <limits>

#include "support/lattice_mesh.hpp"
#include "support/settings.hpp"
#include "thalweg/core/error.hpp"
#include "thalweg/core/random.hpp"
#include "thalweg/evolve/history.hpp"
#include "thalweg/evolve/simulate.hpp"

using namespace thalweg;
using namespace thalweg::evolve;

namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();

/// A rise, a rest, a jump down and a fall.
const History drawn{{0, 100, 200, 200, 300}, {1, 3, 3, 2, 0}};

History random_history(std::uint64_t seed) {
    History history;
    double time = -500;
    const auto rows = static_cast<Index>(1 + 9 * uniform_at(seed, 1, 0));
    for (Index row = 0; row < rows; ++row) {
        history.time_yr.push_back(time);
        history.value.push_back(4 * uniform_at(seed, 2, row));
        const bool jump = uniform_at(seed, 3, row) < 0.2 && (row == 0 || history.time_yr[row - 1] != time);
        if (!jump) time += 1000 * uniform_at(seed, 4, row);
    }
    return history;
}

/// The middle rule on very many pieces: slow and obvious.
double mean_by_middles(const History& history, double start, double end) {
    constexpr int pieces = 200000;
    double sum = 0;
    for (int i = 0; i < pieces; ++i) sum += value_at(history, start + (end - start) * (i + 0.5) / pieces);
    return sum / pieces;
}

}  // namespace

TEST_CASE("A history is straight between its rows, constant outside, and jumps where two rows have one time") {
    CHECK(value_at(drawn, -10) == 1);
    CHECK(value_at(drawn, 0) == 1);
    CHECK(value_at(drawn, 25) == 1.5);
    CHECK(value_at(drawn, 150) == 3);
    CHECK(value_at(drawn, std::nextafter(200, 0)) == Approx(3));
    CHECK(value_at(drawn, 200) == 2);
    CHECK(value_at(drawn, 250) == 1);
    CHECK(value_at(drawn, 1e9) == 0);
}

TEST_CASE("The mean over a span is the area under the drawn lines over its length") {
    CHECK(mean_between(drawn, -100, 0) == 1);
    CHECK(mean_between(drawn, 0, 100) == 2);
    CHECK(mean_between(drawn, 100, 200) == 3);  // a jump at the end is of the next span
    CHECK(mean_between(drawn, 200, 300) == 1);
    CHECK(mean_between(drawn, 150, 250) == Approx((150 + 75) / 100.0).epsilon(1e-15));
    CHECK(mean_between(drawn, -100, 400) == Approx((100 + 200 + 300 + 100) / 500.0).epsilon(1e-15));
    CHECK(mean_between({{5}, {7}}, 0, 10) == 7);
}

TEST_CASE("Means agree with very many small pieces, and add up however a span is cut") {
    for (std::uint64_t seed = 1; seed <= 20; ++seed) {
        const History history = random_history(seed);
        const double start = -800 + 1000 * uniform_at(seed, 5, 0), end = start + 1 + 4000 * uniform_at(seed, 5, 1);
        const double whole = mean_between(history, start, end);
        CHECK(whole == Approx(mean_by_middles(history, start, end)).margin(2e-5));
        double parts = 0, from = start;
        for (int i = 1; i <= 7; ++i) {
            const double to = i == 7 ? end : start + (end - start) * i / 7.0 * uniform_at(seed, 6, i);
            if (!(to > from)) continue;
            parts += (to - from) * mean_between(history, from, to);
            from = to;
        }
        CHECK(parts == Approx(whole * (end - start)).epsilon(1e-13).margin(1e-10));
    }
}

TEST_CASE("The last change is where the value becomes constant for good") {
    CHECK(last_change_yr(drawn) == 300);
    CHECK(last_change_yr({{0, 10, 20, 30}, {1, 2, 2, 2}}) == 10);
    CHECK(last_change_yr({{0, 10}, {2, 2}}) == -infinity);
    CHECK(last_change_yr({{3}, {2}}) == -infinity);
    CHECK(last_change_yr({}) == -infinity);
}

TEST_CASE("A history that goes back in time, jumps twice at once or is not finite is refused") {
    CHECK_THROWS_AS(check_history({{0, 10, 5}, {1, 1, 1}}, "uplift"), Error);
    CHECK_THROWS_AS(check_history({{0, 0, 0}, {1, 2, 3}}, "uplift"), Error);
    CHECK_THROWS_AS(check_history({{0, 1}, {1}}, "uplift"), Error);
    CHECK_THROWS_AS(check_history({{0, infinity}, {1, 1}}, "uplift"), Error);
    CHECK_NOTHROW(check_history({{0, 0, 1}, {1, 2, 3}}, "uplift"));
    const Grid grid = plane_grid(5, 5, 100, 100);
    Setting setting = support::island(grid, 1e-3);
    Landscape landscape = support::rough_start(setting, 1, 1);
    setting.uplift_factor = {{0}, {-1}};
    CHECK_THROWS_AS(simulate(grid, {{.k = 1e-5}}, setting, {.step_yr = 1, .max_steps = 1}, landscape), Error);
    setting.uplift_factor = {{0}, {1}};
    CHECK_THROWS_AS(solve_steady(grid, {.k = 1e-5}, setting, 1, landscape), Error);
}

TEST_CASE("A history that says what was so without it changes no bit") {
    const Mesh mesh = support::lattice_mesh(15, 15, 100, 0.3, 2);
    const Setting plain = support::island(mesh, 1e-3);
    Setting same = plain;
    same.uplift_factor = {{10, 777, 5000}, {1, 1, 1}};
    same.base_level_m = {{0, 1e6}, {0, 0}};
    Landscape a = support::rough_start(plain, 1, 1), b = a;
    const TimeOptions options{.step_yr = 1e4, .max_steps = 300, .convergence = 1e-4};
    const auto without = simulate(mesh, {{.k = 2e-5, .n = 1.4}}, plain, options, a);
    const auto with = simulate(mesh, {{.k = 2e-5, .n = 1.4}}, same, options, b);
    CHECK(a.elevation_m == b.elevation_m);
    CHECK(without.steps == with.steps);
    CHECK(without.mass.uplifted_m3 == with.mass.uplifted_m3);
}

TEST_CASE("The volume uplifted is the history's integral for any step, and the mass balance closes") {
    const Grid grid = plane_grid(12, 12, 100, 100);
    Setting setting = support::island(grid, 1e-3);
    setting.uplift_factor = {{1000, 20000, 20000, 50000, 90000}, {0.5, 2, 0, 1, 0.25}};
    setting.base_level_m = {{0, 30000, 30000, 70000}, {0, 40, -60, 100}};
    const double inner_area = 100 * 1e4;  // 10 × 10 cells
    const double integral = 0.5 * 1000 + 1.25 * 19000 + 0.5 * 30000 + 0.625 * 40000 + 0.25 * 30000;
    for (const double dt : {100.0, 700.0, 3333.3333333333335, 40000.0, 120000.0}) {
        const auto steps = static_cast<Index>(std::ceil(120000 / dt));
        Landscape landscape = support::rough_start(setting, 1, 1);
        const auto result = simulate(grid, {{.k = 2e-5, .talus_slope = 0.8}}, setting,
                                     {.step_yr = dt, .max_steps = steps, .convergence = 0}, landscape);
        const double beyond = (steps * dt - 120000) * 0.25;
        CHECK(result.mass.uplifted_m3 == Approx(inner_area * 1e-3 * (integral + beyond)).epsilon(1e-11));
        CHECK(std::abs(result.mass.relative_residual()) < 1e-11);
    }
}

TEST_CASE("Base level stands at the end of each step where its history is then, and nothing else is put there") {
    const Grid grid = plane_grid(9, 11, 100, 100);
    Setting setting = support::island(grid, 1e-3);
    setting.base_level_m = {{0, 10000}, {0, -50}};
    Landscape landscape = support::rough_start(setting, 1, 1);
    simulate(grid, {{.k = 2e-5}}, setting, {.step_yr = 1000, .max_steps = 12, .convergence = 0}, landscape,
             [&](const StepRecord& record, const SimulationState& state) {
                 const double level = std::max(-50.0, -record.time_yr / 200);
                 for (Index node = 0; node < grid.size(); ++node) {
                     const bool base = setting.boundary[node] == Boundary::base_level;
                     if (base) CHECK(state.landscape.elevation_m[node] == Approx(level));
                     if (!base) CHECK(state.landscape.elevation_m[node] > level);
                 }
             });
}

TEST_CASE(
    "A fall of base level travels upstream as the linear law says: h(x, t) is the level of t less the way's time") {
    // One straight river of even drainage area (rain only at its source), n = 1: knickpoints move at c = k·A^m.
    constexpr Index nodes = 400;
    const Grid grid = plane_grid(1, nodes, 100, 100);
    Setting setting{.uplift_m_per_yr = std::vector<double>(nodes, 0.0),
                    .rainfall = std::vector<double>(nodes, 0.0),
                    .boundary = std::vector<Boundary>(nodes, Boundary::interior)};
    setting.boundary[0] = Boundary::base_level;
    setting.rainfall[nodes - 1] = 100;  // 1e6 m² everywhere
    setting.base_level_m = {{0, 1e6}, {0, -1000}};
    const double speed = 1e-5 * std::sqrt(1e6);  // 0.01 m/yr
    Landscape landscape;
    for (Index node = 0; node < nodes; ++node) landscape.elevation_m.push_back(1e-9 * node);
    simulate(grid, {{.k = 1e-5}}, setting, {.step_yr = 1000, .max_steps = 1000, .convergence = 0}, landscape);
    for (const Index node : {10u, 30u, 50u, 70u}) {
        const double since = 1e6 - node * 100 / speed;
        CHECK(landscape.elevation_m[node] == Approx(-since / 1000).margin(1.0));
    }
    CHECK(landscape.elevation_m[200] == Approx(0).margin(1e-3));
}

TEST_CASE("A run does not end while a history has changes ahead, and ends after them as steady as ever") {
    const Grid grid = plane_grid(14, 14, 100, 100);
    Setting setting = support::island(grid, 1e-3);
    const TimeOptions options{.step_yr = 5e4, .max_steps = 5000, .convergence = 1e-6};
    Landscape early = support::rough_start(setting, 1, 1);
    const auto plain = simulate(grid, {{.k = 2e-5}}, setting, options, early);
    REQUIRE(plain.stop_reason == StopReason::converged);
    REQUIRE(plain.steps < 400);

    setting.uplift_factor = {{2e7, 3e7}, {1, 2}};  // long after it would have come to rest
    Landscape late = support::rough_start(setting, 1, 1);
    const auto changed = simulate(grid, {{.k = 2e-5}}, setting, options, late);
    CHECK(changed.stop_reason == StopReason::converged);
    CHECK(late.time_yr > 3e7);
    const double before = *std::ranges::max_element(early.elevation_m),
                 after = *std::ranges::max_element(late.elevation_m);
    CHECK(after == Approx(2 * before).epsilon(0.02));  // h ∝ u for n = 1, on the same rivers

    setting.uplift_factor = {};
    setting.base_level_m = {{2e7, 3e7}, {0, 70}};
    late = support::rough_start(setting, 1, 1);
    simulate(grid, {{.k = 2e-5}}, setting, options, late);
    CHECK(late.time_yr > 3e7);
    CHECK(*std::ranges::max_element(late.elevation_m) == Approx(before + 70).epsilon(0.02));
}

TEST_CASE("A run with histories goes on from the state after any step to the same numbers") {
    const Mesh mesh = support::lattice_mesh(12, 12, 100, 0.3, 5);
    Setting setting = support::island(mesh, 1e-3);
    setting.uplift_factor = {{1e5, 3e5}, {1, 3}};
    setting.base_level_m = {{0, 2e5, 2e5}, {0, -30, 20}};
    const Landscape start = support::rough_start(setting, 1, 1);
    const TimeOptions options{.step_yr = 12345, .max_steps = 40, .convergence = 1e-4};
    std::vector<SimulationState> states;
    SimulationState whole = initial_state(start);
    simulate(mesh, {{.k = 2e-5}}, setting, options, whole,
             [&](const StepRecord&, const SimulationState& now) { states.push_back(now); });
    for (std::size_t from = 0; from < states.size(); from += 5) {
        SimulationState state = states[from];
        simulate(mesh, {{.k = 2e-5}}, setting, options, state);
        CHECK(state.landscape.elevation_m == whole.landscape.elevation_m);
        CHECK(state.mass.stored_m3 == whole.mass.stored_m3);
    }
}
