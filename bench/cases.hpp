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

/// Such terrain whose finest octave is 1.2 cells wide and as high on every grid of 625·2^k cells a side: larger grids
/// have larger forms besides, with larger lakes. Made row by row, on all threads.
inline std::vector<double> evenly_rough_terrain(const Grid& grid) {
    const int octaves = static_cast<int>(std::lround(std::log2(grid.cols / 4.0))) + 1;
    const evolve::Fractal fractal{.octaves = octaves, .lacunarity = 2, .persistence = 0.5, .scale = 4};
    std::vector<double> z(grid.size());
    parallel_for(0, grid.rows, [&](Index first, Index last) {
        std::vector<Point> positions(grid.cols);
        for (Index row = first; row < last; ++row) {
            for (Index col = 0; col < grid.cols; ++col) {
                positions[col] = {static_cast<double>(col), static_cast<double>(row)};
            }
            const auto heights = evolve::perlin_surface(positions, grid.cols, 0.5 * grid.cols, 1, fractal);
            for (Index col = 0; col < grid.cols; ++col) {
                z[std::size_t{row} * grid.cols + col] = std::round(heights[col] + 0.1 * row);
            }
        }
    });
    return z;
}

}  // namespace thalweg::bench
