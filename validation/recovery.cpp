// SPDX-License-Identifier: GPL-3.0-or-later
// Blind tests of the fit: landscapes made with known k and m, fitted on their nodes, and measured as a DEM.
#include <fmt/format.h>

#include <catch2/catch.hpp>
#include <cmath>

#include "landscapes.hpp"
#include "series.hpp"
#include "thalweg/channel/slope_area.hpp"
#include "thalweg/infer/slope_area_fit.hpp"
#include "thalweg/surface/heightfield.hpp"
#include "thalweg/terrain/accumulate.hpp"
#include "thalweg/terrain/flats.hpp"
#include "thalweg/terrain/lakes.hpp"

using namespace thalweg;
using namespace thalweg::validation;

namespace {

constexpr double uplift = 5e-4, reference_area = 3e6;

evolve::River law(double m, double n) { return {.k = n == 1 ? 1e-5 : 2e-6, .m = m, .n = n}; }

template <class Topology>
evolve::Landscape steady(const Topology& topology, const evolve::River& river, std::uint64_t seed) {
    const evolve::Setting setting = support::island(topology, uplift);
    evolve::Landscape landscape = support::rough_start(setting, 1.0, seed);
    REQUIRE(evolve::solve_steady(topology, river, setting, 20000, landscape).converged);
    return landscape;
}

struct Bias {
    double m;               ///< fitted minus true
    double k_at_reference;  ///< fitted over true, minus 1, of k·A0^m
};

Bias bias(std::span<const channel::SlopeAreaPoint> points, const evolve::River& river) {
    const auto fit = infer::fit_slope_area(channel::slope_area_bins(points),
                                           {.n = river.n, .uplift_m_per_yr = uplift, .deposition_g = river.g});
    const double fitted = fit.k_at_reference_area.value * std::pow(reference_area / fit.reference_area_m2, fit.m.value);
    return {fit.m.value - river.m, fitted / (river.k * std::pow(reference_area, river.m)) - 1};
}

template <class Topology>
Bias on_nodes(const Topology& topology, const evolve::River& river, std::uint64_t seed) {
    const evolve::Landscape landscape = steady(topology, river, seed);
    const auto drainage =
        evolve::drain(topology, landscape, support::island(topology, uplift), terrain::Receiver::steepest);
    const auto graph = graph_of_surface(topology, landscape, drainage);
    return bias(channel::node_slopes(graph, drainage.area_m2, landscape.elevation_m), river);
}

/// The heights alone, as a stranger's DEM: routed anew, slopes over segments of 2.5 % of the relief.
Bias as_dem(const Grid& grid, const std::vector<double>& z, const evolve::River& river) {
    const auto boundary = terrain::data_edge(grid, z);
    FlowDirections directions = terrain::route(grid, z, boundary);
    terrain::resolve_flats(grid, z, boundary, directions);
    terrain::drain_lakes(grid, z, boundary, directions);
    const auto graph = terrain::flow_graph(grid, z, directions);
    const auto area = terrain::accumulate(graph, terrain::cell_areas(grid));
    const double relief = *std::max_element(z.begin(), z.end()) - *std::min_element(z.begin(), z.end());
    const auto points = channel::fixed_drop_segments(graph, area, terrain::carve(graph, z), {},
                                                     {.drop_m = 0.025 * relief, .smallest_area_m2 = 1e5});
    return bias(points, river);
}

void report(const char* how, double m, double n, const Bias& b) {
    fmt::print("{:28} m {:5.3f} n {:3.1f}: m off by {:+.5f}, k*A0^m by {:+.3f} %\n", how, m, n, b.m,
               100 * b.k_at_reference);
}

}  // namespace

TEST_CASE("k and m come back from nodes to 0.001 and 1 %, from a raster run's heights to 0.02 and 10 %") {
    const Grid grid = island_grid(150);
    Categories off;
    for (const double n : {1.0, 1.5}) {
        for (const double m : {0.4 * n, 0.5 * n}) {
            for (const std::uint64_t seed : {1, 2, 3}) {
                const evolve::River river = law(m, n);
                const Bias tin = on_nodes(island_mesh(10000, seed), river, seed);
                const Bias nodes = on_nodes(grid, river, seed);
                const Bias dem = as_dem(grid, steady(grid, river, seed).elevation_m, river);
                report("TIN nodes", m, n, tin);
                report("raster nodes", m, n, nodes);
                report("raster heights as a DEM", m, n, dem);
                for (const Bias& b : {tin, nodes}) {
                    CHECK(std::abs(b.m) < 1e-3);
                    CHECK(std::abs(b.k_at_reference) < 0.01);
                }
                CHECK(std::abs(dem.m) < 0.02);
                CHECK(std::abs(dem.k_at_reference) < 0.1);
                off.add("TIN nodes", std::abs(tin.m));
                off.add("raster nodes", std::abs(nodes.m));
                off.add("raster heights as a DEM", std::abs(dem.m));
            }
        }
    }
    write_series("recovery_of_m", off);
}

TEST_CASE("A TIN drawn on a raster loses part of the truth, and how much is known") {
    // D8 on the resampled surface is not the TIN's routing; the bounds hold what is seen, not what one would wish.
    for (const double m : {0.4, 0.5}) {
        const Mesh mesh = island_mesh(10000, 1);
        Raster raster = surface::covering_raster(mesh, 256);
        surface::interpolate_linear(mesh, steady(mesh, law(m, 1), 1).elevation_m, raster);
        const Bias b = as_dem(raster.grid, raster.values, law(m, 1));
        report("TIN drawn on 256 cells", m, 1, b);
        CHECK(std::abs(b.m) < 0.1);
        CHECK(std::abs(b.k_at_reference) < 1);
    }
}

TEST_CASE(
    "k and m of rivers that lay down sediment come back to 0.001 and 1 % from nodes, to 0.02 and 10 % from heights") {
    const Grid grid = island_grid(100);
    Categories off;
    for (const double n : {1.0, 1.5}) {
        for (const double g : {0.5, 1.0, 2.0}) {
            evolve::River river = law(0.45 * n, n);
            river.g = g;
            const std::string what = fmt::format("n = {:g}, G = {:g}", n, g);
            const Bias tin = on_nodes(island_mesh(5000, 1), river, 1), nodes = on_nodes(grid, river, 1);
            const Bias dem = as_dem(grid, steady(grid, river, 1).elevation_m, river);
            report(("TIN nodes, " + what).c_str(), river.m, n, tin);
            report(("raster nodes, " + what).c_str(), river.m, n, nodes);
            report(("raster heights, " + what).c_str(), river.m, n, dem);
            for (const Bias& b : {tin, nodes}) {
                CHECK(std::abs(b.m) < 1e-3);
                CHECK(std::abs(b.k_at_reference) < 0.01);
            }
            CHECK(std::abs(dem.m) < 0.02);
            CHECK(std::abs(dem.k_at_reference) < 0.1);
            off.add("TIN nodes", std::abs(tin.k_at_reference));
            off.add("raster nodes", std::abs(nodes.k_at_reference));
            off.add("raster heights as a DEM", std::abs(dem.k_at_reference));
        }
    }
    write_series("recovery_with_deposition", off);
}
