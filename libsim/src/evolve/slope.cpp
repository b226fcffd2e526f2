// SPDX-License-Identifier: GPL-3.0-or-later
#include "thalweg/evolve/slope.hpp"

namespace thalweg::evolve {
namespace {

constexpr int most_bracketed_steps = 100;

/// Relative Newton step d for length·S + incision(S) = drop, by Halley's rule.
double halley_step(double slope, double length, double incision, double drop, double n) {
    const double along = length * slope;
    const double inverse = 1 / (along + n * incision);
    const double newton = (along + incision - drop) * inverse;
    return newton / (1 - newton * (0.5 * n * (n - 1)) * incision * inverse);
}

/// Root s of alpha·s + beta·s^n = 1 with one of alpha, beta 1 and the other at most 1: it lies in [2^(−1/min(n, 1)),
/// 1].
SlopeAndIncision bracketed_root(double alpha, double beta, double n) {
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
double incision_bound(double drop, double c, double n) {
    const double quotient = drop / c;
    if (quotient >= std::numeric_limits<double>::min()) return std::pow(quotient, 1 / n);
    return std::pow(drop, 1 / n) / std::pow(c, 1 / n);
}

/// log2 s where s + 2^log_ratio·s^n = 1. The logarithm of the sum is convex with a slope between 1 and n, so Newton's
/// rule descends from the upper bound without overshooting.
double log_root(double log_ratio, double n) {
    double z = std::min(0.0, -log_ratio / n);
    for (int step = 0; step < 60; ++step) {
        const double along = std::exp2(z);
        const double incision = std::exp2(n * z + log_ratio);
        const double change = std::log2(along + incision) * (along + incision) / (along + n * incision);
        z -= change;
        if (std::abs(change) < 1e-7) break;
    }
    return z;
}

}  // namespace

SlopeSolver::SlopeSolver(double n)
    : n_(n), inverse_n_(1 / n), second_(n * (n - 1) / 2), third_(n * (n - 1) * (n - 2) / 6) {
    if (n == 1) return;
    const auto last = static_cast<int>(std::ceil(octaves * (1 + n) * entries_per_octave));
    for (int i = 0; i <= last; ++i) {
        const double log_ratio = i / entries_per_octave - octaves;
        const double z = log_root(log_ratio, n);
        const double along = std::exp2(z);
        const double incision = std::exp2(n * z + log_ratio);
        table_.push_back({z, -incision / (along + n * incision) / entries_per_octave});
    }
}

/// The unknown is scaled by an upper bound, so that all numbers are near 1. The bound itself loses digits when its
/// exponent is large; two Halley steps on the original equation bring them back.
SlopeAndIncision SlopeSolver::solve_scaled(double drop, double length, double c) const {
    if (c == 0) return {drop / length, 0, 0};
    const double log_ratio = std::log(c) - std::log(length) + (n_ - 1) * (std::log(drop) - std::log(length));
    const bool gentle = log_ratio <= 0;
    const double bound = gentle ? drop / length : incision_bound(drop, c, n_);
    SlopeAndIncision root =
        gentle ? bracketed_root(1, std::exp(log_ratio), n_) : bracketed_root(std::exp(-log_ratio / n_), 1, n_);
    root.slope *= bound;
    const auto incision = [&] {
        const double half_power = std::pow(root.slope, 0.5 * n_);  // S^n itself may be too small for a double
        return c * half_power * half_power;
    };
    for (int polish = 0; polish < 2 && root.slope >= std::numeric_limits<double>::min(); ++polish) {
        const double step = halley_step(root.slope, length, incision(), drop, n_);
        if (std::abs(step) < 1e-3) root.slope -= root.slope * step;
    }
    root.incision_m = incision();
    return root;
}

}  // namespace thalweg::evolve
