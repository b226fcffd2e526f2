// SPDX-License-Identifier: GPL-3.0-or-later
// The steady solver and time stepping reach landscapes of the same kind: relief, hypsometry and slope–area agree within
// the scatter between seeds. (Not node by node: a law has many steady landscapes.)
#include <fmt/format.h>

#include <catch2/catch.hpp>
#include <cmath>

#include "landscapes.hpp"
#include "series.hpp"
#include "thalweg/channel/slope_area.hpp"
#include "thalweg/core/statistics.hpp"
#include "thalweg/terrain/accumulate.hpp"
#include "thalweg/terrain/hypsometry.hpp"

using namespace thalweg;
using namespace thalweg::validation;

namespace {

constexpr int seeds = 8;

struct Ensemble {
    std::vector<double> relief_m, mean_m, integral, theta, ks;
};

template <class Topology>
void observe(const Topology& topology, const evolve::Setting& setting, const evolve::Landscape& landscape,
             Ensemble& ensemble) {
    const auto h = terrain::hypsometry(landscape.elevation_m, terrain::cell_areas(topology));
    ensemble.relief_m.push_back(h.maximum_m - h.minimum_m);
    ensemble.mean_m.push_back(h.mean_m);
    ensemble.integral.push_back(h.integral);
    const auto drainage = evolve::drain(topology, landscape, setting, terrain::Receiver::steepest);
    const auto graph = graph_of_surface(topology, landscape, drainage);
    const auto law = channel::fit_slope_area(
        channel::slope_area_bins(channel::node_slopes(graph, drainage.area_m2, landscape.elevation_m)));
    ensemble.theta.push_back(law.theta.value);
    ensemble.ks.push_back(law.ks.value);
}

template <class MakeTopology>
void compare(const char* name, double n, MakeTopology make) {
    const double uplift = 1e-3, m = 0.5 * n, k = uplift / (std::pow(1e6, m) * std::pow(0.03, n));
    const evolve::River law{.k = k, .m = m, .n = n};
    Ensemble stepped, direct;
    for (std::uint64_t seed = 0; seed < seeds; ++seed) {
        const auto topology = make(seed);
        const auto setting = support::island(topology, uplift);
        evolve::Landscape a = support::rough_start(setting, 1, seed), b = a;
        evolve::simulate(topology, {law}, setting, {.step_yr = 1e5, .max_steps = 5000, .convergence = 1e-8}, a);
        CHECK(evolve::solve_steady(topology, law, setting, 20000, b).converged);
        observe(topology, setting, a, stepped);
        observe(topology, setting, b, direct);
    }
    const auto check = [&](const char* what, const std::vector<double>& a, const std::vector<double>& b, double floor) {
        const double scatter = std::max({standard_deviation(a), standard_deviation(b), floor});
        fmt::print("{:6} n {:3.1f} {:8}: stepping {:.5g}, steady solver {:.5g}, scatter {:.2g}\n", name, n, what,
                   mean(a), mean(b), scatter);
        CHECK(std::abs(mean(a) - mean(b)) <= scatter);
    };
    check("relief", stepped.relief_m, direct.relief_m, 0);
    check("mean", stepped.mean_m, direct.mean_m, 0);
    check("integral", stepped.integral, direct.integral, 0);
    check("theta", stepped.theta, direct.theta, 1e-6);  // both are on the law: their scatter is rounding
    check("ks", stepped.ks, direct.ks, 1e-5 * mean(direct.ks));
    write_series(fmt::format("two_solvers_{}_{:.1f}", name, n), {{"relief_stepping_m", stepped.relief_m},
                                                                 {"relief_steady_m", direct.relief_m},
                                                                 {"integral_stepping", stepped.integral},
                                                                 {"integral_steady", direct.integral}});
}

}  // namespace

TEST_CASE("Steady solver and time stepping agree within the scatter between seeds") {
    for (const double n : {1.0, 1.5}) {
        compare("TIN", n, [](std::uint64_t seed) { return island_mesh(3000, seed); });
        compare("raster", n, [](std::uint64_t) { return island_grid(55); });
    }
}
