// SPDX-License-Identifier: GPL-3.0-or-later
#include "thalweg/infer/slope_area_fit.hpp"

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <vector>

#include "support/steady_landscape.hpp"
#include "thalweg/core/error.hpp"
#include "thalweg/core/random.hpp"

using namespace thalweg;
using channel::SlopeAreaBin;
using infer::fit_slope_area;
using infer::SlopeAreaFit;
using infer::SlopeAreaFitOptions;

namespace {

/// S = (u/(k·A^m))^(1/n) at `count` areas from 1e5 m² up, ten to the decade, with stated relative errors.
struct PowerLaw {
    double k = 5.6e-7, m = 0.5, n = 1, uplift = 4e-4;
    double slope(double area) const { return std::pow(uplift / (k * std::pow(area, m)), 1 / n); }
};

std::vector<SlopeAreaBin> exact_bins(const PowerLaw& law, int count, double relative_error = 0.02) {
    std::vector<SlopeAreaBin> bins;
    for (int i = 0; i < count; ++i) {
        const double area = 1e5 * std::pow(10, i / 10.0);
        bins.push_back({area, law.slope(area), relative_error * law.slope(area), 10});
    }
    return bins;
}

void scatter(std::vector<SlopeAreaBin>& bins, double sd, Random& random) {
    for (SlopeAreaBin& bin : bins) {
        const double factor = std::exp(sd * random.normal());
        bin.slope *= factor;
        bin.slope_se *= factor;
    }
}

bool covers(const Estimate& estimate, double truth) {
    return estimate.interval95[0] <= truth && truth <= estimate.interval95[1];
}

/// Weighted straight line by the normal equations, uncentred: intercept, slope and their covariance.
struct NormalEquations {
    double intercept, slope, variance_intercept, variance_slope, covariance;
};

NormalEquations normal_equations(const std::vector<SlopeAreaBin>& bins) {
    long double s = 0, sx = 0, sy = 0, sxx = 0, sxy = 0;
    const std::vector<double> error = channel::bin_errors(bins, 0.01);
    for (std::size_t i = 0; i < bins.size(); ++i) {
        const SlopeAreaBin& bin = bins[i];
        const long double w = 1.0L / (static_cast<long double>(error[i]) * error[i]);
        const long double x = std::log(static_cast<long double>(bin.area_m2));
        const long double y = std::log(static_cast<long double>(bin.slope));
        s += w, sx += w * x, sy += w * y, sxx += w * x * x, sxy += w * x * y;
    }
    const long double d = s * sxx - sx * sx;
    const auto real = [](long double value) { return static_cast<double>(value); };
    return {real((sxx * sy - sx * sxy) / d), real((s * sxy - sx * sy) / d), real(sxx / d), real(s / d), real(-sx / d)};
}

}  // namespace

TEST_CASE("An exact power law gives back its k and m, whatever n") {
    for (const double n : {0.5, 0.8, 1.0, 1.5, 2.0, 4.0}) {
        for (const double theta : {0.2, 0.35, 0.5, 0.8}) {
            const PowerLaw law{.k = 3e-6, .m = theta * n, .n = n, .uplift = 2e-4};
            const SlopeAreaFit fit = fit_slope_area(exact_bins(law, 25), {.n = n, .uplift_m_per_yr = law.uplift});
            CHECK(fit.converged);
            CHECK(fit.m.value == Approx(law.m).epsilon(1e-9));
            CHECK(fit.theta.value == Approx(theta).epsilon(1e-9));
            REQUIRE(fit.k.has_value());
            CHECK(fit.k->value == Approx(law.k).epsilon(1e-7));
            CHECK(fit.k_over_uplift.value == Approx(law.k / law.uplift).epsilon(1e-7));
            CHECK(fit.ks.value == Approx(std::pow(law.uplift / law.k, 1 / n)).epsilon(1e-7));
            CHECK(fit.k_at_reference_area.value ==
                  Approx(law.k * std::pow(fit.reference_area_m2, law.m)).epsilon(1e-9));
            CHECK(fit.reduced_chi2 < 1e-10);
            for (std::size_t i = 0; i < fit.bins.size(); ++i) {
                CHECK(fit.fitted_slope[i] == Approx(fit.bins[i].slope).epsilon(1e-9));
            }
        }
    }
}

