// SPDX-License-Identifier: GPL-3.0-or-later
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

/// A row of cells whose western end is base level: water can only run west.
struct Row {
    Grid grid;
    Setting setting;
    Landscape landscape;
};

Row row_of(std::vector<double> heights, double spacing_m, double uplift_m_per_yr) {
    const Index count = static_cast<Index>(heights.size());
    Row row{plane_grid(1, count, spacing_m, spacing_m), {}, {.elevation_m = std::move(heights)}};
    row.setting = {.uplift_m_per_yr = std::vector<double>(count, uplift_m_per_yr),
                   .rainfall = std::vector<double>(count, 1.0),
                   .boundary = std::vector<Boundary>(count, Boundary::interior)};
    row.setting.boundary[0] = Boundary::base_level;
    return row;
}

template <class T>
StepReport step(const T& topology, const River& river, const Setting& setting, double dt_yr, Landscape& landscape) {
    const Drainage drainage = drain(topology, landscape, setting, river.receiver);
    return erode(topology, drainage, river, setting, dt_yr, landscape);
}

/// Mass balance of a run whose terms must close; the eroded volume is recomputed here from the heights after each step.
template <class T>
void check_balance(const T& topology, const River& river, double dt_yr, std::uint64_t seed) {
    const Setting setting = support::island(topology, 1e-3);
    Landscape landscape = support::rough_start(setting, 50, seed);
    MassBalance total;
    for (int i = 0; i < 40; ++i) {
        const Drainage drainage = drain(topology, landscape, setting, river.receiver);
        const StepReport report = erode(topology, drainage, river, setting, dt_yr, landscape);
        if (std::isinf(river.talus_slope)) {
            double eroded = 0;
            for (Index node = 0; node < topology.size(); ++node) {
                const Slot slot = drainage.directions[node];
                if (slot == no_flow) continue;
                const double drop = landscape.elevation_m[node] - landscape.elevation_m[topology.neighbor(node, slot)];
                const double slope = std::max(0.0, drop / topology.length(node, slot));
                eroded += topology.area(node) * dt_yr * river.k * std::pow(drainage.area_m2[node], river.m) *
                          std::pow(slope, river.n);
            }
            CHECK(report.mass.eroded_m3 == Approx(eroded).epsilon(1e-6));
        }
        total.uplifted_m3 += report.mass.uplifted_m3;
        total.eroded_m3 += report.mass.eroded_m3;
        total.talus_m3 += report.mass.talus_m3;
        total.exported_m3 += report.mass.exported_m3;
        total.stored_m3 += report.mass.stored_m3;
    }
    CAPTURE(river.n, river.talus_slope, dt_yr);
    CHECK(total.uplifted_m3 > 0);
    CHECK(total.eroded_m3 > 0);
    CHECK((total.talus_m3 > 0) == std::isfinite(river.talus_slope));
    CHECK(std::abs(total.relative_residual()) < 1e-9);
}

/// k that gives slopes of a few per cent at A = 1e6 m² under 1 mm/yr, whatever m and n.
double erodibility(double m, double n) { return 1e-3 / (std::pow(1e6, m) * std::pow(0.05, n)); }

}  // namespace

TEST_CASE("One step of a chain of three cells is what one computes by hand") {
    // Cells of 10 m, u·dt = 1 m; areas 200 and 100 m² above the outlet. m = 1, n = 1: c = dt·k·A = 20 and 10 m with
    // dt·k = 0.1/m. Middle: (5 + 1 − 0)/(10 + 20) = 0.2, height 2. Upper: (11 + 1 − 2)/(10 + 10) = 0.5, height 7.
    Row row = row_of({0, 5, 11}, 10, 0.01);
    const Drainage drainage = drain(row.grid, row.landscape, row.setting, terrain::Receiver::steepest);
    CHECK(drainage.area_m2 == std::vector<double>{300, 200, 100});
    CHECK(drainage.directions == FlowDirections{no_flow, 4, 4});
    CHECK(drainage.order == std::vector<Index>{0, 1, 2});
    const StepReport report = erode(row.grid, drainage, {.k = 1e-3, .m = 1, .n = 1}, row.setting, 100, row.landscape);
    CHECK(row.landscape.elevation_m[0] == 0);
    CHECK(row.landscape.elevation_m[1] == Approx(2).epsilon(1e-15));
    CHECK(row.landscape.elevation_m[2] == Approx(7).epsilon(1e-15));
    CHECK(row.landscape.time_yr == 100);
    CHECK(report.mass.uplifted_m3 == Approx(200));
    CHECK(report.mass.eroded_m3 == Approx(100 * 20 * 0.2 + 100 * 10 * 0.5));
    CHECK(report.mass.talus_m3 == 0);
    CHECK(report.mass.stored_m3 == Approx(-300 - 400));
    CHECK(report.max_rate_m_per_yr == Approx(0.04));
    CHECK(report.mean_rate_m_per_yr == Approx(0.035));
}

