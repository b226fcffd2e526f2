// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <limits>

#include "support/divided_flow.hpp"
#include "support/lattice_mesh.hpp"
#include "support/settings.hpp"
#include "thalweg/core/parallel.hpp"
#include "thalweg/evolve/simulate.hpp"

using namespace thalweg;
using namespace thalweg::evolve;

namespace {

River laying_down(double k, double m, double n, double g) {
    River river{.k = k, .m = m, .n = n};
    river.flow = Flow::multiple;
    river.g = g;
    return river;
}

/// k that gives slopes of a few per cent at A = 1e6 m² under 1 mm/yr, whatever m and n.
double erodibility(double m, double n) { return 1e-3 / (std::pow(1e6, m) * std::pow(0.05, n)); }

/// How far the heights after a step are from the equations, over the largest term: b − h = dt·k·A^m·Σ w·S^n − (G/A)·q,
/// with q = a·(b − h) + Wᵀ·q solved on the dense matrix.
template <class T>
double misfit(const T& topology, const Drainage& drainage, const River& river, const Setting& setting, double dt_yr,
              const std::vector<double>& before, const std::vector<double>& after) {
    std::vector<double> lost(before.size(), 0.0), volume(before.size(), 0.0);
    for (const Index node : drainage.order) {
        if (drainage.directions[node] == no_flow) continue;
        lost[node] = before[node] + dt_yr * setting.uplift_m_per_yr[node] - after[node];
        volume[node] = topology.area(node) * lost[node];
    }
    const std::vector<double> sediment = support::accumulate_by_elimination(drainage.flow, volume);
    double worst = 0, largest = 0;
    for (const Index node : drainage.order) {
        if (drainage.directions[node] == no_flow) continue;
        double power = 0;
        drainage.flow.receivers(node, [&](Index receiver, double length, double share) {
            power += share * std::pow(std::max(0.0, after[node] - after[receiver]) / length, river.n);
        });
        const double incision = dt_yr * river.k * std::pow(drainage.area_m2[node], river.m) * power;
        const double deposit = river.g / drainage.area_m2[node] * sediment[node];
        worst = std::max(worst, std::abs(lost[node] - incision + deposit));
        largest = std::max({largest, incision, std::abs(deposit)});
    }
    return worst / largest;
}

/// A rough pyramid: neither pits nor ties, so that nothing hangs on passes and numbering.
Landscape pyramid(const Grid& grid, const Setting& setting) {
    Landscape landscape = support::rough_start(setting, 9, 8);
    for (Index node = 0; node < grid.size(); ++node) {
        const Index r = grid.row(node), c = grid.col(node);
        landscape.elevation_m[node] += 10.0 * std::min({r, c, grid.rows - 1 - r, grid.cols - 1 - c});
    }
    return landscape;
}

}  // namespace

TEST_CASE("After a step with sediment along divided flow every node satisfies its equation") {
    const Grid grid = plane_grid(14, 13, 100, 130);
    const Setting setting = support::island(grid, 1e-3);
    for (const double n : {0.5, 1.0, 1.5, 3.0}) {
        for (const double g : {0.1, 1.0, 5.0}) {
            for (const double dt_yr : {100.0, 2e4, 1e6}) {
                Landscape landscape = pyramid(grid, setting);
                const River river = laying_down(erodibility(0.5, n), 0.5, n, g);
                const Drainage drainage = drain(grid, landscape, setting, river);
                const std::vector<double> before = landscape.elevation_m;
                const StepReport report = erode(grid, drainage, river, setting, dt_yr, landscape);
                CAPTURE(n, g, dt_yr, report.sediment_iterations);
                CHECK(report.sediment_converged);
                CHECK(misfit(grid, drainage, river, setting, dt_yr, before, landscape.elevation_m) < 1e-8);
                CHECK(std::abs(report.mass.relative_residual()) < 1e-8);
            }
        }
    }
}

TEST_CASE("At rest divided rivers that lay down sediment stand at the slope that carries it, on grid and mesh") {
    const auto check = [](const auto& topology, double n, double g) {
        const double uplift = 1e-3, m = 0.5 * n;
        const River river = laying_down(erodibility(m, n), m, n, g);
        const Setting setting = support::island(topology, uplift);
        Landscape landscape = support::rough_start(setting, 10, 4);
        const SimulationResult result =
            simulate(topology, {river}, setting, {.step_yr = 2e5, .max_steps = 2500, .convergence = 1e-10}, landscape);
        const Drainage drainage = drain(topology, landscape, setting, river);
        const std::vector<double> slope = slopes_along_flow(topology, drainage, river, landscape);
        double worst = 0;
        for (const Index node : drainage.order) {
            if (drainage.directions[node] == no_flow) continue;
            const double expected =
                std::pow((1 + g) * uplift / river.k, 1 / n) * std::pow(drainage.area_m2[node], -m / n);
            worst = std::max(worst, std::abs(slope[node] / expected - 1));
        }
        CAPTURE(n, g, result.steps, result.largest_sediment_iterations);
        CHECK(worst < 1e-6);
    };
    for (const double g : {0.5, 2.0}) {
        check(plane_grid(11, 12, 100, 100), 1, g);
        check(support::lattice_mesh(10, 11, 100, 0.2, 3), 1.5, g);
    }
}

