// SPDX-License-Identifier: GPL-3.0-or-later
// Bell's (2024) largest case: 99 927 vertices on 32 768 m, u = 4e-4 m/yr, k = 5.6e-7 /yr, the lowest neighbour as
// receiver, talus 30°, steps of 250 000 yr, the rim as outlet, noise of 1 cm. The mesh is part of the time: 200 steps,
// steps until the mean rate is under 1 % of u (by seeds), and the steady solver. On all threads.
#include <numbers>

#include "cases.hpp"
#include "thalweg/evolve/simulate.hpp"
#include "thalweg/mesh/triangulate.hpp"

namespace thalweg::bench {
namespace {

constexpr double side_m = 32768;
constexpr double uplift_m_per_yr = 4e-4;

/// Mesh, setting and first surface of one seed.
struct BellCase {
    explicit BellCase(Index nodes, std::uint64_t seed)
        : mesh(mesh::triangulate(square, mesh::poisson_disk_count(square, nodes, seed))),
          setting{std::vector<double>(mesh.size(), uplift_m_per_yr), std::vector<double>(mesh.size(), 1.0), {}},
          landscape{0, evolve::uniform_surface(mesh.size(), 0.01, seed)} {
        for (Index node = 0; node < mesh.size(); ++node) {
            const bool rim = mesh.on_outline[node] != 0;
            setting.boundary.push_back(rim ? Boundary::base_level : Boundary::interior);
            if (rim) landscape.elevation_m[node] = 0;
        }
    }
    Index simulate(Index steps, double convergence) {
        return evolve::simulate(mesh, {river}, setting,
                                {.step_yr = 250000, .max_steps = steps, .convergence = convergence}, landscape)
            .steps;
    }

    const Polygon square{{0, 0}, {side_m, 0}, {side_m, side_m}, {0, side_m}};
    const evolve::River river{
        .k = 5.6e-7, .talus_slope = std::tan(std::numbers::pi / 6), .receiver = terrain::Receiver::lowest};
    Mesh mesh;
    evolve::Setting setting;
    evolve::Landscape landscape;
};

constexpr Index largest = 99927;

void bell_200_steps(benchmark::State& state) {
    for (auto _ : state) BellCase(largest, 1).simulate(200, 0);
}
BENCHMARK(bell_200_steps)->Unit(benchmark::kMillisecond)->Iterations(1)->UseRealTime();

void bell_to_rest(benchmark::State& state) {
    Index steps = 0;
    for (auto _ : state) steps = BellCase(largest, static_cast<std::uint64_t>(state.range(0))).simulate(5000, 0.01);
    state.counters["steps"] = steps;
}
BENCHMARK(bell_to_rest)
    ->ArgName("seed")
    ->DenseRange(1, 10)
    ->Unit(benchmark::kMillisecond)
    ->Iterations(1)
    ->UseRealTime();

void bell_steady(benchmark::State& state) {
    evolve::SteadyResult result{};
    for (auto _ : state) {
        BellCase bell(largest, static_cast<std::uint64_t>(state.range(0)));
        result = evolve::solve_steady(bell.mesh, bell.river, bell.setting, 5000, bell.landscape);
    }
    state.counters["sweeps"] = result.sweeps;
    state.counters["converged"] = result.converged;
    state.counters["frozen"] = result.frozen_receivers;
}
BENCHMARK(bell_steady)->ArgName("seed")->DenseRange(1, 3)->Unit(benchmark::kMillisecond)->Iterations(1)->UseRealTime();

}  // namespace
}  // namespace thalweg::bench