TEST_CASE("The talus limit cuts a node before its donors are solved, and books what it takes") {
    // As above with a limit of 0.3: middle 2 m (slope 0.2). Upper: slope 0.5 is cut to 0.3, height 5, 2 m·100 m² taken.
    Row row = row_of({0, 5, 11}, 10, 0.01);
    const River river{.k = 1e-3, .m = 1, .n = 1, .talus_slope = 0.3};
    const StepReport report = step(row.grid, river, row.setting, 100, row.landscape);
    CHECK(row.landscape.elevation_m[2] == Approx(5).epsilon(1e-15));
    CHECK(report.mass.talus_m3 == Approx(200));
    CHECK(report.mass.exported_m3 == Approx(report.mass.eroded_m3 + 200));
    CHECK(std::abs(report.mass.relative_residual()) < 1e-13);
    const Drainage after = drain(row.grid, row.landscape, row.setting, terrain::Receiver::steepest);
    CHECK(at_talus_limit(row.grid, after, river, row.landscape) == std::vector<std::uint8_t>{0, 0, 1});
}

TEST_CASE("A node whose receiver ends higher than it is lifted as a whole and not dug") {
    // A pit of 1 m behind a sill of 10 m: its water climbs the sill, which in one step stays above it.
    Row row = row_of({0, 10, 1}, 10, 0.01);
    const Drainage drainage = drain(row.grid, row.landscape, row.setting, terrain::Receiver::steepest);
    CHECK(drainage.lakes == 1);
    CHECK(drainage.directions == FlowDirections{no_flow, 4, 4});
    const StepReport report = erode(row.grid, drainage, {.k = 1e-4, .m = 1, .n = 1}, row.setting, 100, row.landscape);
    CHECK(row.landscape.elevation_m[1] == Approx(11.0 / 12 * 10 / 1).epsilon(1e-14));  // 11/(10 + 2)·10
    CHECK(row.landscape.elevation_m[2] == 2);
    CHECK(report.mass.eroded_m3 == Approx(100 * 2 * 11.0 / 12));
}

TEST_CASE("A node behind a sill that is cut below it within the step is dug in the same step") {
    // The sill falls from 10 to about 0.1 m, far below the old pit of 1 m: testing old heights would leave it at 2 m.
    Row row = row_of({0, 10, 1}, 10, 0.01);
    step(row.grid, {.k = 0.1, .m = 1, .n = 1}, row.setting, 100, row.landscape);
    CHECK(row.landscape.elevation_m[2] < 0.2);
    CHECK(row.landscape.elevation_m[2] > row.landscape.elevation_m[1]);
}

TEST_CASE("Rainfall weighs the cell areas") {
    Row row = row_of({0, 5, 11}, 10, 0.01);
    row.setting.rainfall = {0, 0.5, 2};
    const Drainage drainage = drain(row.grid, row.landscape, row.setting, terrain::Receiver::steepest);
    CHECK(drainage.area_m2 == std::vector<double>{250, 250, 200});
}

TEST_CASE("The lowest node of a piece without outlet stays where it is and takes the water") {
    Row row = row_of({7, 3, 5}, 10, 0.01);
    row.setting.boundary[0] = Boundary::interior;
    const StepReport report = step(row.grid, {.k = 1e-3, .m = 1, .n = 1}, row.setting, 100, row.landscape);
    CHECK(row.landscape.elevation_m[1] == 3);
    CHECK(row.landscape.elevation_m[0] == Approx(3 + 5.0 / 20 * 10));
    CHECK(report.mass.uplifted_m3 == Approx(200));
    CHECK(std::abs(report.mass.relative_residual()) < 1e-13);
}

TEST_CASE("Cells without data are in nobody's way") {
    Row row = row_of({0, 5, std::numeric_limits<double>::quiet_NaN(), 4, 9}, 10, 0.01);
    const StepReport report = step(row.grid, {.k = 1e-3, .m = 1, .n = 1}, row.setting, 100, row.landscape);
    CHECK(std::isnan(row.landscape.elevation_m[2]));
    CHECK(row.landscape.elevation_m[3] == 4);
    CHECK(report.mass.uplifted_m3 == Approx(200));
    CHECK(std::isfinite(report.mean_rate_m_per_yr));
}

