// SPDX-License-Identifier: GPL-3.0-or-later
// Stream-power steps from noise with lakes, per node and step: uplift 1e-3 m/yr, k 2e-5, 100 m between nodes, steps of
// 2e4 yr, the rim fixed. One iteration is the first 50 steps.
#include "cases.hpp"
#include "thalweg/evolve/simulate.hpp"
#include "thalweg/mesh/triangulate.hpp"
#include "thalweg/terrain/route.hpp"

namespace thalweg::bench {
namespace {

constexpr Index steps = 50;

template <class Topology>
void run(benchmark::State& state, const Topology& topology, const std::vector<Boundary>& boundary,
         const evolve::Model& model) {
    const evolve::Setting setting{std::vector<double>(topology.size(), 1e-3), std::vector<double>(topology.size(), 1.0),
                                  boundary};
    for (auto _ : state) {
        evolve::Landscape landscape{0, evolve::uniform_surface(topology.size(), 1.0, 1)};
        for (Index node = 0; node < topology.size(); ++node) {
            if (boundary[node] == Boundary::base_level) landscape.elevation_m[node] = 0;
        }
        evolve::simulate(topology, model, setting, {.step_yr = 2e4, .max_steps = steps, .convergence = 0}, landscape);
        benchmark::DoNotOptimize(landscape);
    }
    per_item(state, static_cast<double>(topology.size()) * steps);
}

void raster(benchmark::State& state, evolve::Flow flow) {
    const auto size = static_cast<Index>(state.range(0));
    const ThreadLimit limit(static_cast<int>(state.range(1)));
    const Grid grid = plane_grid(size, size, 100, 100);
    auto boundary = terrain::data_edge(grid, std::vector<double>(grid.size(), 0.0));
    for (Boundary& b : boundary) b = b == Boundary::open ? Boundary::base_level : Boundary::interior;
    const double m = 0.01 * static_cast<double>(state.range(2)), n = 0.1 * static_cast<double>(state.range(3));
    run(state, grid, boundary, {.river = {.k = 2e-5, .m = m, .n = n, .flow = flow}});
}

void raster_steps(benchmark::State& state) { raster(state, evolve::Flow::single); }
void raster_steps_divided(benchmark::State& state) { raster(state, evolve::Flow::multiple); }
BENCHMARK(raster_steps)
    ->ArgNames({"size", "threads", "100m", "10n"})
    ->Args({1000, 1, 50, 10})
    ->Args({1000, 2, 50, 10})
    ->Args({1000, 1, 40, 10})
    ->Args({1000, 1, 50, 15})
    ->Args({2000, 1, 50, 10})
    ->Unit(benchmark::kMillisecond)
    ->Iterations(1);

BENCHMARK(raster_steps_divided)
    ->ArgNames({"size", "threads", "100m", "10n"})
    ->Args({1000, 1, 50, 10})
    ->Args({1000, 2, 50, 10})
    ->Args({1000, 1, 50, 15})
    ->Unit(benchmark::kMillisecond)
    ->Iterations(1);

void tin_steps(benchmark::State& state) {
    const double side = 100 * std::sqrt(static_cast<double>(state.range(0)));
    const Polygon square{{0, 0}, {side, 0}, {side, side}, {0, side}};
    const Mesh mesh =
        mesh::triangulate(square, mesh::poisson_disk_count(square, static_cast<Index>(state.range(0)), 1));
    std::vector<Boundary> boundary;
    for (const auto on : mesh.on_outline) boundary.push_back(on ? Boundary::base_level : Boundary::interior);
    const ThreadLimit limit(static_cast<int>(state.range(1)));
    run(state, mesh, boundary, {.river = {.k = 2e-5, .m = 0.01 * static_cast<double>(state.range(2)), .n = 1}});
}
BENCHMARK(tin_steps)
    ->ArgNames({"nodes", "threads", "100m"})
    ->Args({100000, 1, 50})
    ->Args({1000000, 1, 50})
    ->Args({1000000, 1, 40})
    ->Unit(benchmark::kMillisecond)
    ->Iterations(1);

/// The same with deposition (G = 1), or with creep after the rivers: linear, or with a critical slope of 0.8.
void with_process(benchmark::State& state, evolve::Model model) {
    const auto size = static_cast<Index>(state.range(0));
    const ThreadLimit limit(1);
    const Grid grid = plane_grid(size, size, 100, 100);
    auto boundary = terrain::data_edge(grid, std::vector<double>(grid.size(), 0.0));
    for (Boundary& b : boundary) b = b == Boundary::open ? Boundary::base_level : Boundary::interior;
    run(state, grid, boundary, model);
}

void raster_steps_with_deposition(benchmark::State& state) {
    const double n = 0.1 * static_cast<double>(state.range(1));
    with_process(state, {.river = {.k = 2e-5, .m = 0.5, .n = n, .g = 1}});
}
BENCHMARK(raster_steps_with_deposition)
    ->ArgNames({"size", "10n"})
    ->Args({500, 10})
    ->Args({1000, 10})
    ->Args({1000, 15})
    ->Unit(benchmark::kMillisecond)
    ->Iterations(1);

void raster_steps_with_creep(benchmark::State& state) {
    with_process(state, {.river = {.k = 2e-5, .m = 0.5, .n = 1},
                         .hillslope = {.diffusivity_m2_per_yr = 0.01,
                                       .critical_slope = 0.1 * static_cast<double>(state.range(1))}});
}
BENCHMARK(raster_steps_with_creep)
    ->ArgNames({"size", "10Sc"})
    ->Args({500, 0})
    ->Args({1000, 0})
    ->Args({250, 8})
    ->Args({500, 8})
    ->Unit(benchmark::kMillisecond)
    ->Iterations(1);

}  // namespace
}  // namespace thalweg::bench
