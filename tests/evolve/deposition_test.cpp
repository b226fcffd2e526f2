// SPDX-License-Identifier: GPL-3.0-or-later
// Rivers that lay down what they carry.
#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <limits>

#include "support/lattice_mesh.hpp"
#include "support/settings.hpp"
#include "thalweg/core/error.hpp"
#include "thalweg/core/parallel.hpp"
#include "thalweg/evolve/simulate.hpp"

using namespace thalweg;
using namespace thalweg::evolve;

namespace {

using Heights = std::vector<double>;

/// k that gives slopes of 5 % at A = 1e6 m² under 1 mm/yr without deposition, whatever m and n.
double erodibility(double m, double n) { return 1e-3 / (std::pow(1e6, m) * std::pow(0.05, n)); }

River laden(double n, double g, double talus = std::numeric_limits<double>::infinity()) {
    return {.k = erodibility(0.5 * n, n), .m = 0.5 * n, .n = n, .talus_slope = talus, .g = g};
}

/// Water level of every node over the given heights: the highest ground on its way out.
template <class T>
Heights water_levels(const T& topology, const Drainage& drainage, const Heights& heights) {
    Heights level = heights;
    for (const Index node : drainage.order) {
        const Slot slot = drainage.directions[node];
        if (slot != no_flow) level[node] = std::max(heights[node], level[topology.neighbor(node, slot)]);
    }
    return level;
}

/// How far the heights at the end of a step are from what the law makes of them (m): every node's erosion and
/// deposition are computed anew, from the definitions.
struct LawCheck {
    double worst_m = 0;
    double eroded_m3 = 0, deposited_m3 = 0;
    Index filled = 0, judged = 0, above_water = 0;
};

template <class T>
LawCheck check_law(const T& topology, const Drainage& drainage, const River& river, const Setting& setting,
                   double dt_yr, const Heights& before, const Heights& after) {
    LawCheck result;
    const Heights start_level = water_levels(topology, drainage, before);
    const Heights level = water_levels(topology, drainage, after);
    Heights lost(topology.size(), 0.0), load(topology.size(), 0.0);
    for (auto at = drainage.order.rbegin(); at != drainage.order.rend(); ++at) {
        const Index node = *at;
        const Slot slot = drainage.directions[node];
        if (slot == no_flow) continue;
        const Index receiver = topology.neighbor(node, slot);
        const double raised = before[node] + dt_yr * setting.uplift_m_per_yr[node];
        lost[node] = raised - after[node];
        load[node] += topology.area(node) * lost[node];
        load[receiver] += load[node];
        const double length = topology.length(node, slot);
        const double slope = std::max(0.0, (after[node] - after[receiver]) / length);
        const double eroded = dt_yr * river.k * std::pow(drainage.area_m2[node], river.m) * std::pow(slope, river.n);
        const double laid = drainage.area_m2[node] > 0 ? river.g / drainage.area_m2[node] * load[node] : 0;
        const bool in_lake = before[node] < start_level[receiver];
        const bool at_talus = slope > river.talus_slope * (1 - 1e-9);
        const bool full = in_lake && std::abs(after[node] - level[receiver]) <= 1e-9;
        CHECK(slope <= river.talus_slope * (1 + 1e-9));
        if (in_lake && raised < level[receiver]) CHECK(after[node] <= level[receiver] + 1e-9);
        if (at_talus) continue;
        if (full) {
            ++result.filled;
            CHECK(lost[node] >= eroded - laid - 1e-7);  // less was laid down than the river would have
            continue;
        }
        ++result.judged;
        result.eroded_m3 += topology.area(node) * eroded;
        result.deposited_m3 += topology.area(node) * laid;
        result.worst_m = std::max(result.worst_m, std::abs(lost[node] - eroded + laid));
    }
    return result;
}

double relief(const Heights& heights) {
    const auto [low, high] = std::ranges::minmax(heights);
    return high - low;
}

/// Returns how many nodes were filled to the level of their lake.
template <class T>
Index steps_obey_the_law(const T& topology, const River& river, double dt_yr, std::uint64_t seed) {
    const Setting setting = support::island(topology, 1e-3);
    Landscape landscape = support::rough_start(setting, 50, seed);
    MassBalance total;
    Index filled = 0;
    for (int i = 0; i < 12; ++i) {
        const Heights before = landscape.elevation_m;
        const Drainage drainage = drain(topology, landscape, setting, river);
        const StepReport report = erode(topology, drainage, river, setting, dt_yr, landscape);
        CAPTURE(river.n, river.g, river.talus_slope, dt_yr, seed, i, report.sediment_iterations, drainage.lakes);
        CHECK(report.sediment_converged);
        CHECK(report.sediment_iterations < 40);
        const LawCheck law = check_law(topology, drainage, river, setting, dt_yr, before, landscape.elevation_m);
        CHECK(law.worst_m < 1e-9 * (relief(before) + 1e-3 * dt_yr));
        filled += law.filled;
        if (law.filled == 0 && std::isinf(river.talus_slope)) {
            CHECK(report.mass.eroded_m3 == Approx(law.eroded_m3).epsilon(1e-8));
            CHECK(report.mass.deposited_m3 == Approx(law.deposited_m3).epsilon(1e-8));
        }
        CHECK(report.mass.exported_m3 ==
              Approx(report.mass.eroded_m3 + report.mass.talus_m3 - report.mass.deposited_m3));
        total.uplifted_m3 += report.mass.uplifted_m3;
        total.exported_m3 += report.mass.exported_m3;
        total.stored_m3 += report.mass.stored_m3;
    }
    CHECK(std::abs(total.relative_residual()) < 1e-9);
    return filled;
}

}  // namespace