TEST_CASE("The mass balance closes to 1e-9 for every exponent, with and without talus, on grid and mesh") {
    const Grid grid = plane_grid(24, 31, 100, 130);
    const Mesh mesh = support::lattice_mesh(25, 25, 120, 0.25, 3);
    std::uint64_t seed = 1;
    for (const double n : {0.3, 0.5, 0.7, 1.0, 1.5, 2.0, 5.0}) {
        for (const double talus : {std::numeric_limits<double>::infinity(), 0.06}) {
            const River river{.k = erodibility(0.5 * n, n), .m = 0.5 * n, .n = n, .talus_slope = talus};
            for (const double dt_yr : {100.0, 2e4, 1e6}) {
                check_balance(grid, river, dt_yr, ++seed);
                check_balance(mesh, river, dt_yr, ++seed);
            }
        }
    }
}

TEST_CASE("No node is left standing at the height the uplift alone would give, whatever the step") {
    const Grid grid = plane_grid(40, 40, 100, 100);
    const Setting setting = support::island(grid, 1e-3);
    for (const double n : {0.7, 1.0, 1.5}) {
        for (const double dt_yr : {2e4, 1e5, 1e6, 1e8}) {
            Landscape landscape = support::rough_start(setting, 0.01, 4);
            const River river{.k = erodibility(0.5, n), .m = 0.5, .n = n};
            for (int i = 0; i < 10; ++i) step(grid, river, setting, dt_yr, landscape);
            const double uplift_alone = 10 * dt_yr * 1e-3;
            CAPTURE(n, dt_yr);
            CHECK(*std::ranges::max_element(landscape.elevation_m) < 0.99 * uplift_alone);
        }
    }
}

TEST_CASE("The slope to no receiver exceeds the talus limit") {
    const Mesh mesh = support::lattice_mesh(30, 30, 100, 0.3, 5);
    const Setting setting = support::island(mesh, 1e-3);
    Landscape landscape = support::rough_start(setting, 500, 6);
    const River river{.k = 1e-6, .m = 0.5, .n = 1, .talus_slope = 0.6};
    for (int i = 0; i < 20; ++i) {
        const Drainage drainage = drain(mesh, landscape, setting, river.receiver);
        erode(mesh, drainage, river, setting, 5e4, landscape);
        double steepest = 0;
        for (Index node = 0; node < mesh.size(); ++node) {
            const Slot slot = drainage.directions[node];
            if (slot == no_flow) continue;
            const double drop = landscape.elevation_m[node] - landscape.elevation_m[mesh.neighbor(node, slot)];
            steepest = std::max(steepest, drop / mesh.length(node, slot));
        }
        CHECK(steepest <= 0.6 * (1 + 1e-12));
        CHECK(steepest > 0.59);
    }
}

TEST_CASE("A bowl drains over its lowest pass and is worn down from there") {
    const Grid grid = plane_grid(21, 21, 100, 100);
    const Setting setting = support::island(grid, 0);
    Landscape landscape;
    for (Index node = 0; node < grid.size(); ++node) {
        const double from_middle = std::hypot(grid.row(node) - 10.0, grid.col(node) - 10.0);
        const bool notch = node == grid.cols * 10 + 1;
        landscape.elevation_m.push_back(setting.boundary[node] == Boundary::base_level ? 0
                                        : notch                                        ? 20 + from_middle
                                                                                       : 20 + 5 * from_middle);
    }
    const Drainage drainage = drain(grid, landscape, setting, terrain::Receiver::steepest);
    CHECK(drainage.lakes == 1);
    CHECK(drainage.area_m2[grid.cols * 10 + 1] > 0.5e6);  // nearly all of the bowl's 400 cells leave by the notch
    const River river{.k = 1e-4, .m = 0.5, .n = 1};
    for (int i = 0; i < 50; ++i) step(grid, river, setting, 1e4, landscape);
    CHECK(drain(grid, landscape, setting, river.receiver).lakes == 0);
    CHECK(landscape.elevation_m[grid.cols * 10 + 10] < 5);
}

TEST_CASE("In metres and years or kilometres and thousands of years the landscape is the same") {
    // h' = h/1000, t' = t/1000, A' = A/1e6: k' = k·(1e6)^m·(1 m/yr is 1 km/kyr), with m = 0.4: k' = k·10^2.4.
    const Grid metres = plane_grid(30, 30, 512, 512);
    const Grid kilometres = plane_grid(30, 30, 0.512, 0.512);
    const Setting setting = support::island(metres, 1e-3);
    for (const double n : {1.0, 1.5}) {
        Landscape a = support::rough_start(setting, 1, 7);
        Landscape b = a;
        for (double& height : b.elevation_m) height /= 1000;
        const River river{.k = erodibility(0.4, n), .m = 0.4, .n = n};
        River scaled = river;
        scaled.k *= std::pow(10, 2.4);
        for (int i = 0; i < 5; ++i) {
            step(metres, river, setting, 5e4, a);
            step(kilometres, scaled, setting, 50, b);
        }
        double worst = 0;
        for (Index node = 0; node < metres.size(); ++node) {
            worst = std::max(worst, std::abs(a.elevation_m[node] - 1000 * b.elevation_m[node]));
        }
        CHECK(worst < 1e-10);
    }
}

