// SPDX-License-Identifier: GPL-3.0-or-later
#include "thalweg/core/statistics.hpp"

#include <catch2/catch.hpp>
#include <cmath>
#include <vector>

using namespace thalweg;

TEST_CASE("Student's t at 95 % agrees with published tables") {
    CHECK(student_t95(1) == Approx(12.7062).margin(1e-4));
    CHECK(student_t95(2) == Approx(4.302653).margin(1e-6));
    CHECK(student_t95(3) == Approx(3.182446).margin(1e-6));
    CHECK(student_t95(4) == Approx(2.776445).margin(1e-6));
    CHECK(student_t95(8) == Approx(2.306004).margin(1e-6));
    CHECK(student_t95(10) == Approx(2.228139).margin(1e-6));
    CHECK(student_t95(30) == Approx(2.042272).margin(1e-6));
    CHECK(student_t95(120) == Approx(1.979930).margin(1e-6));
    CHECK(student_t95(1e12) == Approx(1.959963984540054).margin(1e-11));
    CHECK(std::isnan(student_t95(0)));
    CHECK(std::isnan(student_t95(-3)));
}

TEST_CASE("Student's t at 95 % has closed forms for one, two and four degrees of freedom") {
    // ν = 1: tan(π·0.475); ν = 2: t = a·√(2/(1 − a²)) with a = 0.95; ν = 4: a cubic in s = t/√(4 + t²).
    CHECK(student_t95(1) == Approx(std::tan(std::acos(-1.0) * 0.475)).epsilon(1e-12));
    CHECK(student_t95(2) == Approx(0.95 * std::sqrt(2 / (1 - 0.95 * 0.95))).epsilon(1e-12));
    const double t = student_t95(4);
    const double s = t / std::sqrt(4 + t * t);
    CHECK(s * (3 - s * s) / 2 == Approx(0.95).epsilon(1e-12));
}

TEST_CASE("Student's t at 95 % falls steadily, also where the asymptotic series takes over") {
    double last = student_t95(1);
    for (double freedom = 1.25; freedom < 1e8; freedom *= 1.25) {
        const double t = student_t95(freedom);
        CHECK(t < last);
        last = t;
    }
    CHECK(student_t95(10000) == Approx(student_t95(10000.001)).epsilon(1e-9));
}

TEST_CASE("A line through NIST's Norris data has the certified coefficients and errors") {
    const std::vector<double> y{0.1, 338.8, 118.1, 888.0, 9.2,   228.1, 668.5, 998.5, 449.1, 778.9, 559.2, 0.3,
                                0.1, 778.1, 668.8, 339.3, 448.9, 10.8,  557.7, 228.3, 998.0, 888.8, 119.6, 0.3,
                                0.6, 557.6, 339.3, 888.0, 998.5, 778.9, 10.2,  117.6, 228.9, 668.4, 449.2, 0.2};
    const std::vector<double> x{0.2, 337.4, 118.2, 884.6, 10.1,  226.5, 666.3, 996.3, 448.6, 777.0, 558.2, 0.4,
                                0.6, 775.5, 666.9, 338.0, 447.5, 11.6,  556.0, 228.1, 995.8, 887.6, 120.2, 0.3,
                                0.3, 556.8, 339.1, 887.2, 999.0, 779.0, 11.1,  118.3, 229.2, 669.1, 448.9, 0.5};
    const Line line = fit_line(x, y);
    CHECK(line.intercept.value == Approx(-0.262323073774029).epsilon(1e-11));
    CHECK(line.slope.value == Approx(1.00211681802045).epsilon(1e-13));
    CHECK(line.intercept.standard_error == Approx(0.232818234301152).epsilon(1e-11));
    CHECK(line.slope.standard_error == Approx(0.429796848199937e-03).epsilon(1e-11));
    CHECK(std::sqrt(line.reduced_chi2) == Approx(0.884796396144373).epsilon(1e-11));
    CHECK(line.r2 == Approx(0.999993745883712).epsilon(1e-13));
}

TEST_CASE("A line through four points is the one worked out by hand") {
    // x̄ = 1.5, ȳ = 2.5, Sxx = 5, Sxy = 6, Syy = 9: slope 1.2, intercept 0.7, residuals 0.3 −0.9 0.9 −0.3 (sum of
    // squares 1.8), s² = 0.9, var(slope) = 0.18, var(intercept) = 0.9·(1/4 + 2.25/5) = 0.63.
    const std::vector<double> x{0, 1, 2, 3};
    const std::vector<double> y{1, 1, 4, 4};
    const Line line = fit_line(x, y);
    CHECK(line.slope.value == Approx(1.2));
    CHECK(line.intercept.value == Approx(0.7));
    CHECK(line.reduced_chi2 == Approx(0.9));
    CHECK(line.slope.standard_error == Approx(std::sqrt(0.18)));
    CHECK(line.intercept.standard_error == Approx(std::sqrt(0.63)));
    CHECK(line.r2 == Approx(0.8));
    CHECK(line.slope.interval95[0] == Approx(1.2 - 4.302652729911275 * std::sqrt(0.18)));
    CHECK(line.slope.interval95[1] == Approx(1.2 + 4.302652729911275 * std::sqrt(0.18)));
}

