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

/// The rim at base level, noise of 1 m inside.
template <class Topology>
struct Island {
    Island(const Topology& shape, std::vector<Boundary> boundary)
        : topology(shape),
          setting{std::vector<double>(shape.size(), 1e-3), std::vector<double>(shape.size(), 1.0),
                  std::move(boundary)} {}

    evolve::Landscape noise() const {
        evolve::Landscape landscape{0, evolve::uniform_surface(topology.size(), 1.0, 1)};
        for (Index node = 0; node < topology.size(); ++node) {
            if (setting.boundary[node] == Boundary::base_level) landscape.elevation_m[node] = 0;
        }
        return landscape;
    }
    void walk(const evolve::Model& model, Index count, evolve::Landscape& landscape) const {
        evolve::simulate(topology, model, setting, {.step_yr = 2e4, .max_steps = count, .convergence = 0},
                         landscape);
    }

    const Topology& topology;
    evolve::Setting setting;
};

Island<Grid> island(const Grid& grid) {
    auto boundary = terrain::data_edge(grid, std::vector<double>(grid.size(), 0.0));
    for (Boundary& b : boundary) b = b == Boundary::open ? Boundary::base_level : Boundary::interior;
    return {grid, std::move(boundary)};
}

Mesh square_mesh(Index nodes) {
    const double side = 100 * std::sqrt(static_cast<double>(nodes));
    const Polygon square{{0, 0}, {side, 0}, {side, side}, {0, side}};
    return mesh::triangulate(square, mesh::poisson_disk_count(square, nodes, 1));
}

Island<Mesh> island(const Mesh& mesh) {
    std::vector<Boundary> boundary;
    for (const auto on : mesh.on_outline) boundary.push_back(on ? Boundary::base_level : Boundary::interior);
    return {mesh, std::move(boundary)};
}

evolve::River river_of(const benchmark::State& state) {
    return {.k = 2e-5, .m = 0.01 * static_cast<double>(state.range(2)), .n = 0.1 * static_cast<double>(state.range(3))};
}

template <class Topology>
void run(benchmark::State& state, const Island<Topology>& island, const evolve::Model& model, Index steps_before) {
    evolve::Landscape start = island.noise();
    if (steps_before > 0) island.walk(model, steps_before, start);
    for (auto _ : state) {
        evolve::Landscape landscape = start;
        island.walk(model, steps, landscape);
        benchmark::DoNotOptimize(landscape);
    }
    per_item(state, static_cast<double>(island.topology.size()) * steps);
}

void raster_steps(benchmark::State& state) {
    const Grid grid = plane_grid(static_cast<Index>(state.range(0)), static_cast<Index>(state.range(0)), 100, 100);
    const ThreadLimit limit(static_cast<int>(state.range(1)));
    run(state, island(grid), {river_of(state)}, 0);
}
BENCHMARK(raster_steps)
    ->ArgNames({"size", "threads", "100m", "10n"})
    ->Args({1000, 1, 50, 10})
    ->Args({1000, 1, 40, 10})
    ->Args({1000, 1, 50, 15})
    ->Args({1000, 1, 50, 13})
    ->Args({2000, 1, 50, 10})
    ->Args({2000, 2, 50, 10})
    ->Args({4000, 1, 50, 10})
    ->Unit(benchmark::kMillisecond)
    ->Iterations(1)
    ->UseRealTime();

/// After the lakes are gone: with m = 0.5 within the first 100 steps.
void raster_steps_without_lakes(benchmark::State& state) {
    const Grid grid = plane_grid(static_cast<Index>(state.range(0)), static_cast<Index>(state.range(0)), 100, 100);
    const ThreadLimit limit(static_cast<int>(state.range(1)));
    run(state, island(grid), {river_of(state)}, 100);
}
BENCHMARK(raster_steps_without_lakes)
    ->ArgNames({"size", "threads", "100m", "10n"})
    ->Args({1000, 1, 50, 10})
    ->Args({2000, 1, 50, 10})
    ->Args({2000, 2, 50, 10})
    ->Unit(benchmark::kMillisecond)
    ->Iterations(1)
    ->UseRealTime();