TEST_CASE("With a very large exponent of the flow sediment is laid down as along one receiver") {
    const Grid grid = plane_grid(25, 25, 100, 100);
    const Setting setting = support::island(grid, 1e-3);
    for (const double n : {1.0, 1.5}) {
        Landscape divided = pyramid(grid, setting), single = divided;
        River river = laying_down(erodibility(0.5, n), 0.5, n, 1);
        river.flow_exponent = 1e9;
        River of_one = river;
        of_one.flow = Flow::single;
        for (int i = 0; i < 5; ++i) {
            erode(grid, drain(grid, divided, setting, river), river, setting, 1e4, divided);
            erode(grid, drain(grid, single, setting, of_one), of_one, setting, 1e4, single);
        }
        double worst = 0;
        for (Index node = 0; node < grid.size(); ++node) {
            worst = std::max(worst, std::abs(divided.elevation_m[node] - single.elevation_m[node]));
        }
        CHECK(worst < 1e-7);
    }
}

TEST_CASE("With lakes, talus and sediment along divided flow the mass balance closes, on grid and mesh") {
    const auto check = [](const auto& topology, double talus, std::uint64_t seed) {
        River river = laying_down(erodibility(0.5, 1), 0.5, 1, 1);
        river.talus_slope = talus;
        const Setting setting = support::island(topology, 1e-3);
        Landscape landscape = support::rough_start(setting, 100, seed);
        const SimulationResult result =
            simulate(topology, {river}, setting, {.step_yr = 1e4, .max_steps = 40, .convergence = 0}, landscape);
        CHECK(result.mass.deposited_m3 > 0);
        CHECK(std::abs(result.mass.relative_residual()) < 1e-8);
        CHECK(result.unconverged_sediment_steps == 0);
    };
    for (const double talus : {std::numeric_limits<double>::infinity(), 0.1}) {
        check(plane_grid(25, 22, 100, 110), talus, 3);
        check(support::lattice_mesh(22, 24, 100, 0.2, 3), talus, 4);
    }
}

namespace {

/// A block that rises in the north, dissected by one valley in the middle column, over a flat foreland; water leaves in
/// the south.
struct Front {
    Grid grid = plane_grid(60, 81, 200, 200);
    Setting setting = support::island(grid, 0);
    Landscape start;

    Front() {
        for (Index node = 0; node < grid.size(); ++node) {
            const Index r = grid.row(node);
            const double from_axis = std::abs(static_cast<double>(grid.col(node)) - 40);
            setting.boundary[node] = r == 59 ? Boundary::base_level : Boundary::interior;
            if (r < 25) setting.uplift_m_per_yr[node] = 1e-3;
            const double foreland = 0.02 * (59 - r);
            start.elevation_m.push_back(r < 25 ? 20 + 3 * (25 - r) + 8 * from_axis : foreland);
        }
    }
};

}  // namespace

TEST_CASE("A valley that leaves a mountain front builds a fan: convex across, the same to both sides") {
    const Front front;
    const auto after = [&](Flow flow) {
        River river = laying_down(4e-6, 0.5, 1, 2);
        river.flow = flow;
        Landscape landscape = front.start;
        simulate(front.grid, {river}, front.setting, {.step_yr = 2e3, .max_steps = 60, .convergence = 0}, landscape);
        return landscape.elevation_m;
    };
    const std::vector<double> z = after(Flow::multiple);
    const auto at = [&](Index r, Index c) { return z[r * 81 + c]; };
    for (const Index r : {33, 38, 45}) {
        CAPTURE(r);
        for (Index c = 0; c < 40; ++c) CHECK(at(r, c) == Approx(at(r, 80 - c)).epsilon(1e-6));
        CHECK(at(r, 40) > at(r, 35));
        CHECK(at(r, 35) > at(r, 30));
        CHECK(at(r, 30) > at(r, 20));
        CHECK(at(r, 20) > at(r, 10));
        CHECK(at(r, 40) > 0.02 * (59 - r) + 4);
    }
}