TEST_CASE("Without outliers the fit is closed-form weighted least squares") {
    std::vector<SlopeAreaBin> bins = exact_bins({}, 20, 0.05);
    for (std::size_t i = 0; i < bins.size(); ++i) {  // uneven errors of 5 to 15 %, residuals within one of them
        const double error = 0.05 + 0.01 * static_cast<double>(i % 11);
        bins[i].slope *= std::exp(error * std::sin(7.0 * static_cast<double>(i)));
        bins[i].slope_se = error * bins[i].slope;
    }
    const NormalEquations line = normal_equations(bins);
    const double n = 1.5;
    const SlopeAreaFit fit = fit_slope_area(bins, {.n = n, .uplift_m_per_yr = 4e-4});
    CHECK(fit.reduced_chi2 < 1);
    CHECK(fit.theta.value == Approx(-line.slope).epsilon(1e-8));
    CHECK(fit.theta.standard_error == Approx(std::sqrt(line.variance_slope)).epsilon(1e-6));
    CHECK(fit.ks.value == Approx(std::exp(line.intercept)).epsilon(1e-7));
    CHECK(fit.ks.standard_error == Approx(std::exp(line.intercept) * std::sqrt(line.variance_intercept)).epsilon(1e-6));
    CHECK(fit.m.standard_error == Approx(n * std::sqrt(line.variance_slope)).epsilon(1e-6));
    CHECK(fit.k->standard_error == Approx(fit.k->value * n * std::sqrt(line.variance_intercept)).epsilon(1e-6));
    const double correlation = line.covariance / std::sqrt(line.variance_slope * line.variance_intercept);
    CHECK(fit.correlation_log_k_m == Approx(correlation).epsilon(1e-6));
    CHECK(std::abs(fit.correlation_log_k_m) > 0.98);
    const channel::SlopeArea regression = channel::fit_slope_area(bins);
    CHECK(regression.theta.value == Approx(fit.theta.value).epsilon(1e-8));
}

TEST_CASE("The 95 % intervals cover the truth in 90 to 98 % of trials with known scatter") {
    const PowerLaw law{.k = 2e-6, .m = 0.45, .n = 1.2, .uplift = 5e-4};
    constexpr int trials = 2000;
    int m_covered = 0, k_covered = 0, reference_covered = 0;
    for (int trial = 0; trial < trials; ++trial) {
        Random random(2024, static_cast<std::uint32_t>(trial));
        std::vector<SlopeAreaBin> bins = exact_bins(law, 18, 0.08);
        scatter(bins, 0.08, random);
        const SlopeAreaFit fit = fit_slope_area(bins, {.n = law.n, .uplift_m_per_yr = law.uplift});
        m_covered += covers(fit.m, law.m);
        k_covered += covers(*fit.k, law.k);
        reference_covered += covers(fit.k_at_reference_area, law.k * std::pow(fit.reference_area_m2, law.m));
    }
    CAPTURE(m_covered, k_covered, reference_covered);
    for (const int covered : {m_covered, k_covered, reference_covered}) {
        CHECK(covered >= 0.90 * trials);
        CHECK(covered <= 0.98 * trials);
    }
}

TEST_CASE("Scatter beyond the stated errors widens the interval until it covers again") {
    const PowerLaw law;
    constexpr int trials = 1000;
    int covered = 0;
    for (int trial = 0; trial < trials; ++trial) {
        Random random(7, static_cast<std::uint32_t>(trial));
        std::vector<SlopeAreaBin> bins = exact_bins(law, 18, 0.03);
        scatter(bins, 0.15, random);  // five times what the bins admit
        covered += covers(fit_slope_area(bins, {.uplift_m_per_yr = law.uplift}).m, law.m);
    }
    CHECK(covered >= 0.90 * trials);
    CHECK(covered <= 0.98 * trials);
}

TEST_CASE("The interval covers when points are scattered, binned and then fitted") {
    const PowerLaw law;
    constexpr int trials = 500;
    int covered = 0;
    for (int trial = 0; trial < trials; ++trial) {
        Random random(11, static_cast<std::uint32_t>(trial));
        std::vector<channel::SlopeAreaPoint> points;
        for (int i = 0; i < 1500; ++i) {  // as many as rivers have: fewer the larger the area
            const double area = 1e5 / std::pow(1 - random.uniform() * 0.999, 1.2);
            points.push_back({area, law.slope(area) * std::exp(0.3 * random.normal())});
        }
        const auto bins = channel::slope_area_bins(points);
        covered += covers(fit_slope_area(bins, {.uplift_m_per_yr = law.uplift}).m, law.m);
    }
    CAPTURE(covered);
    CHECK(covered >= 0.90 * trials);
    CHECK(covered <= 0.985 * trials);
}

