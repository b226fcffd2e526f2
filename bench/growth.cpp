// SPDX-License-Identifier: GPL-3.0-or-later
// Networks and the surface over them, by the number of links asked for (met within a few per cent).
#include "cases.hpp"
#include "thalweg/grow/grow.hpp"
#include "thalweg/grow/surface_mesh.hpp"
#include "thalweg/surface/patch.hpp"

namespace thalweg::bench {
namespace {

constexpr double side_m = 10000;

grow::Basin square_basin() {
    return {.outline = {{0, 0}, {side_m, 0}, {side_m, side_m}, {0, side_m}},
            .outlet = {side_m / 2, 0},
            .source = {side_m / 2, side_m * 2 / 3},
            .base_level_m = 0};
}

grow::Dials dials_for(double links) {
    grow::Dials dials;
    dials.channel_maintenance_m = side_m / std::sqrt(links / 1.75);
    return dials;
}

void grow_network(benchmark::State& state) {
    const grow::Dials dials = dials_for(static_cast<double>(state.range(0)));
    Index links = 1;
    for (auto _ : state) links = grow::grow(square_basin(), dials).network.size();
    state.counters["links"] = links;
    per_item(state, links);
}
BENCHMARK(grow_network)->ArgName("links")->RangeMultiplier(10)->Range(1000, 1000000)->Unit(benchmark::kMillisecond);

/// The surface over a network of 1e5 links, whose triangles, gradients and cells are timed apart.
struct Grown {
    grow::Dials dials = dials_for(1e5);
    grow::Network network = grow::grow(square_basin(), dials).network;
    grow::SurfaceMesh mesh = triangles();
    std::vector<double> tension = std::vector<double>(mesh.size(), 2.5);

    grow::SurfaceMesh triangles() const {
        return grow::surface_mesh(network, dials.flint, 0, dials.channel_maintenance_m / 2);
    }
    surface::TensionMesh surface() const {
        return {.x = mesh.x,
                .y = mesh.y,
                .height = mesh.height,
                .tension = tension,
                .triangles = mesh.triangles,
                .given_slope_x = mesh.channel_slope_x,
                .given_slope_y = mesh.channel_slope_y};
    }
};

const Grown& grown() {
    static const Grown once;
    return once;
}

void grown_triangles(benchmark::State& state) {
    for (auto _ : state) benchmark::DoNotOptimize(grown().triangles());
    per_item(state, grown().mesh.size());
}
BENCHMARK(grown_triangles)->Unit(benchmark::kMillisecond)->UseRealTime();

void grown_gradients(benchmark::State& state) {
    for (auto _ : state) benchmark::DoNotOptimize(surface::minimum_norm_network(grown().surface()));
    per_item(state, grown().mesh.size());
}
BENCHMARK(grown_gradients)->Unit(benchmark::kMillisecond)->UseRealTime();

void grown_cells(benchmark::State& state) {
    const auto patches = surface::tension_patches(grown().surface(), surface::minimum_norm_network(grown().surface()));
    const auto side = static_cast<Index>(state.range(0));
    Raster raster;
    raster.grid = plane_grid(side, side, side_m / side, side_m / side);
    raster.placement = {.west = -side_m / 2,
                        .north = side_m,
                        .cell_width = side_m / side,
                        .cell_height = side_m / side,
                        .crs_wkt = "",
                        .geographic = false};
    for (auto _ : state) surface::evaluate(grown().surface(), patches, raster);
    per_item(state, raster.grid.size());
}
BENCHMARK(grown_cells)->Arg(3163)->Unit(benchmark::kMillisecond)->UseRealTime();

}  // namespace
}  // namespace thalweg::bench
