// SPDX-License-Identifier: GPL-3.0-or-later
// Estimators run blind on rasters whose concavity, steepness and knickpoints are known, with scatter and in whole
// metres: what comes out on average, and how it spreads from seed to seed.
#include <fmt/format.h>

#include <catch2/catch.hpp>
#include <cmath>
#include <functional>

#include "landscapes.hpp"
#include "series.hpp"
#include "support/steady_landscape.hpp"
#include "thalweg/channel/concavity.hpp"
#include "thalweg/channel/knickpoints.hpp"
#include "thalweg/channel/main_streams.hpp"
#include "thalweg/channel/network.hpp"
#include "thalweg/channel/slope_area.hpp"
#include "thalweg/core/statistics.hpp"

using namespace thalweg;
using namespace thalweg::validation;

namespace {

constexpr int seeds = 12;
constexpr double cell_m = 90, reference_area_m2 = 1e6;

struct Case {
    const char* name;
    double theta, scatter, rounding_m;
};

/// The rivers of a DEM from `cells` cells of area up.
channel::Profile rivers(const support::RoutedDem& dem, double cells) {
    const auto channels = channel::channels_by_area(dem.area_m2, cells * cell_m * cell_m);
    return channel::channel_profile(dem.graph, channels, dem.area_m2, dem.carved_m);
}

std::vector<double> rounded(std::vector<double> heights, double step) {
    if (step > 0) {
        for (double& height : heights) height = step * std::round(height / step);
    }
    return heights;
}

double median_steepness(const channel::Profile& profile, double theta, double drop_m) {
    const auto chi_m = channel::chi(profile, theta, reference_area_m2);
    std::vector<double> known;
    for (const double value : channel::steepness(profile, chi_m, theta, reference_area_m2, drop_m)) {
        if (!std::isnan(value)) known.push_back(value);
    }
    return quantile(known, 0.5);
}

struct Found {
    std::vector<double> slope_area, linearity, collinearity, disorder, ksn;
};

void observe(const Grid& grid, const Case& c, std::uint64_t seed, Found& found) {
    const support::SteadyLaw law{.theta = c.theta, .scatter = c.scatter};
    const auto heights = rounded(support::steady_raster(grid, law, seed), c.rounding_m);
    const auto dem = support::routed_dem(grid, heights);
    const double relief = *std::ranges::max_element(heights), drop = std::max(0.025 * relief, 3 * c.rounding_m);
    const auto points = channel::fixed_drop_segments(
        dem.graph, dem.area_m2, dem.carved_m, {},
        {.drop_m = drop, .smallest_drop_m = 3 * c.rounding_m, .smallest_area_m2 = 20 * cell_m * cell_m});
    const auto profile = rivers(dem, 20);
    const auto concavity = channel::concavity(profile);
    found.slope_area.push_back(channel::fit_slope_area(channel::slope_area_bins(points)).theta.value);
    found.linearity.push_back(concavity.linearity.value);
    found.collinearity.push_back(concavity.collinearity.value);
    found.disorder.push_back(concavity.disorder.value);
    found.ksn.push_back(median_steepness(profile, c.theta, drop) / (law.slope(1.0)));
}

void judge(const char* of, const char* what, const std::vector<double>& values, double truth, double bias,
           double spread) {
    fmt::print("{:22} {:13} truth {:5.3f}: mean {:+.4f} off, spread {:.4f}\n", of, what, truth, mean(values) - truth,
               standard_deviation(values));
    CHECK(std::abs(mean(values) - truth) < bias);
    CHECK(standard_deviation(values) < spread);
}

}  // namespace

