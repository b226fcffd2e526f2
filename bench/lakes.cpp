// SPDX-License-Identifier: GPL-3.0-or-later
// Lakes at their worst, from 1e4 to 1e7 nodes: a random surface (a pit in every ninth cell), bowls within bowls (each
// spills into the next) and a comb (trenches that join only above their floors). `scaling.py` draws the cost.
#include "thalweg/terrain/lakes.hpp"
#include "cases.hpp"
#include "thalweg/terrain/route.hpp"

namespace thalweg::bench {
namespace {

enum Surface : int { random_surface, bowl_of_bowls, comb };

double height_at(Surface surface, Index side, Index r, Index c) {
    const bool rim = r == 0 || c == 0 || r + 1 == side || c + 1 == side;
    const double distance = std::hypot(r - 0.5 * side, c - 0.5 * side);
    if (surface == random_surface) return uniform_at(1, 1, r * side + c);
    if (surface == bowl_of_bowls) {
        return distance + 3 * std::abs(std::sin(distance)) + 0.5 * std::sin(0.9 * c) * std::sin(1.1 * r);
    }
    if (rim) return side;
    return c % 2 == 1 ? 1e-3 * r : (r == 1 ? 1 + 0.1 * c : side - 1.0);
}

void drain_worst_lakes(benchmark::State& state) {
    const auto surface = static_cast<Surface>(state.range(0));
    const auto side = static_cast<Index>(std::lround(std::sqrt(static_cast<double>(state.range(1)))));
    const ThreadLimit limit(1);
    const Grid grid = plane_grid(side, side, 30, 30);
    std::vector<double> z;
    for (Index node = 0; node < grid.size(); ++node) z.push_back(height_at(surface, side, node / side, node % side));
    const auto boundary = terrain::data_edge(grid, z);
    Index lakes = 0;
    for (auto _ : state) {
        FlowDirections directions = terrain::route(grid, z, boundary);
        lakes = terrain::drain_lakes(grid, z, boundary, directions);
    }
    state.counters["lakes"] = lakes;
    per_item(state, grid.size());
}
BENCHMARK(drain_worst_lakes)
    ->ArgNames({"surface", "nodes"})
    ->ArgsProduct({{random_surface, bowl_of_bowls, comb}, {10000, 100000, 1000000, 10000000}})
    ->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace thalweg::bench
