// SPDX-License-Identifier: GPL-3.0-or-later
// One river whose answer is known: the steady profile under Hack's areas, waves that travel up it, and the time it
// takes to answer.
#include <fmt/format.h>

#include <catch2/catch.hpp>
#include <cmath>

#include "series.hpp"
#include "single_river.hpp"

using namespace thalweg;
using namespace thalweg::validation;

namespace {

constexpr double length_m = 40000;

/// A = ka·(distance from the divide)^h, the divide 1 km beyond the head.
struct HackAreas {
    double ka = 6.7, h = 1.7, beyond_m = 1000;
    double operator()(double x) const { return ka * std::pow(length_m + beyond_m - x, h); }
};

/// ∫ A^(−e) dx from the mouth to x.
double integral_of_area(const HackAreas& areas, double e, double x) {
    const double p = 1 - areas.h * e, far = length_m + areas.beyond_m, near = far - x, scale = std::pow(areas.ka, -e);
    if (std::abs(p) < 1e-12) return scale * std::log(far / near);
    return scale * (std::pow(far, p) - std::pow(near, p)) / p;
}

double worst_of_steady_profile(Index steps, double h, double n) {
    const HackAreas areas{.h = h};
    const double uplift = 1e-3, m = 0.5 * n, k = uplift / (std::pow(1e6, m) * std::pow(0.03, n));
    SingleRiver river = single_river(steps, length_m, uplift, areas);
    const evolve::River law{.k = k, .m = m, .n = n};
    const auto result = evolve::simulate(river.grid, {law}, river.setting,
                                         {.step_yr = 1e5, .max_steps = 5000, .convergence = 1e-13}, river.landscape);
    CHECK(result.stop_reason == evolve::StopReason::converged);
    double worst = 0;
    const double steep = std::pow(uplift / k, 1 / n), top = steep * integral_of_area(areas, m / n, length_m);
    for (Index node = 0; node <= steps; ++node) {
        const double exact = steep * integral_of_area(areas, m / n, river.distance(node));
        worst = std::max(worst, std::abs(river.landscape.elevation_m[node] - exact) / top);
    }
    return worst;
}

constexpr double trunk_area_m2 = 1e8;
double same_area(double) { return trunk_area_m2; }

/// Share of a fall of base level that has reached each node of a river steady before.
struct Wave {
    double mid_m, width_m;  ///< where half has come; from where 90 % has to where 10 % has
};

Wave wave_after_fall(Index steps, const evolve::River& law, double uplift, double fall_m, double years,
                     double step_yr) {
    SingleRiver river = single_river(steps, length_m, uplift, same_area);
    const double steep = std::pow(uplift / (law.k * std::pow(trunk_area_m2, law.m)), 1 / law.n);
    for (Index node = 0; node <= steps; ++node) river.landscape.elevation_m[node] = steep * river.distance(node);
    const std::vector<double> before = river.landscape.elevation_m;
    river.landscape.elevation_m[0] -= fall_m;
    run_for(river, law, years, step_yr);
    std::vector<double> share;
    for (Index node = 0; node <= steps; ++node)
        share.push_back((before[node] - river.landscape.elevation_m[node]) / fall_m);
    return {.mid_m = river.step_m * crossing(share, 0.5),
            .width_m = river.step_m * (crossing(share, 0.1) - crossing(share, 0.9))};
}

}  // namespace

TEST_CASE("The steady profile under Hack's areas is the closed form, to first order in the spacing") {
    std::vector<double> spacing, error;
    for (const double h : {1.7, 2.0}) {
        for (const double n : {0.7, 1.0, 2.0}) {
            double coarser = 0;
            for (const Index steps : {200u, 400u, 800u}) {
                const double worst = worst_of_steady_profile(steps, h, n);
                fmt::print("steady profile h {:3.1f} n {:3.1f}: {:4} steps, worst {:.2e} of the relief\n", h, n, steps,
                           worst);
                if (coarser > 0) CHECK(std::log2(coarser / worst) == Approx(1).margin(0.15));
                coarser = worst;
                if (h == 1.7 && n == 1) {
                    spacing.push_back(length_m / steps);
                    error.push_back(worst);
                }
            }
            CHECK(coarser < 0.01);
        }
    }
    write_series("steady_profile", {{"spacing_m", spacing}, {"worst_share_of_relief", error}});
}

