// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>

#include "support/lattice_mesh.hpp"
#include "support/settings.hpp"
#include "support/temp_folder.hpp"
#include "thalweg/evolve/simulate.hpp"

using namespace thalweg;
using namespace thalweg::evolve;

namespace {

/// Three kinds of rock, by the number of the node.
std::vector<double> three_rocks(Index count) {
    std::vector<double> relative(count);
    for (Index node = 0; node < count; ++node) relative[node] = node % 3 == 0 ? 1.0 : node % 3 == 1 ? 0.5 : 0.2;
    return relative;
}

template <class T>
double worst_steady_slope(const T& topology, const River& river, const Setting& setting, const Landscape& landscape) {
    const Drainage drainage = drain(topology, landscape, setting, river.receiver);
    double worst = 0;
    for (const Index node : drainage.order) {
        const Slot slot = drainage.directions[node];
        if (slot == no_flow) continue;
        const double drop = landscape.elevation_m[node] - landscape.elevation_m[topology.neighbor(node, slot)];
        const double k = river.k * setting.relative_erodibility[node];
        const double expected = std::pow(1e-3 / (k * std::pow(drainage.area_m2[node], river.m)), 1 / river.n);
        worst = std::max(worst, std::abs(drop / topology.length(node, slot) / expected - 1));
    }
    return worst;
}

template <class T>
void check_rocks(const T& topology) {
    Setting setting = support::island(topology, 1e-3);
    setting.relative_erodibility = three_rocks(topology.size());
    for (const double n : {0.7, 1.0, 2.0}) {
        const River river{.k = 1e-3 / (std::pow(1e6, 0.5 * n) * std::pow(0.05, n)), .m = 0.5 * n, .n = n};
        Landscape solved = support::rough_start(setting, 1, 4);
        const SteadyResult steady = solve_steady(topology, river, setting, 500, solved);
        CHECK(steady.converged);
        CHECK(steady.frozen_receivers == 0);
        CHECK(worst_steady_slope(topology, river, setting, solved) < 1e-9);
        // Time stepping from there stays there.
        Landscape stepped = solved;
        const Drainage drainage = drain(topology, stepped, setting, river.receiver);
        erode(topology, drainage, river, setting, 1e4, stepped);
        for (Index node = 0; node < topology.size(); ++node) {
            CHECK(stepped.elevation_m[node] == Approx(solved.elevation_m[node]).epsilon(1e-9).margin(1e-9));
        }
    }
}

}  // namespace

TEST_CASE("Where rock varies every node stands at the steady slope of its own erodibility") {
    check_rocks(plane_grid(17, 19, 100, 100));
    check_rocks(support::lattice_mesh(15, 16, 100, 0.2, 3));
}

TEST_CASE("A relative erodibility of 1 everywhere is the same as none, and half of it the same as half of k") {
    const Grid grid = plane_grid(20, 20, 100, 100);
    Setting setting = support::island(grid, 1e-3);
    const auto after = [&](double k) {
        Landscape landscape = support::rough_start(setting, 5, 2);
        simulate(grid, {{.k = k, .m = 0.5, .n = 1.3}}, setting, {.step_yr = 1e4, .max_steps = 30}, landscape);
        return landscape.elevation_m;
    };
    const auto plain = after(4e-6), harder = after(2e-6);
    setting.relative_erodibility.assign(grid.size(), 1.0);
    CHECK(after(4e-6) == plain);
    setting.relative_erodibility.assign(grid.size(), 0.5);
    CHECK(after(4e-6) == harder);
    CHECK(harder != plain);
}

TEST_CASE("A relative erodibility of another size than the landscape is refused") {
    const Grid grid = plane_grid(5, 5, 100, 100);
    Setting setting = support::island(grid, 1e-3);
    setting.relative_erodibility.assign(24, 1.0);
    Landscape landscape = support::rough_start(setting, 1, 1);
    const auto error = test::error_of([&] { solve_steady(grid, {.k = 1e-5}, setting, 10, landscape); });
    CHECK(test::is_sentence(error));
}