TEST_CASE("One step with deposition of a chain of three cells is what one computes by hand") {
    // Cells of 10 m and 100 m², A = 200 and 100, u·dt = 1 m, m = 1, n = 1, dt·k = 0.1/m: c = 20 and 10 m; G = 1, so
    // G/A = 1/200 and 1/100 per m². Upper: x = 12 − (x − y) + (12 − x), thus 3x = 24 + y. Middle, with q = 100(6 − y) +
    // 100(12 − x): y = 6 − 2y + (18 − y − x)/2, thus 3.5y = 15 − x/2. Together x = 9 m and y = 3 m.
    const Grid grid = plane_grid(1, 3, 10, 10);
    Setting setting = support::island(grid, 0.01);
    setting.boundary = {Boundary::base_level, Boundary::interior, Boundary::interior};
    Landscape landscape{.elevation_m = {0, 5, 11}};
    const River river{.k = 1e-3, .m = 1, .n = 1, .g = 1};
    const Drainage drainage = drain(grid, landscape, setting, river);
    const StepReport report = erode(grid, drainage, river, setting, 100, landscape);
    const double y = 3, x = 9;
    CHECK(landscape.elevation_m[1] == Approx(y).epsilon(1e-13));
    CHECK(landscape.elevation_m[2] == Approx(x).epsilon(1e-13));
    CHECK(report.mass.eroded_m3 == Approx(100 * 2 * y + 100 * (x - y)));
    CHECK(report.mass.deposited_m3 == Approx(100 * (18 - x - y) / 2 + 100 * (12 - x)));
    CHECK(report.mass.stored_m3 == Approx(100 * (x + y - 16)));
    CHECK(std::abs(report.mass.relative_residual()) < 1e-13);
    CHECK(report.sediment_iterations == 1);
}

TEST_CASE("Every node obeys the law at the end of every step, lakes are filled to their level, and the mass closes") {
    const Grid grid = plane_grid(24, 31, 100, 130);
    const Mesh mesh = support::lattice_mesh(25, 25, 120, 0.25, 3);
    std::uint64_t seed = 1;
    Index filled = 0;
    for (const double n : {0.5, 0.7, 1.0, 1.5, 2.0, 4.0}) {
        for (const double g : {0.3, 1.0, 2.0, 10.0}) {
            for (const double talus : {std::numeric_limits<double>::infinity(), 0.1}) {
                for (const double dt_yr : {100.0, 2e4, 1e8}) {
                    filled += steps_obey_the_law(grid, laden(n, g, talus), dt_yr, ++seed);
                    filled += steps_obey_the_law(mesh, laden(n, g, talus), dt_yr, ++seed);
                }
            }
        }
    }
    CHECK(filled > 1000);
}

