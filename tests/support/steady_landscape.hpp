// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <cmath>
#include <vector>

#include "thalweg/core/grid.hpp"
#include "thalweg/core/random.hpp"
#include "thalweg/terrain/accumulate.hpp"
#include "thalweg/terrain/flats.hpp"
#include "thalweg/terrain/lakes.hpp"
#include "thalweg/terrain/route.hpp"

/// A steady stream-power landscape made without the simulator, for judging what is measured on it.
namespace thalweg::support {

/// S = slope_at_reference·(A/reference_area)^(−θ), that is k·A0^m = u/S0^n and m = n·θ.
struct SteadyLaw {
    double theta = 0.5;
    double slope_at_reference = 0.08;
    double reference_area_m2 = 3e6;
    double scatter = 0;  ///< standard deviation of ln S from cell to cell, fixed in place (erodibility)
    /// A wave of faster uplift that has climbed this far in χ (m, for the reference area): slopes below it are so many
    /// times as steep. It stands equally high in all rivers, which is what n = 1 gives.
    double wave_chi_m = 0, below_wave = 1;
    double slope(double area_m2) const { return slope_at_reference * std::pow(area_m2 / reference_area_m2, -theta); }
};

/// Rise from a receiver at `chi_m` to a node that is `length_m` away and drains `area_m2`; χ is counted on.
inline double rise(const SteadyLaw& law, double area_m2, double length_m, double& chi_m) {
    const double step = length_m * std::pow(area_m2 / law.reference_area_m2, -law.theta);
    const double below = std::clamp(law.wave_chi_m - chi_m, 0.0, step);
    chi_m += step;
    return law.slope_at_reference * (step + (law.below_wave - 1) * below);
}

/// Heights of a square raster whose rim is at 0: random noise is routed, the law's slopes are integrated up the trees,
/// and both are repeated until no receiver changes (or 400 times: a few cells may go on exchanging receivers).
inline std::vector<double> steady_raster(const Grid& grid, const SteadyLaw& law, std::uint64_t seed) {
    std::vector<Boundary> boundary(grid.size(), Boundary::interior);
    std::vector<double> height(grid.size(), 0);
    for (Index node = 0; node < grid.size(); ++node) {
        const Index row = grid.row(node), col = grid.col(node);
        const bool rim = row == 0 || col == 0 || row + 1 == grid.rows || col + 1 == grid.cols;
        if (rim) boundary[node] = Boundary::base_level;
        if (!rim) height[node] = uniform_at(seed, 0, node);
    }
    std::vector<double> local(grid.size(), 1);
    Random random(seed, 1);
    for (double& each : local) each = std::exp(law.scatter * random.normal());
    FlowDirections previous;
    for (int sweep = 0; sweep < 400; ++sweep) {
        FlowDirections directions = terrain::route(grid, height, boundary);
        terrain::drain_lakes(grid, height, boundary, directions);
        if (directions == previous) break;
        const auto graph = terrain::flow_graph(grid, height, directions);
        const auto area = terrain::accumulate(graph, terrain::cell_areas(grid));
        std::vector<double> chi(grid.size(), 0);
        for (const Index node : graph.order) {
            const Index receiver = graph.receiver[node];
            if (receiver == none) continue;
            chi[node] = chi[receiver];
            height[node] = height[receiver] + rise(law, area[node], graph.length[node], chi[node]) * local[node];
        }
        previous = std::move(directions);
    }
    return height;
}

/// A DEM as the pipeline sees it: flats resolved, lakes led out, carved, drained to its edge.
struct RoutedDem {
    terrain::FlowGraph graph;
    std::vector<double> area_m2, carved_m;
};

inline RoutedDem routed_dem(const Grid& grid, const std::vector<double>& elevation_m) {
    const auto boundary = terrain::data_edge(grid, elevation_m);
    FlowDirections directions = terrain::route(grid, elevation_m, boundary);
    terrain::resolve_flats(grid, elevation_m, boundary, directions);
    terrain::drain_lakes(grid, elevation_m, boundary, directions);
    RoutedDem dem{.graph = terrain::flow_graph(grid, elevation_m, directions), .area_m2 = {}, .carved_m = {}};
    dem.area_m2 = terrain::accumulate(dem.graph, terrain::cell_areas(grid));
    dem.carved_m = terrain::carve(dem.graph, elevation_m);
    return dem;
}

}  // namespace thalweg::support
