// SPDX-License-Identifier: GPL-3.0-or-later
// Rivers that lay down what they carry come to rest on S = ((1 + G)·u/k)^(1/n)·A^(−m/n).
#include <fmt/format.h>

#include <catch2/catch.hpp>
#include <cmath>

#include "landscapes.hpp"
#include "series.hpp"

using namespace thalweg;
using namespace thalweg::validation;

namespace {

template <class Topology>
double come_to_rest(const char* name, const Topology& topology, double n, double g) {
    const double uplift = 1e-3, m = 0.5 * n, k = uplift / (std::pow(1e6, m) * std::pow(0.03, n));
    const evolve::River river{.k = k, .m = m, .n = n, .g = g};
    const evolve::Setting setting = support::island(topology, uplift);
    evolve::Landscape landscape = support::rough_start(setting, 1.0, 7);
    const auto result = evolve::simulate(topology, {.river = river}, setting,
                                         {.step_yr = 1e5, .max_steps = 20000, .convergence = 1e-11}, landscape);
    const evolve::Drainage drainage = evolve::drain(topology, landscape, setting, river);
    const terrain::FlowGraph graph = graph_of_surface(topology, landscape, drainage);
    std::vector<std::uint8_t> excepted = result.frozen;
    excepted.resize(graph.size(), 0);
    double worst = 0;
    Index judged = 0;
    for (auto node = graph.order.rbegin(); node != graph.order.rend(); ++node) {
        const Index receiver = graph.receiver[*node];
        if (receiver == none) continue;
        excepted[receiver] |= excepted[*node];
        if (excepted[*node]) continue;
        const double slope = (landscape.elevation_m[*node] - landscape.elevation_m[receiver]) / graph.length[*node];
        const double law = std::pow((1 + g) * uplift / k, 1 / n) * std::pow(drainage.area_m2[*node], -river.m / n);
        worst = std::max(worst, std::abs(slope / law - 1));
        ++judged;
    }
    fmt::print("{:6} n {:3.1f} G {:3.1f}: {:4} steps, at most {} iterations, {} nodes, worst {:.1e}, residual {:.1e}\n",
               name, n, g, result.steps, result.largest_sediment_iterations, judged, worst,
               result.mass.relative_residual());
    CHECK(worst < 1e-6);
    CHECK(judged > 0.9 * topology.size());
    CHECK(result.unconverged_sediment_steps == 0);
    CHECK(std::abs(result.mass.relative_residual()) < 1e-9);
    return worst;
}

}  // namespace

TEST_CASE("Erosion and deposition rest on slopes steeper by (1 + G)^(1/n), to 1e-6, on a TIN and on a raster") {
    const Mesh mesh = island_mesh(3000, 3);
    const Grid grid = island_grid(55);
    Categories errors;
    for (const double n : {0.7, 1.0, 1.5}) {
        for (const double g : {0.0, 0.5, 1.0, 2.0}) {
            errors.add(fmt::format("TIN, G = {:g}", g), come_to_rest("TIN", mesh, n, g));
            errors.add(fmt::format("raster, G = {:g}", g), come_to_rest("raster", grid, n, g));
        }
    }
    write_series("deposition_slopes", errors);
}
