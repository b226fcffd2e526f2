// SPDX-License-Identifier: GPL-3.0-or-later
// The chain from a DEM to drainage areas, per cell, on one thread and on two.
#include "cases.hpp"
#include "thalweg/terrain/accumulate.hpp"
#include "thalweg/terrain/d_infinity.hpp"
#include "thalweg/terrain/flats.hpp"
#include "thalweg/terrain/lakes.hpp"
#include "thalweg/terrain/multiple_flow.hpp"
#include "thalweg/terrain/route.hpp"

namespace thalweg::bench {
namespace {

struct Dem {
    Grid grid;
    std::vector<double> z;
    std::vector<Boundary> boundary;
};

Dem rough_dem(const benchmark::State& state) {
    const auto size = static_cast<Index>(state.range(0));
    Dem dem{plane_grid(size, size, 30, 30), {}, {}};
    dem.z = rough_terrain(dem.grid);
    dem.boundary = terrain::data_edge(dem.grid, dem.z);
    return dem;
}

void fill(benchmark::State& state) {
    const Dem dem = rough_dem(state);
    const ThreadLimit limit(static_cast<int>(state.range(1)));
    for (auto _ : state) benchmark::DoNotOptimize(terrain::fill(dem.grid, dem.z, dem.boundary));
    per_item(state, dem.grid.size());
}

void route(benchmark::State& state) {
    const Dem dem = rough_dem(state);
    const ThreadLimit limit(static_cast<int>(state.range(1)));
    for (auto _ : state) benchmark::DoNotOptimize(terrain::route(dem.grid, dem.z, dem.boundary));
    per_item(state, dem.grid.size());
}

auto chain(const Dem& dem) {
    const auto filled = terrain::fill(dem.grid, dem.z, dem.boundary);
    auto directions = terrain::route(dem.grid, filled, dem.boundary);
    terrain::resolve_flats(dem.grid, filled, dem.boundary, directions);
    return terrain::graph_and_area(dem.grid, filled, std::move(directions));
}

void fill_flats_route_area(benchmark::State& state) {
    const Dem dem = rough_dem(state);
    const ThreadLimit limit(static_cast<int>(state.range(1)));
    for (auto _ : state) benchmark::DoNotOptimize(chain(dem));
    per_item(state, dem.grid.size());
}

/// The same on terrains of 4e5 to 1e8 cells that are as rough from cell to cell, whatever their number.
void chain_by_cells(benchmark::State& state) {
    const auto side = static_cast<Index>(state.range(0));
    Dem dem{plane_grid(side, side, 30, 30), {}, {}};
    dem.z = evenly_rough_terrain(dem.grid);
    dem.boundary = terrain::data_edge(dem.grid, dem.z);
    const ThreadLimit limit(static_cast<int>(state.range(1)));
    for (auto _ : state) benchmark::DoNotOptimize(chain(dem));
    state.counters["cells"] = dem.grid.size();
    per_item(state, dem.grid.size());
}
BENCHMARK(chain_by_cells)
    ->ArgNames({"side", "threads"})
    ->ArgsProduct({{625, 1250, 2500, 5000, 10000}, {1, 2}})
    ->Unit(benchmark::kMillisecond)
    ->UseRealTime();

/// Filled, with flats resolved: what flow divides on.
struct RoutedDem {
    Dem dem;
    FlowDirections single;
};

RoutedDem routed_dem(const benchmark::State& state) {
    Dem dem = rough_dem(state);
    dem.z = terrain::fill(dem.grid, dem.z, dem.boundary);
    FlowDirections single = terrain::route(dem.grid, dem.z, dem.boundary);
    terrain::resolve_flats(dem.grid, dem.z, dem.boundary, single);
    return {std::move(dem), std::move(single)};
}

void multiple_flow_area(benchmark::State& state) {
    const auto [dem, single] = routed_dem(state);
    const ThreadLimit limit(static_cast<int>(state.range(1)));
    const std::vector<double> cells = terrain::cell_areas(dem.grid);
    for (auto _ : state) {
        benchmark::DoNotOptimize(terrain::accumulate(terrain::multiple_flow(dem.grid, dem.z, single), cells));
    }
    per_item(state, dem.grid.size());
}

void d_infinity_area(benchmark::State& state) {
    const auto [dem, single] = routed_dem(state);
    const ThreadLimit limit(static_cast<int>(state.range(1)));
    const std::vector<double> cells = terrain::cell_areas(dem.grid);
    for (auto _ : state) {
        benchmark::DoNotOptimize(terrain::accumulate(terrain::d_infinity(dem.grid, dem.z, single), cells));
    }
    per_item(state, dem.grid.size());
}

#define SIZES \
    Args({1000, 1})->Args({1000, 2})->Args({4000, 1})->Args({4000, 2})->Unit(benchmark::kMillisecond)->UseRealTime()
BENCHMARK(fill)->SIZES;
BENCHMARK(route)->SIZES;
BENCHMARK(fill_flats_route_area)->SIZES;
BENCHMARK(multiple_flow_area)->SIZES;
BENCHMARK(d_infinity_area)->SIZES;

}  // namespace
}  // namespace thalweg::bench
