// SPDX-License-Identifier: GPL-3.0-or-later
// Time stepping comes to rest where the law says: S = (u/k)^(1/n)·A^(−m/n) at every node that a river cuts, receivers
// and areas found anew from the final heights.
#include <fmt/format.h>

#include <catch2/catch.hpp>
#include <cmath>

#include "landscapes.hpp"

using namespace thalweg;
using namespace thalweg::validation;

namespace {

struct Worst {
    double error = 0;
    Index judged = 0, excepted = 0;
};

/// Largest relative error of the slopes below the talus limit; frozen nodes and those downstream of them are excepted.
template <class Topology>
Worst worst_slope(const Topology& topology, const evolve::River& river, const evolve::Setting& setting,
                  const evolve::Landscape& landscape, const std::vector<std::uint8_t>& frozen) {
    const evolve::Drainage drainage = evolve::drain(topology, landscape, setting, river.receiver);
    const terrain::FlowGraph graph = graph_of_surface(topology, landscape, drainage);
    const auto limited = evolve::at_talus_limit(topology, drainage, river, landscape);
    std::vector<std::uint8_t> excepted = frozen;
    excepted.resize(graph.size(), 0);
    Worst worst;
    for (auto node = graph.order.rbegin(); node != graph.order.rend(); ++node) {
        const Index receiver = graph.receiver[*node];
        if (receiver == none) continue;
        excepted[receiver] |= excepted[*node];
        worst.excepted += excepted[*node];
        if (excepted[*node] || limited[*node]) continue;
        const double slope = (landscape.elevation_m[*node] - landscape.elevation_m[receiver]) / graph.length[*node];
        const double law = std::pow(
            setting.uplift_m_per_yr[*node] / (river.k * std::pow(drainage.area_m2[*node], river.m)), 1 / river.n);
        worst.error = std::max(worst.error, std::abs(slope / law - 1));
        ++worst.judged;
    }
    return worst;
}

template <class Topology>
void come_to_rest(const char* name, const Topology& topology, double n, double talus_slope) {
    // k such that a river of 1 km² has a slope of 0.03, whatever n.
    const double uplift = 1e-3, m = 0.5 * n, k = uplift / (std::pow(1e6, m) * std::pow(0.03, n));
    const evolve::River river{.k = k, .m = m, .n = n, .talus_slope = talus_slope};
    const evolve::Setting setting = support::island(topology, uplift);
    evolve::Landscape landscape = support::rough_start(setting, 1.0, 7);
    const auto result = evolve::simulate(topology, {river}, setting,
                                         {.step_yr = 5e4, .max_steps = 20000, .convergence = 1e-13}, landscape);
    const Worst worst = worst_slope(topology, river, setting, landscape, result.frozen);
    fmt::print(
        "{:6} n {:3.1f} talus {:4.2f}: {:4} steps, mean rate {:8.2e} m/yr, {} nodes, {} excepted, worst {:.1e}\n", name,
        n, talus_slope, result.steps, result.mean_rate_m_per_yr, worst.judged, worst.excepted, worst.error);
    CHECK(result.mean_rate_m_per_yr < 1e-10);
    CHECK(worst.error < 1e-8);
    CHECK(worst.judged > topology.size() / 10);
    CHECK(worst.excepted < topology.size() / 100);
    CHECK(std::abs(result.mass.relative_residual()) < 1e-9);
}

}  // namespace

TEST_CASE("Time stepping rests on the law to 1e-8 at every node, on a TIN and on a raster") {
    const Mesh mesh = island_mesh(5000, 3);
    const Grid grid = island_grid(70);
    for (const double n : {0.5, 0.7, 1.0, 1.5, 2.0, 4.0}) {
        for (const double talus : {std::numeric_limits<double>::infinity(), 0.2}) {
            come_to_rest("TIN", mesh, n, talus);
            come_to_rest("raster", grid, n, talus);
        }
    }
}
