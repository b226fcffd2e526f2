// SPDX-License-Identifier: GPL-3.0-or-later
// Results do not hang on the time step: from noise to rest with steps of 2e4 and 1e5 years, on a raster and on a TIN.
#include <fmt/format.h>

#include <catch2/catch.hpp>
#include <cmath>

#include "landscapes.hpp"
#include "series.hpp"
#include "thalweg/core/statistics.hpp"
#include "thalweg/terrain/accumulate.hpp"
#include "thalweg/terrain/hypsometry.hpp"

using namespace thalweg;
using namespace thalweg::validation;

namespace {

constexpr int seeds = 8;
constexpr double uplift = 5e-4;

struct Rest {
    double mean_m, relief_m, time_yr;
    Index standing;  ///< nodes within a thousandth of u·t after 4 Myr: never dug
};

Index standing(const evolve::Landscape& landscape, const evolve::Setting& setting) {
    Index count = 0;
    for (Index node = 0; node < landscape.elevation_m.size(); ++node) {
        const bool inside = setting.boundary[node] == Boundary::interior;
        count += inside && landscape.elevation_m[node] > 0.999 * uplift * landscape.time_yr;
    }
    return count;
}

/// For 4 Myr, and on until neither mean height nor relief moves by 0.1 % in a million years.
template <class Topology>
Rest run_to_rest(const Topology& topology, std::uint64_t seed, double step_yr) {
    const evolve::River law{.k = 2e-5, .m = 0.4, .n = 1};
    const auto setting = support::island(topology, uplift);
    const auto areas = terrain::cell_areas(topology);
    auto state = evolve::initial_state(support::rough_start(setting, 1, seed));
    const auto go_on = [&](double years) {
        const Index steps = state.steps + static_cast<Index>(std::lround(years / step_yr));
        evolve::simulate(topology, {law}, setting, {.step_yr = step_yr, .max_steps = steps, .convergence = 0}, state);
        return terrain::hypsometry(state.landscape.elevation_m, areas);
    };
    auto last = go_on(4e6);
    Rest rest{.standing = standing(state.landscape, setting)};
    for (bool moves = true; moves && state.landscape.time_yr < 2e8;) {
        const auto now = go_on(1e6);
        moves = std::abs(now.mean_m / last.mean_m - 1) > 1e-3 || std::abs(now.maximum_m / last.maximum_m - 1) > 1e-3;
        last = now;
    }
    rest.mean_m = last.mean_m;
    rest.relief_m = last.maximum_m;
    rest.time_yr = state.landscape.time_yr;
    return rest;
}

template <class MakeTopology>
void compare(const std::string& name, MakeTopology make) {
    std::vector<double> mean_short, mean_long, relief_short, relief_long;
    Index left_standing = 0;
    double longest_yr = 0;
    for (std::uint64_t seed = 1; seed <= seeds; ++seed) {
        const auto topology = make(seed);
        const Rest small = run_to_rest(topology, seed, 2e4), large = run_to_rest(topology, seed, 1e5);
        mean_short.push_back(small.mean_m);
        mean_long.push_back(large.mean_m);
        relief_short.push_back(small.relief_m);
        relief_long.push_back(large.relief_m);
        left_standing += small.standing + large.standing;
        longest_yr = std::max({longest_yr, small.time_yr, large.time_yr});
    }
    const double scatter = standard_deviation(relief_short);
    fmt::print(
        "{:6}: mean {:.2f} and {:.2f} m ({:+.2f} %), relief {:.1f} and {:.1f} m (scatter {:.1f} m), {} standing, at "
        "rest after {:.0f} Myr at most\n",
        name, mean(mean_short), mean(mean_long), 100 * (mean(mean_long) / mean(mean_short) - 1), mean(relief_short),
        mean(relief_long), scatter, left_standing, longest_yr / 1e6);
    CHECK(std::abs(mean(mean_long) / mean(mean_short) - 1) < 0.03);
    CHECK(std::abs(mean(relief_long) - mean(relief_short)) < scatter);
    CHECK(left_standing == 0);
    CHECK(longest_yr < 2e8);
    write_series("time_step_" + name, {{"mean_m, dt = 20 kyr", mean_short},
                                       {"mean_m, dt = 100 kyr", mean_long},
                                       {"relief_m, dt = 20 kyr", relief_short},
                                       {"relief_m, dt = 100 kyr", relief_long}});
}

}  // namespace

TEST_CASE("Landscapes at rest are the same with steps of 2e4 and 1e5 years, and no node is left standing at u·t") {
    const Grid grid = plane_grid(128, 128, 100, 100);
    compare("raster", [&](std::uint64_t) { return grid; });
    compare("TIN", [](std::uint64_t seed) { return island_mesh(10000, seed); });
}
