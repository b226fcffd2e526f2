// SPDX-License-Identifier: GPL-3.0-or-later
// The surface under tension: gradients per vertex, heights per cell.
#include "cases.hpp"
#include "thalweg/mesh/triangulate.hpp"
#include "thalweg/surface/patch.hpp"

namespace thalweg::bench {
namespace {

const Polygon square{{0, 0}, {1000, 0}, {1000, 1000}, {0, 1000}};

/// Waves through the nodes of a TIN; every second vertex a channel (tension 5), the others ridges (0).
struct Waves {
    explicit Waves(Index count) : tin(mesh::triangulate(square, mesh::poisson_disk_count(square, count, 1))) {
        for (Index i = 0; i < tin.size(); ++i) {
            height.push_back(50 * std::sin(tin.x[i] / 30) * std::cos(tin.y[i] / 41));
            tension.push_back(i % 2 == 0 ? 5 : 0);
        }
    }
    surface::TensionMesh mesh() const { return {tin.x, tin.y, height, tension, tin.triangles}; }

    Mesh tin;
    std::vector<double> height, tension;
};

void minimum_norm_network(benchmark::State& state) {
    const Waves waves(static_cast<Index>(state.range(0)));
    for (auto _ : state) benchmark::DoNotOptimize(surface::minimum_norm_network(waves.mesh()));
    per_item(state, waves.tin.size());
}
BENCHMARK(minimum_norm_network)->Arg(100000)->Arg(1000000)->Unit(benchmark::kMillisecond);

void evaluate_patches(benchmark::State& state) {
    const Waves waves(100000);
    const auto patches = surface::tension_patches(waves.mesh(), surface::minimum_norm_network(waves.mesh()));
    const Index side = static_cast<Index>(state.range(0));
    Raster raster;
    raster.grid = plane_grid(side, side, 1000.0 / side, 1000.0 / side);
    raster.placement.north = 1000;
    raster.placement.cell_width = raster.placement.cell_height = 1000.0 / side;
    for (auto _ : state) surface::evaluate(waves.mesh(), patches, raster);
    per_item(state, raster.grid.size());
}
BENCHMARK(evaluate_patches)->Arg(1000)->Arg(3163)->Unit(benchmark::kMillisecond)->UseRealTime();

}  // namespace
}  // namespace thalweg::bench