TEST_CASE("A weight counts like repeated points, and only ratios of weights matter") {
    const std::vector<double> x{0, 1, 2, 3, 5};
    const std::vector<double> y{1, 1, 4, 4, 9};
    const Line weighted = fit_line(x, y, std::vector<double>{2, 1, 3, 1, 1});
    const Line repeated =
        fit_line(std::vector<double>{0, 0, 1, 2, 2, 2, 3, 5}, std::vector<double>{1, 1, 1, 4, 4, 4, 4, 9});
    CHECK(weighted.slope.value == Approx(repeated.slope.value));
    CHECK(weighted.intercept.value == Approx(repeated.intercept.value));
    CHECK(weighted.r2 == Approx(repeated.r2));
    const Line scaled = fit_line(x, y, std::vector<double>{200, 100, 300, 100, 100});
    CHECK(scaled.slope.standard_error == Approx(weighted.slope.standard_error));
    CHECK(scaled.reduced_chi2 == Approx(100 * weighted.reduced_chi2));
}

TEST_CASE("What too few points cannot tell is NaN") {
    const Line two = fit_line(std::vector<double>{1, 2}, std::vector<double>{3, 5});
    CHECK(two.slope.value == Approx(2));
    CHECK(two.intercept.value == Approx(1));
    CHECK(std::isnan(two.slope.standard_error));
    CHECK(std::isnan(two.intercept.interval95[0]));
    CHECK(std::isnan(two.reduced_chi2));
    const Line one = fit_line(std::vector<double>{1}, std::vector<double>{3});
    CHECK(std::isnan(one.slope.value));
    CHECK(std::isnan(one.intercept.value));
    const Line upright = fit_line(std::vector<double>{1, 1, 1}, std::vector<double>{3, 4, 5});
    CHECK(std::isnan(upright.slope.value));
    CHECK(std::isnan(fit_line({}, {}).slope.value));
}

TEST_CASE("The mean of nothing is NaN") {
    CHECK(mean(std::vector<double>{1, 2, 6}) == Approx(3));
    CHECK(std::isnan(mean({})));
}

TEST_CASE("A power law is found again from its own points, and pairs that have no logarithm are left out") {
    std::vector<double> x, y, weight;
    for (double at = 1; at < 100; at *= 1.7) {
        x.push_back(at);
        y.push_back(3 * std::pow(at, -0.6));
        weight.push_back(at);
    }
    x.insert(x.end(), {0, 5, 7});
    y.insert(y.end(), {1, -1, NAN});
    weight.insert(weight.end(), {1e6, 1e6, 1e6});
    for (const PowerLawFit& law : {fit_power_law(x, y), fit_power_law(x, y, weight)}) {
        CHECK(law.coefficient.value == Approx(3));
        CHECK(law.exponent.value == Approx(-0.6));
        CHECK(law.r2 == Approx(1));
    }
}

TEST_CASE("An estimate's exponential keeps the interval's ends and the error to first order") {
    const Estimate e = exponential({std::log(5.0), 0.1, {std::log(4.0), std::log(6.0)}});
    CHECK(e.value == Approx(5));
    CHECK(e.standard_error == Approx(0.5));
    CHECK(e.interval95[0] == Approx(4));
    CHECK(e.interval95[1] == Approx(6));
}

TEST_CASE("Deviation and quantiles of a small sample are those worked out by hand") {
    CHECK(standard_deviation(std::vector<double>{2, 4, 4, 6}) == Approx(std::sqrt(8 / 3.0)));
    CHECK(std::isnan(standard_deviation(std::vector<double>{2})));
    const std::vector<double> values{30, 10, 20, 50};
    CHECK(quantile(values, 0) == 10);
    CHECK(quantile(values, 1) == 50);
    CHECK(quantile(values, 0.5) == 25);
    CHECK(quantile(values, 0.25) == Approx(17.5));
    CHECK(std::isnan(quantile({}, 0.5)));
}

TEST_CASE("The Kolmogorov distance of small samples is the one drawn by hand, also with ties") {
    CHECK(kolmogorov_distance({1, 2, 3, 4}, {1, 2, 3, 4}) == 0);
    CHECK(kolmogorov_distance({1, 2}, {3, 4}) == 1);
    CHECK(kolmogorov_distance({1, 2, 3, 4}, {3, 4, 5, 6}) == Approx(0.5));
    CHECK(kolmogorov_distance({2, 2, 2, 5}, {2, 7}) == Approx(0.5));
    CHECK(kolmogorov_distance({4, 1, 3, 2}, {2.5}) == Approx(0.5));
    CHECK(std::isnan(kolmogorov_distance({}, {1})));
}