TEST_CASE("Concavity and steepness of rasters made to a law come out near it, by each rule") {
    const Grid grid = plane_grid(120, 120, cell_m, cell_m);
    for (const Case c :
         {Case{"as they are", 0.45, 0, 0}, Case{"as they are", 0.6, 0, 0}, Case{"scatter 0.3", 0.45, 0.3, 0},
          Case{"whole metres", 0.45, 0, 1}, Case{"scatter, whole metres", 0.45, 0.3, 1}}) {
        Found found;
        for (std::uint64_t seed = 1; seed <= seeds; ++seed) observe(grid, c, seed, found);
        const bool clean = c.scatter == 0 && c.rounding_m == 0;
        constexpr double noisy = 0.07;  // where slopes scatter, water chooses: all rules see the rivers that it chose
        judge(c.name, "slope-area", found.slope_area, c.theta, clean ? 0.002 : noisy, clean ? 0.002 : 0.05);
        judge(c.name, "linearity", found.linearity, c.theta, clean ? 0.005 : noisy, clean ? 0.005 : 0.05);
        judge(c.name, "collinearity", found.collinearity, c.theta, clean ? 0.01 : 0.06, clean ? 0.01 : 0.08);
        judge(c.name, "disorder", found.disorder, c.theta, clean ? 0.02 : 0.1, clean ? 0.02 : 0.1);
        judge(c.name, "ksn / ks", found.ksn, 1, clean ? 0.01 : 0.18, clean ? 0.01 : 0.06);
        write_series(fmt::format("estimators_{:.2f}_{:.1f}_{:.0f}", c.theta, c.scatter, c.rounding_m),
                     {{"slope_area", found.slope_area},
                      {"linearity", found.linearity},
                      {"collinearity", found.collinearity},
                      {"disorder", found.disorder},
                      {"ksn_over_ks", found.ksn}});
    }
}

TEST_CASE("Knickpoints of faster uplift are found in most rivers that have one, at the χ which the wave has reached") {
    const Grid grid = plane_grid(120, 120, cell_m, cell_m);
    const evolve::River law{.k = 1e-5, .m = 0.45, .n = 1};
    const double slow = 2e-4, fast = 8e-4, years = 3e5;
    const double reached_chi_m = law.k * std::pow(reference_area_m2, law.m) * years;
    std::vector<double> place, share_found, share_false;
    for (std::uint64_t seed = 1; seed <= 4; ++seed) {
        evolve::Landscape landscape = support::rough_start(support::island(grid, slow), 1, seed);
        REQUIRE(evolve::solve_steady(grid, law, support::island(grid, slow), 20000, landscape).converged);
        evolve::simulate(grid, {law}, support::island(grid, fast),
                         {.step_yr = years / 600, .max_steps = 600, .convergence = 0}, landscape);
        const auto dem = support::routed_dem(grid, landscape.elevation_m);
        const auto profile = rivers(dem, 30);
        const auto chi_m = channel::chi(profile, law.m, reference_area_m2);
        const auto streams = channel::main_streams(profile);
        // A stream has the knickpoint if it begins well below the wave and ends well above it.
        std::vector<double> lowest(streams.parent.size(), 1e9), highest(streams.parent.size(), 0);
        for (Index i = 0; i < profile.size(); ++i) {
            lowest[streams.stream[i]] = std::min(lowest[streams.stream[i]], chi_m[i]);
            highest[streams.stream[i]] = std::max(highest[streams.stream[i]], chi_m[i]);
        }
        std::vector<std::uint8_t> has(streams.parent.size(), 0), was_found(streams.parent.size(), 0);
        for (std::size_t s = 0; s < has.size(); ++s) {
            has[s] = lowest[s] < 0.7 * reached_chi_m && highest[s] > 1.3 * reached_chi_m;
        }
        const double relief = *std::ranges::max_element(profile.elevation_m);
        int false_ones = 0, all = 0;
        for (const auto& k : channel::knickpoints(profile, chi_m, law.m, reference_area_m2, 0.03 * relief)) {
            ++all;
            place.push_back(chi_m[k.row] / reached_chi_m);
            const bool is_the_wave = std::abs(place.back() - 1) <= 0.3;
            false_ones += !is_the_wave;
            if (is_the_wave) was_found[streams.stream[k.row]] = 1;
        }
        int having = 0, found = 0;
        for (std::size_t s = 0; s < has.size(); ++s) {
            having += has[s];
            found += has[s] && was_found[s];
        }
        REQUIRE(having > 10);
        share_found.push_back(static_cast<double>(found) / having);
        share_false.push_back(static_cast<double>(false_ones) / std::max(1, all));
    }
    fmt::print(
        "knickpoints: {:.0f} % of the streams that have one, χ at {:.3f} (median, spread {:.3f}) of the wave's, {:.0f} "
        "% false\n",
        100 * mean(share_found), quantile(place, 0.5), standard_deviation(place), 100 * mean(share_false));
    CHECK(mean(share_found) > 0.85);
    CHECK(quantile(place, 0.5) == Approx(1).margin(0.07));
    CHECK(mean(share_false) < 0.15);
    write_series("knickpoint_places", {{"chi_over_wave", place}});
}