TEST_CASE("A mirrored grid gives the mirrored landscape") {
    const Grid grid = plane_grid(33, 27, 100, 100);
    const Setting setting = support::island(grid, 1e-3);
    // A rough pyramid: neither pits nor ties, so that nothing hangs on the numbering.
    Landscape landscape = support::rough_start(setting, 9, 8);
    for (Index node = 0; node < grid.size(); ++node) {
        const Index r = grid.row(node), c = grid.col(node);
        landscape.elevation_m[node] += 10.0 * std::min({r, c, grid.rows - 1 - r, grid.cols - 1 - c});
    }
    REQUIRE(drain(grid, landscape, setting, terrain::Receiver::steepest).lakes == 0);
    const auto mirrored = [&](const std::vector<double>& values) {
        std::vector<double> turned(values.size());
        for (Index node = 0; node < grid.size(); ++node) {
            turned[grid.row(node) * grid.cols + grid.cols - 1 - grid.col(node)] = values[node];
        }
        return turned;
    };
    for (const double n : {0.7, 1.0, 2.0}) {
        Landscape a = landscape;
        Landscape b{.elevation_m = mirrored(landscape.elevation_m)};
        const River river{.k = erodibility(0.5, n), .m = 0.5, .n = n, .talus_slope = 0.8};
        step(grid, river, setting, 2e4, a);
        step(grid, river, setting, 2e4, b);
        const std::vector<double> back = mirrored(b.elevation_m);
        double worst = 0;
        for (Index node = 0; node < grid.size(); ++node) {
            worst = std::max(worst, std::abs(back[node] - a.elevation_m[node]));
        }
        CHECK(worst < 1e-12);
    }
}

TEST_CASE("Runs give the same bytes for one thread, two threads and a second time") {
    const Grid grid = plane_grid(150, 170, 100, 100);
    const Setting setting = support::island(grid, 1e-3);
    const auto run = [&](int threads) {
        const ThreadLimit limit(threads);
        Landscape landscape = support::rough_start(setting, 1, 9);
        simulate(grid, {{.k = 1e-5, .m = 0.45, .n = 1.2}}, setting,
                 {.step_yr = 2e4, .max_steps = 15, .convergence = 1e-3}, landscape);
        return landscape.elevation_m;
    };
    const auto once = run(1);
    CHECK(run(2) == once);
    CHECK(run(1) == once);
}

TEST_CASE("Frozen directions hold as long as they lead down") {
    const Grid grid = plane_grid(3, 3, 1, 1);
    Setting setting = support::island(grid, 0);
    setting.boundary.assign(9, Boundary::interior);
    setting.boundary[0] = setting.boundary[8] = Boundary::base_level;
    Landscape landscape{.elevation_m = {0, 9, 9, 9, 5, 4, 9, 3, 1}};
    FlowDirections frozen(9, no_flow);
    CHECK(drain(grid, landscape, setting, terrain::Receiver::steepest).directions[4] == 5);
    frozen[4] = 0;  // east, to 4 m
    CHECK(drain(grid, landscape, setting, terrain::Receiver::steepest, frozen).directions[4] == 0);
    landscape.elevation_m[5] = 5;  // level: no longer down
    CHECK(drain(grid, landscape, setting, terrain::Receiver::steepest, frozen).directions[4] == 5);
}

TEST_CASE("Parameters without meaning are refused in a sentence") {
    Row row = row_of({0, 5, 11}, 10, 0.01);
    const auto refused = [&](const River& river, double dt_yr) {
        CHECK_THROWS_AS(step(row.grid, river, row.setting, dt_yr, row.landscape), Error);
    };
    refused({.k = -1}, 100);
    refused({.k = std::numeric_limits<double>::quiet_NaN()}, 100);
    refused({.k = 1, .m = -0.1}, 100);
    refused({.k = 1, .n = 0.2}, 100);
    refused({.k = 1, .n = 5.1}, 100);
    refused({.k = 1, .talus_slope = 0}, 100);
    refused({.k = 1}, 0);
    refused({.k = 1}, std::numeric_limits<double>::infinity());
    row.setting.rainfall.pop_back();
    refused({.k = 1}, 100);
}
