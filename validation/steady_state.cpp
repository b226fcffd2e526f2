// SPDX-License-Identifier: GPL-3.0-or-later
// Time stepping comes to rest where the law says: S = (u/k)^(1/n)·A^(−m/n) at every node that a river cuts, receivers
// and areas found anew from the final heights.
#include <fmt/format.h>

#include <catch2/catch.hpp>
#include <cmath>

#include "landscapes.hpp"
#include "series.hpp"

using namespace thalweg;
using namespace thalweg::validation;

namespace {

constexpr double uplift = 1e-3;

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
        const double rock = setting.relative_erodibility.empty() ? 1 : setting.relative_erodibility[*node];
        const double law =
            std::pow(setting.uplift_m_per_yr[*node] / (rock * river.k * std::pow(drainage.area_m2[*node], river.m)),
                     1 / river.n);
        worst.error = std::max(worst.error, std::abs(slope / law - 1));
        ++worst.judged;
    }
    return worst;
}

struct Law {
    double n, talus_slope;
};

template <class Topology>
double come_to_rest(const char* name, const Topology& topology, const Law& law, const evolve::Setting& setting) {
    // k such that a river of 1 km² has a slope of 0.03, whatever n.
    const double m = 0.5 * law.n, k = uplift / (std::pow(1e6, m) * std::pow(0.03, law.n));
    const evolve::River river{.k = k, .m = m, .n = law.n, .talus_slope = law.talus_slope};
    evolve::Landscape landscape = support::rough_start(setting, 1.0, 7);
    const auto result = evolve::simulate(topology, {river}, setting,
                                         {.step_yr = 5e4, .max_steps = 20000, .convergence = 1e-13}, landscape);
    const Worst worst = worst_slope(topology, river, setting, landscape, result.frozen);
    fmt::print(
        "{:6} n {:3.1f} talus {:4.2f}: {:4} steps, mean rate {:8.2e} m/yr, {} nodes, {} excepted, worst {:.1e}\n", name,
        law.n, law.talus_slope, result.steps, result.mean_rate_m_per_yr, worst.judged, worst.excepted, worst.error);
    CHECK(result.mean_rate_m_per_yr < 1e-10);
    CHECK(worst.error < 1e-8);
    CHECK(worst.judged > topology.size() / 10);
    CHECK(worst.excepted < topology.size() / 100);
    CHECK(std::abs(result.mass.relative_residual()) < 1e-9);
    return worst.error;
}

/// Uplift, rain and rock that differ from node to node, smoothly and by a factor of four.
template <class Topology>
evolve::Setting uneven(const Topology& topology, const std::vector<Point>& places) {
    evolve::Setting setting = support::island(topology, uplift);
    const auto field = [&](std::uint64_t stream) {
        std::vector<double> values;
        for (const Point& p : places) {
            const double east = 6 * p.x / side_m + stream, north = 5 * p.y / side_m;
            values.push_back(std::pow(2.0, std::sin(east) * std::cos(north + 0.7 * stream)));
        }
        return values;
    };
    setting.rainfall = field(1);
    setting.relative_erodibility = field(2);
    const auto rise = field(3);
    for (Index node = 0; node < topology.size(); ++node) setting.uplift_m_per_yr[node] *= rise[node];
    return setting;
}

std::vector<Point> places(const Mesh& mesh) {
    std::vector<Point> all;
    for (Index node = 0; node < mesh.size(); ++node) all.push_back({mesh.x[node], mesh.y[node]});
    return all;
}

std::vector<Point> places(const Grid& grid) {
    std::vector<Point> all;
    const double step = side_m / grid.cols;
    for (Index node = 0; node < grid.size(); ++node) all.push_back({step * grid.col(node), step * grid.row(node)});
    return all;
}

constexpr double no_limit = std::numeric_limits<double>::infinity();
constexpr double exponents[] = {0.5, 0.7, 1.0, 1.5, 2.0, 4.0};

}  // namespace

TEST_CASE("Time stepping rests on the law to 1e-8 at every node, on a TIN and on a raster") {
    const Mesh mesh = island_mesh(5000, 3);
    const Grid grid = island_grid(70);
    Categories errors;
    for (const double n : exponents) {
        for (const double talus : {no_limit, 0.2}) {
            const std::string what = fmt::format("n = {:g}{}", n, talus < 1 ? ", talus" : "");
            errors.add("TIN, " + what, come_to_rest("TIN", mesh, {n, talus}, support::island(mesh, uplift)));
            errors.add("raster, " + what, come_to_rest("raster", grid, {n, talus}, support::island(grid, uplift)));
        }
    }
    write_series("steady_slopes", errors);
}

TEST_CASE("Under uneven uplift, rain and rock, too, time stepping rests on the law to 1e-8 at every node") {
    const Mesh mesh = island_mesh(3000, 4);
    const Grid grid = island_grid(55);
    Categories errors;
    for (const double n : exponents) {
        const std::string what = fmt::format("n = {:g}", n);
        errors.add("TIN, " + what, come_to_rest("TIN", mesh, {n, no_limit}, uneven(mesh, places(mesh))));
        errors.add("raster, " + what, come_to_rest("raster", grid, {n, no_limit}, uneven(grid, places(grid))));
    }
    write_series("steady_slopes_uneven", errors);
}
