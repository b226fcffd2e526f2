// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>

namespace thalweg::evolve {

/// S that solves drop = length·S + c·S^n, and the depth c·S^n that the river law takes there.
struct SlopeAndIncision {
    double slope;
    double incision_m;
    int iterations;
};

namespace detail {

/// After a Halley step of relative size d the relative error is about (n² − 1)/12·d³, under 2·d³ for n ≤ 5.
inline constexpr double last_relative_step = 1e-6;
inline constexpr int most_direct_steps = 8;
inline constexpr int most_bracketed_steps = 100;

/// Relative correction by Halley's rule for length·S + incision(S) = drop, where incision is a power n of S.
inline double halley_step(double slope, double length, double incision, double drop, double n) {
    const double along = length * slope;
    const double inverse = 1 / (along + n * incision);
    const double newton = (along + incision - drop) * inverse;
    return newton / (1 - newton * (0.5 * n * (n - 1)) * incision * inverse);
}

/// The incision after the slope has changed by the factor 1 − step: the power series to the second order, which is
/// exact to rounding for steps up to `last_relative_step`, and spares a call of pow.
inline double moved_incision(double incision, double n, double step) {
    return incision * (1 - n * step * (1 - 0.5 * (n - 1) * step));
}

/// Root s of alpha·s + beta·s^n = 1 with one of alpha, beta 1 and the other at most 1: it lies in [2^(−1/min(n, 1)),
/// 1]. Newton's rule where it stays in the bracket, else bisection.
inline SlopeAndIncision bracketed_root(double alpha, double beta, double n) {
    double low = std::exp2(-1 / std::min(n, 1.0)) * (1 - 1e-12);
    double high = 1;
    double s = high;
    int iterations = 0;
    while (iterations < most_bracketed_steps) {
        ++iterations;
        const double power = beta * std::pow(s, n);
        const double excess = alpha * s + power - 1;
        (excess > 0 ? high : low) = s;
        const double next = s - excess * s / (alpha * s + n * power);
        const double previous = s;
        s = next > low && next < high ? next : 0.5 * (low + high);
        if (std::abs(s - previous) <= 4 * std::numeric_limits<double>::epsilon() * s) break;
    }
    return {s, 0, iterations};
}

/// (drop/c)^(1/n) without losing a quotient that has left the range of doubles.
inline double incision_bound(double drop, double c, double n) {
    const double quotient = drop / c;
    if (quotient >= std::numeric_limits<double>::min()) return std::pow(quotient, 1 / n);
    return std::pow(drop, 1 / n) / std::pow(c, 1 / n);
}

/// The slow way, for any magnitudes: the unknown is scaled by an upper bound, so that all numbers are near 1. The bound
/// itself loses digits when its exponent is large; two Halley steps on the original equation bring them back.
inline SlopeAndIncision scaled_slope(double drop, double length, double c, double n) {
    const double log_ratio = std::log(c) - std::log(length) + (n - 1) * (std::log(drop) - std::log(length));
    const bool gentle = log_ratio <= 0;
    const double bound = gentle ? drop / length : incision_bound(drop, c, n);
    SlopeAndIncision root =
        gentle ? bracketed_root(1, std::exp(log_ratio), n) : bracketed_root(std::exp(-log_ratio / n), 1, n);
    root.slope *= bound;
    const auto incision = [&] {
        const double half_power = std::pow(root.slope, 0.5 * n);  // S^n itself may be too small for a double
        return c * half_power * half_power;
    };
    for (int polish = 0; polish < 2 && root.slope >= std::numeric_limits<double>::min(); ++polish) {
        const double step = halley_step(root.slope, length, incision(), drop, n);
        if (std::abs(step) < 1e-3) root.slope -= root.slope * step;
    }
    root.incision_m = incision();
    return root;
}

/// Slope within some per cent: Halley's rule twice on the logarithm of the sum, whose slope is between 1 and n.
inline double near_slope(double drop, double length, double c, double n) {
    const double gentle = drop / length;
    const double log_ratio = std::log(c / length) + (n - 1) * std::log(gentle);
    double t = std::min(0.0, -log_ratio / n);
    for (int step = 0; step < 2; ++step) {
        const double along = std::exp(t);
        const double incision = std::exp(n * t + log_ratio);
        const double sum = along + incision;
        const double excess = std::log(sum);
        const double rise = (along + n * incision) / sum;
        const double bend = along * incision * (n - 1) * (n - 1) / (sum * sum);
        t -= excess * rise / (rise * rise - 0.5 * excess * bend);
    }
    return gentle * std::exp(t);
}

/// n ≠ 1: Halley steps from a near guess. Anything unusual (a number out of range, a step that is not small) goes the
/// slow and safe way.
inline SlopeAndIncision power_slope(double drop, double length, double c, double n) {
    double slope = near_slope(drop, length, c, n);
    for (int iteration = 1; iteration <= most_direct_steps; ++iteration) {
        const double power = std::pow(slope, n);  // n − 1 as exponent would not be exact
        if (!(power >= std::numeric_limits<double>::min())) break;
        const double incision = c * power;
        const double step = halley_step(slope, length, incision, drop, n);
        if (!(std::abs(step) < 0.5)) break;
        slope -= slope * step;
        if (std::abs(step) < last_relative_step) return {slope, moved_incision(incision, n, step), iteration};
    }
    return scaled_slope(drop, length, c, n);
}

}  // namespace detail

/// drop > 0, length > 0, c ≥ 0, n in [0.3, 5].
inline SlopeAndIncision solve_slope(double drop, double length, double c, double n) {
    if (n == 1) {
        const double slope = drop / (length + c);
        return {slope, c * slope, 0};
    }
    if (c == 0) return {drop / length, 0, 0};
    return detail::power_slope(drop, length, c, n);
}

}  // namespace thalweg::evolve
