// SPDX-License-Identifier: GPL-3.0-or-later
// Making a mesh, per node.
#include "cases.hpp"
#include "thalweg/mesh/triangulate.hpp"

namespace thalweg::bench {
namespace {

const Polygon square{{0, 0}, {1000, 0}, {1000, 1000}, {0, 1000}};

double spacing_for(const benchmark::State& state) { return 836 / std::sqrt(static_cast<double>(state.range(0))); }

void poisson_disk(benchmark::State& state) {
    std::size_t points = 1;
    for (auto _ : state) points = mesh::poisson_disk(square, spacing_for(state), 1).points.size();
    per_item(state, static_cast<double>(points));
}
BENCHMARK(poisson_disk)->Arg(100000)->Arg(1000000)->Unit(benchmark::kMillisecond);

void triangulate(benchmark::State& state) {
    const mesh::PointSet points = mesh::poisson_disk(square, spacing_for(state), 1);
    for (auto _ : state) benchmark::DoNotOptimize(mesh::triangulate(square, points));
    per_item(state, static_cast<double>(points.points.size()));
}
BENCHMARK(triangulate)->Arg(100000)->Arg(1000000)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace thalweg::bench