TEST_CASE("One wild bin hardly moves the fit") {
    const PowerLaw law;
    Random random(3, 0);
    std::vector<SlopeAreaBin> bins = exact_bins(law, 20, 0.03);
    scatter(bins, 0.03, random);
    const SlopeAreaFit clean = fit_slope_area(bins, {.uplift_m_per_yr = law.uplift});
    bins.back().slope *= 10;  // a bin at the end has the longest lever
    bins.back().slope_se *= 10;
    const SlopeAreaFit robust = fit_slope_area(bins, {.uplift_m_per_yr = law.uplift});
    CHECK(std::abs(robust.m.value - clean.m.value) < 0.01);
    CHECK(covers(robust.m, law.m));
    CHECK(std::abs(-normal_equations(bins).slope - law.m) > 0.03);  // least squares without Huber's loss is moved
}

TEST_CASE("Where a bin is resisted, errors of steepness and k are those of the weights it is left with") {
    std::vector<SlopeAreaBin> bins = exact_bins({}, 20, 0.05);
    bins.back().slope *= 3;  // its weight falls to 1.345/|r|, which moves the centre of the weights off A0
    bins.back().slope_se *= 3;
    const SlopeAreaFit fit = fit_slope_area(bins, {.uplift_m_per_yr = 4e-4});
    const double residual = std::log(bins.back().slope / fit.fitted_slope.back()) / 0.05;
    REQUIRE(residual > 10);
    bins.back().slope_se *= std::sqrt(residual / 1.345);
    double s = 0, sx = 0, sxx = 0;
    for (const SlopeAreaBin& bin : bins) {
        const double w = std::pow(bin.slope / bin.slope_se, 2), x = std::log(bin.area_m2);
        s += w, sx += w * x, sxx += w * x * x;
    }
    const double determinant = s * sxx - sx * sx;
    const double scale = std::sqrt(std::max(1.0, fit.reduced_chi2));
    CHECK(fit.ks.standard_error / fit.ks.value == Approx(scale * std::sqrt(sxx / determinant)).epsilon(1e-3));
    CHECK(fit.theta.standard_error == Approx(scale * std::sqrt(s / determinant)).epsilon(1e-3));
    CHECK(fit.correlation_log_k_m == Approx(-sx / std::sqrt(s * sxx)).epsilon(1e-4));
}

TEST_CASE("With deposition k and k/u are 1 + G times as large, and theta, ks and m the same") {
    Random random(2, 1);
    std::vector<SlopeAreaBin> bins = exact_bins({}, 20, 0.05);
    scatter(bins, 0.1, random);
    const SlopeAreaFit plain = fit_slope_area(bins, {.n = 1.5, .uplift_m_per_yr = 1e-4});
    const SlopeAreaFit with = fit_slope_area(bins, {.n = 1.5, .uplift_m_per_yr = 1e-4, .deposition_g = 0.7});
    CHECK(with.k->value == Approx(1.7 * plain.k->value).epsilon(1e-12));
    CHECK(with.k->interval95[1] == Approx(1.7 * plain.k->interval95[1]).epsilon(1e-12));
    CHECK(with.k->standard_error == Approx(1.7 * plain.k->standard_error).epsilon(1e-12));
    CHECK(with.k_over_uplift.value == Approx(1.7 * plain.k_over_uplift.value).epsilon(1e-12));
    CHECK(with.k_at_reference_area.value == Approx(1.7 * plain.k_at_reference_area.value).epsilon(1e-12));
    CHECK(with.ks.value == plain.ks.value);
    CHECK(with.theta.value == plain.theta.value);
    CHECK(with.m.value == plain.m.value);
    CHECK(with.correlation_log_k_m == plain.correlation_log_k_m);
}

TEST_CASE("Without an uplift rate k is unknown but k/u is told") {
    const PowerLaw law;
    const SlopeAreaFit fit = fit_slope_area(exact_bins(law, 15), SlopeAreaFitOptions{});
    CHECK_FALSE(fit.k.has_value());
    CHECK(std::isnan(fit.k_at_reference_area.value));
    CHECK(fit.k_over_uplift.value == Approx(law.k / law.uplift).epsilon(1e-7));
    CHECK(std::ranges::count(fit.identifiable, "k") == 0);
    CHECK(std::ranges::count(fit.identifiable, "k_over_uplift") == 1);
    REQUIRE_FALSE(fit.notes.empty());
    CHECK(fit.notes.front().find("give the uplift rate") != std::string::npos);
}