TEST_CASE("A little deposition is near none") {
    const Grid grid = plane_grid(24, 31, 100, 130);
    const Setting setting = support::island(grid, 1e-3);
    for (const double n : {0.7, 1.0, 1.5}) {
        Landscape none = support::rough_start(setting, 50, 1), little = none;
        for (int i = 0; i < 5; ++i) {
            const Drainage drainage = drain(grid, none, setting, terrain::Receiver::steepest);
            erode(grid, drainage, laden(n, 0), setting, 2e4, none);
            erode(grid, drainage, laden(n, 1e-9), setting, 2e4, little);
        }
        for (Index node = 0; node < grid.size(); ++node) {
            CHECK(std::abs(none.elevation_m[node] - little.elevation_m[node]) < 1e-6);
        }
    }
}

TEST_CASE("At rest slopes are ((1 + G)·u/k)^(1/n)·A^(−m/n), by time stepping and by the steady solver") {
    const Mesh mesh = support::lattice_mesh(22, 22, 200, 0.3, 4);
    const Grid grid = plane_grid(22, 22, 200, 200);
    const auto worst = [](const auto& topology, const River& river, const Setting& setting, const Landscape& landscape,
                          const std::vector<std::uint8_t>& frozen) {
        const Drainage drainage = drain(topology, landscape, setting, river);
        std::vector<std::uint8_t> excepted = frozen;
        excepted.resize(topology.size(), 0);
        double error = 0;
        for (auto at = drainage.order.rbegin(); at != drainage.order.rend(); ++at) {
            const Slot slot = drainage.directions[*at];
            if (slot == no_flow) continue;
            const Index receiver = topology.neighbor(*at, slot);
            excepted[receiver] |= excepted[*at];
            if (excepted[*at]) continue;
            const double slope =
                (landscape.elevation_m[*at] - landscape.elevation_m[receiver]) / topology.length(*at, slot);
            const double law = std::pow((1 + river.g) * 1e-3 / river.k, 1 / river.n) *
                               std::pow(drainage.area_m2[*at], -river.m / river.n);
            error = std::max(error, std::abs(slope / law - 1));
        }
        return error;
    };
    const auto check = [&](const auto& topology) {
        const Setting setting = support::island(topology, 1e-3);
        for (const double n : {0.7, 1.0, 1.5}) {
            for (const double g : {0.5, 2.0}) {
                Landscape stepped = support::rough_start(setting, 1, 2), solved = stepped;
                const SimulationResult result =
                    simulate(topology, {.river = laden(n, g)}, setting,
                             {.step_yr = 1e5, .max_steps = 3000, .convergence = 1e-12}, stepped);
                CAPTURE(n, g, result.steps, result.frozen_receivers);
                CHECK(result.stop_reason == StopReason::converged);
                CHECK(worst(topology, laden(n, g), setting, stepped, result.frozen) < 1e-6);
                CHECK(std::abs(result.mass.relative_residual()) < 1e-9);
                CHECK(result.unconverged_sediment_steps == 0);
                const SteadyResult steady = solve_steady(topology, laden(n, g), setting, 2000, solved);
                CHECK(steady.converged);
                CHECK(worst(topology, laden(n, g), setting, solved, steady.frozen) < 1e-9);
            }
        }
    };
    check(mesh);
    check(grid);
}

TEST_CASE("The steady solver's result with uneven uplift, rain and rock stays where it is under a step of any length") {
    const Grid grid = plane_grid(30, 30, 200, 200);
    Setting setting = support::island(grid, 1e-3);
    setting.relative_erodibility.assign(grid.size(), 1);
    for (Index node = 0; node < grid.size(); ++node) {
        setting.uplift_m_per_yr[node] *= 0.2 + grid.row(node) / 20.0;
        if (grid.col(node) < 8) setting.uplift_m_per_yr[node] *= 0.6;
        setting.rainfall[node] = 0.5 + grid.col(node) / 30.0;
        setting.relative_erodibility[node] = 1 + (node % 3) / 4.0;
    }
    for (const double n : {0.7, 1.0, 1.5}) {
        const River river = laden(n, 1.3, 0.5);
        Landscape landscape = support::rough_start(setting, 1, 3);
        const SteadyResult result = solve_steady(grid, river, setting, 2000, landscape);
        REQUIRE(result.converged);
        REQUIRE(result.frozen_receivers == 0);
        for (const double dt_yr : {1.0, 1e4, 1e8}) {
            Landscape stepped = landscape;
            const Drainage drainage = drain(grid, stepped, setting, river);
            erode(grid, drainage, river, setting, dt_yr, stepped);
            for (Index node = 0; node < grid.size(); ++node) {
                CHECK(std::abs(stepped.elevation_m[node] - landscape.elevation_m[node]) <
                      1e-10 * relief(landscape.elevation_m));
            }
        }
    }
}