void raster_steps_divided(benchmark::State& state) {
    const Grid grid = plane_grid(static_cast<Index>(state.range(0)), static_cast<Index>(state.range(0)), 100, 100);
    const ThreadLimit limit(static_cast<int>(state.range(1)));
    evolve::River river = river_of(state);
    river.flow = evolve::Flow::multiple;
    run(state, island(grid), {river}, 0);
}
BENCHMARK(raster_steps_divided)
    ->ArgNames({"size", "threads", "100m", "10n"})
    ->Args({1000, 1, 50, 10})
    ->Args({1000, 2, 50, 10})
    ->Args({1000, 1, 50, 15})
    ->Unit(benchmark::kMillisecond)
    ->Iterations(1);

void tin_steps(benchmark::State& state) {
    const Mesh mesh = square_mesh(static_cast<Index>(state.range(0)));
    const ThreadLimit limit(static_cast<int>(state.range(1)));
    run(state, island(mesh), {river_of(state)}, 0);
}
BENCHMARK(tin_steps)
    ->ArgNames({"nodes", "threads", "100m", "10n"})
    ->Args({100000, 1, 50, 10})
    ->Args({1000000, 1, 50, 10})
    ->Args({1000000, 2, 50, 10})
    ->Args({1000000, 1, 40, 10})
    ->Unit(benchmark::kMillisecond)
    ->Iterations(1)
    ->UseRealTime();

/// Bell's case, 100 km square: the steady solver, per node and sweep; the counter gives the sweeps.
void steady_tin(benchmark::State& state) {
    const Mesh mesh = square_mesh(static_cast<Index>(state.range(0)));
    const Island<Mesh> on = island(mesh);
    const ThreadLimit limit(static_cast<int>(state.range(1)));
    Index sweeps = 0;
    for (auto _ : state) {
        evolve::Landscape landscape = on.noise();
        sweeps = evolve::solve_steady(mesh, river_of(state), on.setting, 5000, landscape).sweeps;
    }
    state.counters["sweeps"] = sweeps;
    per_item(state, static_cast<double>(mesh.size()) * sweeps);
}
BENCHMARK(steady_tin)
    ->ArgNames({"nodes", "threads", "100m", "10n"})
    ->Args({100000, 1, 50, 10})
    ->Args({100000, 2, 50, 10})
    ->Unit(benchmark::kMillisecond)
    ->Iterations(1)
    ->UseRealTime();

/// One river of ten million nodes: no layer has more than one, and nothing may recurse.
void single_river(benchmark::State& state) {
    const auto nodes = static_cast<Index>(state.range(0));
    const Grid grid = plane_grid(1, nodes, 100, 100);
    evolve::Setting setting{std::vector<double>(nodes, 1e-3), std::vector<double>(nodes, 1.0),
                            std::vector<Boundary>(nodes, Boundary::interior)};
    setting.boundary[0] = Boundary::base_level;
    evolve::Landscape landscape;
    for (Index node = 0; node < nodes; ++node) landscape.elevation_m.push_back(1e-3 * node);
    for (auto _ : state) {
        evolve::simulate(grid, {.river = {.k = 2e-5}}, setting, {.step_yr = 2e4, .max_steps = 5, .convergence = 0},
                         landscape);
    }
    per_item(state, 5.0 * nodes);
}
BENCHMARK(single_river)->Arg(1000000)->Arg(10000000)->Unit(benchmark::kMillisecond)->Iterations(1)->UseRealTime();

/// The same with deposition (G = 1), or with creep after the rivers: linear, or with a critical slope of 0.8.
void with_process(benchmark::State& state, evolve::Model model) {
    const ThreadLimit limit(1);
    const Grid grid = plane_grid(static_cast<Index>(state.range(0)), static_cast<Index>(state.range(0)), 100, 100);
    run(state, island(grid), model, 0);
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