TEST_CASE("A fall of base level climbs at k·A^m where n is 1, and its width shrinks with the root of the spacing") {
    const evolve::River law{.k = 1e-5, .m = 0.5, .n = 1};
    const double speed = law.k * std::pow(trunk_area_m2, law.m), years = 0.6 * length_m / speed;
    std::vector<double> spacing, width, off;
    for (const Index steps : {100u, 200u, 400u, 800u}) {
        const double spacing_m = length_m / steps;
        const Wave wave = wave_after_fall(steps, law, 1e-3, 20, years, 0.25 * spacing_m / speed);
        fmt::print("base-level fall, n 1: {:4} nodes, speed off by {:+.3f} %, width {:.0f} m\n", steps,
                   100 * (wave.mid_m / years / speed - 1), wave.width_m);
        if (steps == 400) CHECK(wave.mid_m / years == Approx(speed).epsilon(0.005));
        if (!width.empty()) CHECK(width.back() / wave.width_m == Approx(std::sqrt(2)).epsilon(0.03));
        spacing.push_back(spacing_m);
        width.push_back(wave.width_m);
        off.push_back(std::abs(wave.mid_m / years / speed - 1));
    }
    write_series("knickpoint_width", {{"spacing_m", spacing}, {"width_m", width}});
    write_series("knickpoint_speed", {{"spacing_m", spacing}, {"share_of_the_speed", off}});
}

TEST_CASE("Where n is 2, faster uplift climbs as a shock at (u2 − u1)/(S2 − S1) and a small wave at n·k·A^m·S^(n−1)") {
    const evolve::River law{.k = 1e-8, .m = 1, .n = 2};  // k·A^m = 1 m/yr
    const double slow = 1e-4, fast = 4e-4, gentle = 0.01, steep = 0.02, shock = (fast - slow) / (steep - gentle);
    const Index steps = 400;
    SingleRiver river = single_river(steps, length_m, fast, same_area);
    for (Index node = 0; node <= steps; ++node) river.landscape.elevation_m[node] = gentle * river.distance(node);
    const auto front = [&] {
        std::vector<double> slope;
        for (Index node = 0; node < steps; ++node) {
            slope.push_back((river.landscape.elevation_m[node + 1] - river.landscape.elevation_m[node]) / river.step_m);
        }
        return river.step_m * crossing(slope, 0.5 * (gentle + steep));
    };
    run_for(river, law, 4e5, 500);
    const double early = front();
    run_for(river, law, 6e5, 500);
    const double speed = (front() - early) / 6e5;
    fmt::print("uplift step, n 2: shock speed {:.5f} m/yr, theory {:.5f}\n", speed, shock);
    CHECK(speed == Approx(shock).epsilon(0.01));

    const double ripple = 2 * std::pow(steep, 1), years = 0.6 * length_m / ripple;
    const Wave wave = wave_after_fall(steps, law, fast, 0.02, years, 500);
    fmt::print("small wave, n 2: speed {:.5f} m/yr, theory {:.5f}\n", wave.mid_m / years, ripple);
    CHECK(wave.mid_m / years == Approx(ripple).epsilon(0.01));
    Categories off;
    off.add("shock", std::abs(speed / shock - 1));
    off.add("small wave", std::abs(wave.mid_m / years / ripple - 1));
    write_series("speeds_n_2", off);
}