TEST_CASE("The uplift's uncertainty goes into k and not into m") {
    const PowerLaw law;
    const auto bins = exact_bins(law, 15);
    const SlopeAreaFit sure = fit_slope_area(bins, {.uplift_m_per_yr = 4e-4});
    const SlopeAreaFit unsure = fit_slope_area(bins, {.uplift_m_per_yr = 4e-4, .uplift_sd_m_per_yr = 1e-4});
    const auto relative = [](const Estimate& e) { return e.standard_error / e.value; };
    CHECK(relative(*unsure.k) == Approx(std::hypot(relative(*sure.k), 0.25)));
    CHECK(relative(unsure.k_at_reference_area) == Approx(std::hypot(relative(sure.k_at_reference_area), 0.25)));
    CHECK(unsure.m.standard_error == sure.m.standard_error);
    CHECK(unsure.k_over_uplift.standard_error == sure.k_over_uplift.standard_error);
    CHECK(std::abs(unsure.correlation_log_k_m) < std::abs(sure.correlation_log_k_m));
}

TEST_CASE("The interval of k is symmetric in the logarithm and stays positive") {
    std::vector<SlopeAreaBin> bins = exact_bins({}, 4, 0.5);
    const SlopeAreaFit fit = fit_slope_area(bins, {.uplift_m_per_yr = 4e-4});
    CHECK(fit.k->interval95[0] > 0);
    CHECK(fit.k->interval95[0] * fit.k->interval95[1] == Approx(fit.k->value * fit.k->value));
    const double spread = std::log(fit.k->interval95[1] / fit.k->value);
    CHECK(spread == Approx(student_t95(2) * fit.k->standard_error / fit.k->value));
}

TEST_CASE("A fixed concavity is kept, and the steepness is the weighted mean at that concavity") {
    std::vector<SlopeAreaBin> bins = exact_bins({.m = 0.5}, 12, 0.05);
    for (std::size_t i = 0; i < bins.size(); ++i) bins[i].slope_se *= 1 + 0.1 * static_cast<double>(i % 4);
    const double theta = 0.49;
    double weights = 0, sum = 0;
    const std::vector<double> error = channel::bin_errors(bins, 0.01);
    for (std::size_t i = 0; i < bins.size(); ++i) {
        weights += 1 / (error[i] * error[i]);
        sum += (std::log(bins[i].slope) + theta * std::log(bins[i].area_m2)) / (error[i] * error[i]);
    }
    const SlopeAreaFit fit = fit_slope_area(bins, {.n = 2, .uplift_m_per_yr = 4e-4, .theta_fixed = theta});
    CHECK(fit.theta.value == theta);
    CHECK(fit.m.value == 2 * theta);
    CHECK(fit.m.standard_error == 0);
    CHECK(fit.degrees_of_freedom == 11);
    CHECK(std::isnan(fit.correlation_log_k_m));
    CHECK(fit.ks.value == Approx(std::exp(sum / weights)).epsilon(1e-8));
    CHECK(fit.ks.standard_error == Approx(fit.ks.value / std::sqrt(weights)).epsilon(1e-6));
    CHECK(std::ranges::count(fit.identifiable, "m") == 0);
}

TEST_CASE("Only bins within the range of areas are fitted") {
    std::vector<SlopeAreaBin> bins = exact_bins({}, 30);
    for (SlopeAreaBin& bin : bins) {
        if (bin.area_m2 < 1e6) bin.slope = 0.6;  // hillslopes at the talus angle
    }
    const SlopeAreaFit fit = fit_slope_area(bins, {.uplift_m_per_yr = 4e-4, .area_min_m2 = 1e6, .area_max_m2 = 5e7});
    CHECK(fit.m.value == Approx(0.5).epsilon(1e-9));
    CHECK(fit.bins.size() == 17);
    CHECK(fit.area_range_m2[0] >= 1e6);
    CHECK(fit.area_range_m2[1] <= 5e7);
    CHECK(fit.reference_area_m2 > fit.area_range_m2[0]);
    CHECK(fit.reference_area_m2 < fit.area_range_m2[1]);
}

