// SPDX-License-Identifier: GPL-3.0-or-later
// The sweep over layers, eight nodes at a time and by parts, against the same sweep one node after the other.
#include <catch2/catch.hpp>
#include <cmath>
#include <limits>

#include "support/lattice_mesh.hpp"
#include "support/settings.hpp"
#include "thalweg/core/parallel.hpp"
#include "thalweg/evolve/simulate.hpp"

using namespace thalweg;
using namespace thalweg::evolve;

namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();

double erodibility(double m, double n) { return 1e-3 / (std::pow(1e6, m) * std::pow(0.05, n)); }

Drainage without_layers(Drainage drainage) {
    drainage.layers = {};
    return drainage;
}

/// The last bits of sums depend on the order of adding.
void check_close(const MassBalance& a, const MassBalance& b) {
    CHECK(a.uplifted_m3 == Approx(b.uplifted_m3).epsilon(1e-12));
    CHECK(a.eroded_m3 == Approx(b.eroded_m3).epsilon(1e-12));
    CHECK(a.talus_m3 == Approx(b.talus_m3).epsilon(1e-12));
    CHECK(a.stored_m3 == Approx(b.stored_m3).margin(1e-12 * b.uplifted_m3));
}

template <class T>
void check_sweeps(const T& topology, Setting setting, std::uint64_t seed) {
    for (Index node = 0; node < topology.size(); ++node) {
        setting.uplift_m_per_yr[node] *= 0.5 + uniform_at(seed, 8, node);
        setting.rainfall[node] = node % 11 == 0 ? 0 : uniform_at(seed, 9, node);
    }
    for (const double n : {0.5, 1.0, 1.3, 1.5, 3.0}) {
        for (const double m : {0.4, 0.5, 1.0}) {
            for (const double talus : {infinity, 0.3}) {
                Landscape layered = support::rough_start(setting, 40, seed);
                Landscape plain = layered;
                const River river{.k = erodibility(m, n), .m = m, .n = n, .talus_slope = talus};
                for (int i = 0; i < 3; ++i) {
                    const Drainage drainage = drain(topology, layered, setting, river);
                    const StepReport fast = erode(topology, drainage, river, setting, 2e4, layered);
                    const StepReport slow = erode(topology, without_layers(drainage), river, setting, 2e4, plain);
                    check_close(fast.mass, slow.mass);
                    CHECK(fast.max_rate_m_per_yr == slow.max_rate_m_per_yr);
                    CHECK(fast.largest_newton_iterations == slow.largest_newton_iterations);
                }
                CAPTURE(n, m, talus);
                CHECK(layered.elevation_m == plain.elevation_m);
            }
        }
    }
}

}  // namespace

TEST_CASE("Eight nodes at a time give the same heights, bit for bit, as one after the other") {
    const Grid grid = plane_grid(70, 81, 100, 130);
    check_sweeps(grid, support::island(grid, 1e-3), 1);
    Setting hard = support::island(grid, 1e-3);
    for (Index node = 0; node < grid.size(); ++node) hard.relative_erodibility.push_back(0.2 + node % 3);
    check_sweeps(grid, hard, 2);
    const Mesh mesh = support::lattice_mesh(61, 63, 120, 0.25, 3);
    check_sweeps(mesh, support::island(mesh, 1e-3), 4);
}

TEST_CASE("In a landscape of several blocks too, on 1, 2, 3 and 7 threads") {
    const Grid grid = plane_grid(420, 400, 100, 100);
    const Setting setting = support::island(grid, 1e-3);
    const River river{.k = erodibility(0.45, 1.2), .m = 0.45, .n = 1.2};
    Landscape plain = support::rough_start(setting, 1, 5);
    const Landscape start = plain;
    for (int i = 0; i < 4; ++i) {
        const Drainage drainage = without_layers(drain(grid, plain, setting, river));
        erode(grid, drainage, river, setting, 2e4, plain);
    }
    for (const int threads : {1, 2, 3, 7}) {
        const ThreadLimit limit(threads);
        Landscape layered = start;
        simulate(grid, {.river = river}, setting, {.step_yr = 2e4, .max_steps = 4, .convergence = 0}, layered);
        CHECK(layered.elevation_m == plain.elevation_m);
    }
}

TEST_CASE("A single river of a million nodes takes its step") {
    const Index count = 1000000;
    const Grid grid = plane_grid(1, count, 100, 100);
    Setting setting{.uplift_m_per_yr = std::vector<double>(count, 1e-3),
                    .rainfall = std::vector<double>(count, 1.0),
                    .boundary = std::vector<Boundary>(count, Boundary::interior)};
    setting.boundary[0] = Boundary::base_level;
    Landscape landscape;
    for (Index node = 0; node < count; ++node) landscape.elevation_m.push_back(1e-3 * node);
    simulate(grid, {.river = {.k = 2e-5}}, setting, {.step_yr = 1e4, .max_steps = 2, .convergence = 0}, landscape);
    CHECK(landscape.elevation_m[0] == 0);
    bool rises = true;
    for (Index node = 1; node < count; ++node) {
        rises = rises && landscape.elevation_m[node] > landscape.elevation_m[node - 1];
    }
    CHECK(rises);
}