TEST_CASE("A river raised from the plain stands at u·min(t, τ(x)) where n is 1") {
    const HackAreas areas;
    const evolve::River law{.k = 2e-6, .m = 0.45, .n = 1};
    const double uplift = 5e-4, response = integral_of_area(areas, law.m, length_m) / law.k;
    std::vector<double> spacing, error;
    for (const Index steps : {100u, 200u, 400u, 800u}) {
        double mean_error = 0;
        for (const double share : {0.3, 0.6, 0.9}) {
            SingleRiver river = single_river(steps, length_m, uplift, areas);
            const double years = share * response;
            run_for(river, law, years, response / (4.0 * steps));
            for (Index node = 0; node <= steps; ++node) {
                const double own = integral_of_area(areas, law.m, river.distance(node)) / law.k;
                const double exact = uplift * std::min(own, years);
                mean_error += std::abs(river.landscape.elevation_m[node] - exact) / (uplift * response) / steps / 3;
            }
        }
        fmt::print("response from the plain: {:4} nodes, mean error {:.2e} of the final relief ({:.2f} Myr)\n", steps,
                   mean_error, response / 1e6);
        if (!error.empty()) CHECK(error.back() / mean_error > std::sqrt(2));
        spacing.push_back(length_m / steps);
        error.push_back(mean_error);
    }
    CHECK(error.back() < 0.005);
    write_series("response_time", {{"spacing_m", spacing}, {"mean_error_share_of_relief", error}});
}

namespace {

/// Mean error of a river whose base level or uplift follows a history, over its relief at rest. Where n is 1 heights
/// are carried upstream unchanged, at k·A^m: h(x, t) = b(t − τ(x)) + ∫ u dt from t − τ(x) to t.
double mean_error_under_history(Index steps, const evolve::History& level_m, const evolve::History& factor) {
    const HackAreas areas;
    const evolve::River law{.k = 2e-6, .m = 0.45, .n = 1};
    const double uplift = 5e-4, response = integral_of_area(areas, law.m, length_m) / law.k, years = 0.9 * response;
    SingleRiver river = single_river(steps, length_m, uplift, areas);
    const auto exact = [&](Index node, double time_yr) {
        const double own = integral_of_area(areas, law.m, river.distance(node)) / law.k, since = time_yr - own;
        const double level = level_m.value.empty() ? 0 : evolve::value_at(level_m, since);
        const double mean = own > 0 && !factor.value.empty() ? evolve::mean_between(factor, since, time_yr) : 1;
        return level + uplift * own * mean;
    };
    for (Index node = 0; node <= steps; ++node) river.landscape.elevation_m[node] = exact(node, 0);
    river.setting.base_level_m = level_m;
    river.setting.uplift_factor = factor;
    run_for(river, law, years, response / (4.0 * steps));
    double sum = 0;
    for (Index node = 0; node <= steps; ++node) sum += std::abs(river.landscape.elevation_m[node] - exact(node, years));
    return sum / (uplift * response) / (steps + 1);
}

}  // namespace

TEST_CASE("Base-level and uplift histories climb a river unchanged where n is 1, to first order in the spacing") {
    // Base level falls, stands, and rises slower than the land; uplift swells, jumps and ebbs.
    const evolve::History level{.time_yr = {5e5, 1.5e6, 2.5e6, 4.5e6}, .value = {0, -150, -150, 200}};
    const evolve::History factor{.time_yr = {5e5, 1.5e6, 3e6, 3e6, 5e6}, .value = {1, 2, 2, 0.5, 1}};
    std::vector<double> spacing, by_level, by_uplift;
    for (const Index steps : {100u, 200u, 400u, 800u}) {
        spacing.push_back(length_m / steps);
        by_level.push_back(mean_error_under_history(steps, level, {}));
        by_uplift.push_back(mean_error_under_history(steps, {}, factor));
        fmt::print("histories: {:4} nodes, mean error {:.2e} (base level) and {:.2e} (uplift) of the relief\n", steps,
                   by_level.back(), by_uplift.back());
    }
    for (const auto& error : {by_level, by_uplift}) {
        CHECK(std::log2(error.front() / error.back()) / 3 > 0.8);
        CHECK(error.back() < 2e-3);
    }
    write_series(
        "histories",
        {{"spacing_m", spacing}, {"base_level_share_of_relief", by_level}, {"uplift_share_of_relief", by_uplift}});
}