TEST_CASE("A bin of few points shares the scatter of all bins, one of many keeps its own") {
    // Scatter of a point: 0.3 in a bin of 100 001, 0.01 in a bin of two and 0.6 in a bin of eleven.
    const std::vector<SlopeAreaBin> bins{{1e5, 1, 0.3 / std::sqrt(100001.0), 100001},
                                         {1e6, 1, 0.01 / std::sqrt(2.0), 2},
                                         {1e7, 1, 0.6 / std::sqrt(11.0), 11}};
    const double pooled = (100000 * 0.09 + 1 * 0.0001 + 10 * 0.36) / 100011;
    const std::vector<double> error = channel::bin_errors(bins, 1e-9);
    CHECK(error[0] == Approx(0.3 / std::sqrt(100001.0)).epsilon(1e-4));
    CHECK(error[1] == Approx(std::sqrt((4 * pooled + 0.0001) / 5 / 2)));
    CHECK(error[2] == Approx(std::sqrt((4 * pooled + 10 * 0.36) / 14 / 11)));
}

TEST_CASE("A bin of one point, which knows no error of its own, weighs by the pooled scatter") {
    std::vector<SlopeAreaBin> bins = exact_bins({}, 10, 0.1);
    for (SlopeAreaBin& bin : bins) bin.count = 16;  // so a single point scatters by 0.1·√16 = 0.4
    bins[5].count = 1;
    bins[5].slope_se = std::nan("");
    CHECK(channel::bin_errors(bins, 0.01)[5] == Approx(0.4));
    CHECK(channel::bin_errors(bins, 0.01)[4] == Approx(0.1));
    const SlopeAreaFit fit = fit_slope_area(bins, SlopeAreaFitOptions{});
    CHECK(fit.m.value == Approx(0.5).epsilon(1e-9));
    CHECK(std::isfinite(fit.m.standard_error));
    for (SlopeAreaBin& bin : bins) bin.slope_se = std::nan(""), bin.count = 1;
    for (const double error : channel::bin_errors(bins, 0.01)) CHECK(error == Approx(0.01 * std::log(10)));
}

TEST_CASE("The floor in powers of ten keeps clean bins from claiming more than the law can hold") {
    const SlopeAreaFit fit = fit_slope_area(exact_bins({}, 20, 1e-6), {.smallest_se_dex = 0.01});
    const SlopeAreaFit twice = fit_slope_area(exact_bins({}, 20, 1e-6), {.smallest_se_dex = 0.02});
    CHECK(twice.m.standard_error == Approx(2 * fit.m.standard_error).epsilon(1e-6));
    // Equal errors σ on 20 points 0.1·ln 10 apart: var(slope) = σ²/Σ(x − x̄)², Σ(i − ī)² = 20·399/12 = 665.
    CHECK(fit.m.standard_error == Approx(0.01 / (0.1 * std::sqrt(665.0))).epsilon(1e-6));
}

TEST_CASE("Curvature is nought for a power law and found where the bins bend") {
    std::vector<SlopeAreaBin> bins = exact_bins({}, 20, 0.02);
    CHECK(std::abs(fit_slope_area(bins, SlopeAreaFitOptions{}).curvature.value) < 1e-10);
    const double middle = fit_slope_area(bins, SlopeAreaFitOptions{}).reference_area_m2;
    for (SlopeAreaBin& bin : bins) bin.slope *= std::exp(0.05 * std::pow(std::log(bin.area_m2 / middle), 2));
    for (SlopeAreaBin& bin : bins) bin.slope_se = 0.02 * bin.slope;
    const SlopeAreaFit bent = fit_slope_area(bins, SlopeAreaFitOptions{});
    CHECK(bent.curvature.value == Approx(0.05));
    CHECK(bent.curvature.interval95[0] > 0);
    CHECK(std::ranges::any_of(bent.notes, [](const auto& note) { return note.find("curved") != std::string::npos; }));
}

TEST_CASE("The same bins give the same bytes") {
    Random random(1, 1);
    std::vector<SlopeAreaBin> bins = exact_bins({}, 20, 0.05);
    scatter(bins, 0.2, random);
    const SlopeAreaFit first = fit_slope_area(bins, {.uplift_m_per_yr = 1e-3});
    const SlopeAreaFit second = fit_slope_area(bins, {.uplift_m_per_yr = 1e-3});
    CHECK(first.k->value == second.k->value);
    CHECK(first.m.interval95 == second.m.interval95);
}

