// SPDX-License-Identifier: GPL-3.0-or-later
#include "thalweg/core/statistics.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace thalweg {

namespace {

constexpr double nan = std::numeric_limits<double>::quiet_NaN();

/// Continued fraction of the incomplete beta function (Abramowitz & Stegun 26.5.8) by the modified Lentz method.
double beta_fraction(double a, double b, double x) {
    constexpr double tiny = 1e-300;
    constexpr double relative_tolerance = 1e-16;
    constexpr int most_terms = 20000;  // needed: about the square root of the larger parameter
    const auto away_from_zero = [](double value) { return std::abs(value) < tiny ? tiny : value; };
    double c = 1;
    double d = 1 / away_from_zero(1 - (a + b) * x / (a + 1));
    double fraction = d;
    for (int m = 1; m <= most_terms; ++m) {
        const double even = m * (b - m) * x / ((a + 2 * m - 1) * (a + 2 * m));
        d = 1 / away_from_zero(1 + even * d);
        c = away_from_zero(1 + even / c);
        fraction *= d * c;
        const double odd = -(a + m) * (a + b + m) * x / ((a + 2 * m) * (a + 2 * m + 1));
        d = 1 / away_from_zero(1 + odd * d);
        c = away_from_zero(1 + odd / c);
        fraction *= d * c;
        if (std::abs(d * c - 1) < relative_tolerance) break;
    }
    return fraction;
}

/// Probability that |T| exceeds t: the regularised incomplete beta function I_x(ν/2, 1/2) at x = ν/(ν + t²).
double two_sided_tail(double t, double degrees_of_freedom) {
    const double a = degrees_of_freedom / 2;
    const double b = 0.5;
    const double x = degrees_of_freedom / (degrees_of_freedom + t * t);
    const double y = t * t / (degrees_of_freedom + t * t);
    const double front =
        std::exp(std::lgamma(a + b) - std::lgamma(a) - std::lgamma(b) + a * std::log(x) + b * std::log(y));
    if (x < (a + 1) / (a + b + 2)) return front * beta_fraction(a, b, x) / a;
    return 1 - front * beta_fraction(b, a, y) / b;
}

/// Normal quantile with the first corrections in 1/ν (Abramowitz & Stegun 26.7.5); from 1e4 on better than 1e-11.
double student_t95_of_many(double degrees_of_freedom) {
    constexpr double z = 1.959963984540054;
    const double first = (z * z * z + z) / 4;
    const double second = (5 * std::pow(z, 5) + 16 * z * z * z + 3 * z) / 96;
    return z + first / degrees_of_freedom + second / (degrees_of_freedom * degrees_of_freedom);
}

struct Moments {
    double weight = 0, x = 0, y = 0;  ///< sum of weights, weighted means
    double xx = 0, xy = 0, yy = 0;    ///< weighted sums of products about the means
};

Moments moments(std::span<const double> x, std::span<const double> y, std::span<const double> weights) {
    Moments sum;
    const auto weight = [&](std::size_t i) { return weights.empty() ? 1.0 : weights[i]; };
    for (std::size_t i = 0; i < x.size(); ++i) {
        sum.weight += weight(i);
        sum.x += weight(i) * x[i];
        sum.y += weight(i) * y[i];
    }
    sum.x /= sum.weight;
    sum.y /= sum.weight;
    for (std::size_t i = 0; i < x.size(); ++i) {
        const double dx = x[i] - sum.x;
        const double dy = y[i] - sum.y;
        sum.xx += weight(i) * dx * dx;
        sum.xy += weight(i) * dx * dy;
        sum.yy += weight(i) * dy * dy;
    }
    return sum;
}

Estimate estimate(double value, double variance, double degrees_of_freedom) {
    const double error = degrees_of_freedom >= 1 ? std::sqrt(variance) : nan;
    const double half = error * student_t95(degrees_of_freedom);
    return {value, error, {value - half, value + half}};
}

}  // namespace