TEST_CASE("Sediment from a mountain fills the lake before it, and then goes on to the outlet") {
    // A row: outlet, sill of 20 m, a basin 20 m deep of eight cells, then a mountain without uplift.
    const Index cells = 30;
    const Grid grid = plane_grid(1, cells, 100, 100);
    Setting setting = support::island(grid, 0);
    setting.boundary.assign(cells, Boundary::interior);
    setting.boundary[0] = Boundary::base_level;
    Landscape landscape{.elevation_m = {0, 20}};
    for (Index node = 2; node < cells; ++node) landscape.elevation_m.push_back(node < 10 ? 1.0 : 30.0 * (node - 9));
    const River river{.k = 2e-6, .m = 0.5, .n = 1, .g = 2};
    Index filled = 0;
    double highest_bed = 0;
    for (int i = 0; i < 400; ++i) {
        const Heights before = landscape.elevation_m;
        const Drainage drainage = drain(grid, landscape, setting, river);
        const StepReport report = erode(grid, drainage, river, setting, 1e4, landscape);
        const LawCheck law = check_law(grid, drainage, river, setting, 1e4, before, landscape.elevation_m);
        CHECK(law.worst_m < 1e-9);
        filled += law.filled;
        highest_bed = std::max(highest_bed, landscape.elevation_m[5]);
        CHECK(report.sediment_converged);
        CHECK(report.mass.deposited_m3 >= 0);
        CHECK(std::abs(report.mass.exported_m3 + report.mass.stored_m3) < 1e-9 * report.mass.eroded_m3);
    }
    CHECK(filled > 0);
    CHECK(highest_bed > 5);  // from 1 m
    CHECK(drain(grid, landscape, setting, river).lakes == 0);
}

TEST_CASE("A step with deposition is the same in metres and years and in kilometres and thousands of years") {
    const Grid metres = plane_grid(30, 30, 512, 512);
    const Grid kilometres = plane_grid(30, 30, 0.512, 0.512);
    const Setting setting = support::island(metres, 1e-3);
    for (const double n : {1.0, 1.5}) {
        Landscape a = support::rough_start(setting, 1, 7), b = a;
        for (double& height : b.elevation_m) height /= 1000;
        const River river{.k = erodibility(0.4, n), .m = 0.4, .n = n, .g = 1.5};
        River scaled = river;
        scaled.k *= std::pow(10, 2.4);
        for (int i = 0; i < 5; ++i) {
            erode(metres, drain(metres, a, setting, river), river, setting, 5e4, a);
            erode(kilometres, drain(kilometres, b, setting, scaled), scaled, setting, 50, b);
        }
        for (Index node = 0; node < metres.size(); ++node) {
            CHECK(std::abs(a.elevation_m[node] - 1000 * b.elevation_m[node]) < 1e-8);
        }
    }
}

TEST_CASE("Where no rain falls nothing is laid down") {
    const Grid grid = plane_grid(1, 6, 100, 100);
    Setting setting = support::island(grid, 1e-3);
    setting.boundary.assign(6, Boundary::interior);
    setting.boundary[0] = Boundary::base_level;
    setting.rainfall.assign(6, 0.0);
    Landscape landscape{.elevation_m = {0, 1, 2, 3, 4, 5}};
    const River river{.k = 1e-3, .m = 0.5, .n = 1, .talus_slope = 0.01, .g = 1};
    const StepReport report = erode(grid, drain(grid, landscape, setting, river), river, setting, 1e4, landscape);
    CHECK(report.mass.deposited_m3 == 0);
    CHECK(report.mass.eroded_m3 == 0);
    CHECK(report.mass.talus_m3 > 0);
    CHECK(std::abs(report.mass.relative_residual()) < 1e-12);
}

TEST_CASE("Deposition without meaning is refused in a sentence") {
    const Grid grid = plane_grid(5, 5, 100, 100);
    const Setting setting = support::island(grid, 1e-3);
    Landscape landscape = support::rough_start(setting, 1, 1);
    const TimeOptions time{.step_yr = 1, .max_steps = 1};
    River river{.k = 1e-5, .g = -1};
    CHECK_THROWS_AS(simulate(grid, {.river = river}, setting, time, landscape), Error);
    river.g = std::numeric_limits<double>::infinity();
    CHECK_THROWS_AS(simulate(grid, {.river = river}, setting, time, landscape), Error);
}
