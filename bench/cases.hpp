// SPDX-License-Identifier: GPL-3.0-or-later
// Inputs that several benchmarks share.
#pragma once

#include <benchmark/benchmark.h>

#include <cmath>
#include <vector>

#include "thalweg/core/grid.hpp"
#include "thalweg/core/parallel.hpp"
#include "thalweg/core/random.hpp"
#include "thalweg/evolve/noise.hpp"

namespace thalweg::bench {

/// Reports the time of one iteration divided by `items`.
inline void per_item(benchmark::State& state, double items) {
    state.counters["per_item"] =
        benchmark::Counter(items, benchmark::Counter::kIsIterationInvariantRate | benchmark::Counter::kInvert);
}

/// Rough terrain with many pits: eleven octaves of noise on a tilt, in whole metres as real DEMs have them.
inline std::vector<double> rough_terrain(const Grid& grid) {
    std::vector<Point> positions;
    for (Index node = 0; node < grid.size(); ++node) {
        positions.push_back({static_cast<double>(grid.col(node)), static_cast<double>(grid.row(node))});
    }
    const evolve::Fractal fractal{.octaves = 11, .lacunarity = 2, .persistence = 0.5, .scale = 4};
    std::vector<double> z = evolve::perlin_surface(positions, grid.cols, 2000.0, 1, fractal);
    for (Index node = 0; node < grid.size(); ++node) z[node] = std::round(z[node] + 0.1 * grid.row(node));
    return z;
}

}  // namespace thalweg::bench