Line fit_line(std::span<const double> x, std::span<const double> y, std::span<const double> weights) {
    constexpr Estimate unknown{nan, nan, {nan, nan}};
    const Moments sum = moments(x, y, weights);
    if (x.size() < 2 || !(sum.xx > 0)) return {unknown, unknown, nan, nan};
    const double slope = sum.xy / sum.xx;
    double residual = 0;
    for (std::size_t i = 0; i < x.size(); ++i) {
        const double off = y[i] - sum.y - slope * (x[i] - sum.x);
        residual += (weights.empty() ? 1.0 : weights[i]) * off * off;
    }
    const double degrees_of_freedom = static_cast<double>(x.size()) - 2;
    const double scale = degrees_of_freedom > 0 ? residual / degrees_of_freedom : nan;
    return {.slope = estimate(slope, scale / sum.xx, degrees_of_freedom),
            .intercept =
                estimate(sum.y - slope * sum.x, scale * (1 / sum.weight + sum.x * sum.x / sum.xx), degrees_of_freedom),
            .r2 = sum.yy > 0 ? 1 - residual / sum.yy : nan,
            .reduced_chi2 = scale};
}

Estimate exponential(const Estimate& logarithm) {
    const double value = std::exp(logarithm.value);
    return {value,
            value * logarithm.standard_error,
            {std::exp(logarithm.interval95[0]), std::exp(logarithm.interval95[1])}};
}

PowerLawFit fit_power_law(std::span<const double> x, std::span<const double> y, std::span<const double> weights) {
    std::vector<double> log_x, log_y, kept;
    for (std::size_t i = 0; i < x.size(); ++i) {
        if (!(x[i] > 0) || !(y[i] > 0)) continue;
        log_x.push_back(std::log(x[i]));
        log_y.push_back(std::log(y[i]));
        if (!weights.empty()) kept.push_back(weights[i]);
    }
    const Line line = fit_line(log_x, log_y, kept);
    return {.coefficient = exponential(line.intercept), .exponent = line.slope, .r2 = line.r2};
}

double mean(std::span<const double> values) {
    double sum = 0;
    for (const double value : values) sum += value;
    return sum / static_cast<double>(values.size());
}

double standard_deviation(std::span<const double> values) {
    if (values.size() < 2) return nan;
    const double center = mean(values);
    double squares = 0;
    for (const double value : values) squares += (value - center) * (value - center);
    return std::sqrt(squares / static_cast<double>(values.size() - 1));
}

double quantile(std::vector<double> values, double share) {
    if (values.empty()) return nan;
    std::ranges::sort(values);
    const double place = share * static_cast<double>(values.size() - 1);
    const auto below = std::min(static_cast<std::size_t>(place), values.size() - 1);
    const auto above = std::min(below + 1, values.size() - 1);
    return values[below] + (place - static_cast<double>(below)) * (values[above] - values[below]);
}

double kolmogorov_distance(std::vector<double> a, std::vector<double> b) {
    if (a.empty() || b.empty()) return nan;
    std::ranges::sort(a);
    std::ranges::sort(b);
    double largest = 0;
    for (std::size_t i = 0, j = 0; i < a.size() && j < b.size();) {
        const double value = std::min(a[i], b[j]);
        while (i < a.size() && a[i] <= value) ++i;
        while (j < b.size() && b[j] <= value) ++j;
        const double gap = static_cast<double>(i) / static_cast<double>(a.size()) -
                           static_cast<double>(j) / static_cast<double>(b.size());
        largest = std::max(largest, std::abs(gap));
    }
    return largest;
}

double student_t95(double degrees_of_freedom) {
    if (!(degrees_of_freedom >= 1)) return nan;
    if (degrees_of_freedom > 1e4) return student_t95_of_many(degrees_of_freedom);
    double low = 1.9;  // brackets the answer: 12.706 for one degree of freedom, 1.96 for many
    double high = 12.8;
    for (int halving = 0; halving < 60; ++halving) {
        const double middle = (low + high) / 2;
        (two_sided_tail(middle, degrees_of_freedom) > 0.05 ? low : high) = middle;
    }
    return (low + high) / 2;
}

}  // namespace thalweg