TEST_CASE("What cannot be fitted is refused in one sentence") {
    const auto message = [](const std::vector<SlopeAreaBin>& bins, const SlopeAreaFitOptions& options) -> std::string {
        try {
            fit_slope_area(bins, options);
        } catch (const Error& error) {
            return error.what();
        }
        return "";
    };
    const auto bins = exact_bins({}, 10);
    CHECK(message(exact_bins({}, 2), {}).find("at least 3 bins") != std::string::npos);
    CHECK(message(bins, {.area_min_m2 = 7e5}).find("there are 1") != std::string::npos);
    CHECK(message(bins, {.n = 0}).find("n must be") != std::string::npos);
    CHECK(message(bins, {.uplift_m_per_yr = -1e-4}).find("uplift rate") != std::string::npos);
    CHECK(message(bins, {.uplift_sd_m_per_yr = -1}).find("standard deviation") != std::string::npos);
    CHECK(message(bins, {.deposition_g = -1}).find("G must be 0 or more") != std::string::npos);
    CHECK(message(bins, {.area_min_m2 = 1e6, .area_max_m2 = 1e5}).find("span a range") != std::string::npos);
    CHECK(message(bins, {.theta_fixed = std::nan("")}).find("theta") != std::string::npos);
    CHECK(message(bins, {.smallest_se_dex = 0}).find("dex") != std::string::npos);
    CHECK(message({bins[0], bins[0], bins[0]}, {}).find("widen the range") != std::string::npos);
    CHECK(message(bins, {}).empty());
}

TEST_CASE("A steady landscape gives back k and m from its nodes and from its DEM") {
    const Grid grid = plane_grid(160, 160, 90, 90);
    const double uplift = 4e-4;
    for (const double n : {1.0, 1.5}) {
        for (const double m : {0.35, 0.5}) {
            const support::SteadyLaw law{.theta = m / n};
            const auto height = support::steady_raster(grid, law, 5);
            const support::RoutedDem dem = support::routed_dem(grid, height);
            const double truth = uplift / std::pow(law.slope_at_reference, n);  // k·A0^m
            const auto fit_of = [&](const std::vector<channel::SlopeAreaPoint>& points) {
                return fit_slope_area(channel::slope_area_bins(points), {.n = n, .uplift_m_per_yr = uplift});
            };
            const auto at_reference = [&](const SlopeAreaFit& fit) {
                return fit.k->value * std::pow(law.reference_area_m2, fit.m.value);
            };
            const SlopeAreaFit nodes = fit_of(channel::node_slopes(dem.graph, dem.area_m2, height));
            CHECK(std::abs(nodes.m.value - m) < 1e-3);
            CHECK(at_reference(nodes) == Approx(truth).epsilon(0.01));
            const double relief = *std::ranges::max_element(height);
            const SlopeAreaFit raster = fit_of(channel::fixed_drop_segments(
                dem.graph, dem.area_m2, dem.carved_m, {}, {.drop_m = 0.025 * relief, .smallest_area_m2 = 2e5}));
            CHECK(std::abs(raster.m.value - m) < 0.002);
            CHECK(at_reference(raster) == Approx(truth).epsilon(0.005));
            CHECK(covers(raster.m, m));
        }
    }
}

TEST_CASE("The interval covers the truth when the slopes of a landscape's nodes are measured with scatter") {
    const Grid grid = plane_grid(96, 96, 90, 90);
    const support::SteadyLaw law;
    const auto height = support::steady_raster(grid, law, 9);
    const support::RoutedDem dem = support::routed_dem(grid, height);
    const auto exact = channel::node_slopes(dem.graph, dem.area_m2, height);
    constexpr int trials = 300;
    int m_covered = 0, ks_covered = 0;
    for (int trial = 0; trial < trials; ++trial) {
        Random random(41, static_cast<std::uint32_t>(trial));
        auto points = exact;
        for (channel::SlopeAreaPoint& point : points) point.slope *= std::exp(0.8 * random.normal());
        const SlopeAreaFit fit = fit_slope_area(channel::slope_area_bins(points), {.area_min_m2 = 1e5});
        m_covered += covers(fit.m, law.theta);
        ks_covered += covers(fit.ks, law.slope_at_reference * std::pow(law.reference_area_m2, law.theta));
    }
    CAPTURE(m_covered, ks_covered);
    for (const int covered : {m_covered, ks_covered}) {
        CHECK(covered >= 0.90 * trials);
        CHECK(covered <= 0.98 * trials);
    }
}
