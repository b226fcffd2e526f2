// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>
#include <vector>

#include "thalweg/core/power.hpp"

namespace thalweg::evolve {

/// What the river does to a node in one implicit step.
struct SlopeAndIncision {
    double slope;       ///< S, at the end of the step
    double incision_m;  ///< c·S^n, from the law and not from the drop that is left
    int iterations;     ///< calls of pow; 0 where none is needed
};

/// Solves drop = length·S + c·S^n for many nodes with one n: S is the slope that a node `drop` above its receiver has
/// at the end of an implicit step, c = dt·k·A^m.
///
/// With s = S·length/drop and g = (c/length)·(drop/length)^(n−1) the equation is s + g·s^n = 1, and log2 s is a smooth
/// function of log2 g alone: a small table of it gives S to about 1e-5, and one evaluation of S^n with a correction of
/// the third order gives the last bits. What leaves the range of that way (numbers beyond 1e±300, a start that is off)
/// is solved on a scaled equation by Newton's rule in a bracket, with bisection where Newton leaves it, in at most 100
/// iterations. Relative error: under 4 units of the last place over min(n, 1) for c, drop and length as in landscapes,
/// under 8 anywhere (test: the end-of-step slope agrees with bisection).
class SlopeSolver {
  public:
    /// n in [0.3, 5].
    explicit SlopeSolver(double n);

    /// drop > 0, length > 0, c ≥ 0.
    SlopeAndIncision operator()(double drop, double length, double c) const {
        if (n_ == 1) {
            const double slope = drop / (length + c);
            return {slope, c * slope, 0};
        }
        return solve_power(drop, length, c);
    }

    /// The same for `lanes` nodes at a time and n ≠ 1, to the same bits; returns the largest number of iterations.
    /// Lanes without drop are given slope 0 and incision 0. A loop without branches, so that it vectorises.
    template <int lanes>
    int solve(const double* drop, const double* length, const double* c, double* slope, double* incision_m) const;

  private:
    /// log2 s and its derivative at one entry of the table.
    struct Entry {
        double value, rise;
    };

    /// A series to third order in e is exact to rounding up to this: its next term is at most 20·e⁴.
    static constexpr double last_step = 5e-5;
    static constexpr double largest_step = 0.3;
    static constexpr int most_steps = 8;
    static constexpr double entries_per_octave = 4;
    static constexpr double octaves = 18;  ///< of g to either side of 1 (times n above): beyond, one term is all

    SlopeAndIncision solve_power(double drop, double length, double c) const;
    SlopeAndIncision solve_scaled(double drop, double length, double c) const;
    double start(double drop, double length, double c) const;
    double table_value(double log_ratio) const;

    /// What the correction of the third order makes of a slope.
    struct Corrected {
        double slope, incision_m;
        double newton_step;  ///< relative; NaN where numbers leave their range
    };
    Corrected correct(double slope, double drop, double length, double c) const;

    double n_;
    double inverse_n_;
    double second_;  ///< n(n − 1)/2
    double third_;   ///< n(n − 1)(n − 2)/6
    std::vector<Entry> table_;
};

namespace detail {

/// log2 to 2e-6, for positive normal numbers; any other gives some finite number.
inline double quick_log2(double x) {
    constexpr std::uint64_t root_of_half = 0x3fe6a09e667f3bcd;
    constexpr std::uint64_t bias = std::uint64_t{1024} << 52;
    constexpr std::uint64_t two_to_52 = 0x4330000000000000;
    const auto bits = std::bit_cast<std::uint64_t>(x);
    const std::uint64_t biased = (bits - root_of_half + bias) >> 52;
    const double exponent = std::bit_cast<double>(biased | two_to_52) - (4503599627370496.0 + 1024);
    const double mantissa = std::bit_cast<double>(bits - (biased << 52) + bias);  // in [√½, √2)
    const double t = (mantissa - 1) / (mantissa + 1);
    const double t2 = t * t;
    return exponent + t * (2.8853900817779268 + t2 * (0.9617966939259756 + t2 * 0.5770780163555854));
}

/// 2^y to 3e-6, for |y| < 1000; for any other some number.
inline double quick_exp2(double y) {
    constexpr double round_to_whole = 6755399441055744.0;  // 1.5·2^52: the sum's low bits are the nearest whole number
    const double shifted = y + round_to_whole;
    const double f = (y - (shifted - round_to_whole)) * 0.6931471805599453;
    const double f2 = f * f;
    const double power =
        (1 + f) + f2 * ((0.5 + f * 0.16666666666666666) + f2 * (0.041666666666666664 + f * 0.008333333333333333));
    return std::bit_cast<double>(std::bit_cast<std::uint64_t>(power) + (std::bit_cast<std::uint64_t>(shifted) << 52));
}

}  // namespace detail

/// log2 s by Hermite's cubic between entries; beyond the end, where one term is all, by the chord's slope −1/n; below
/// the beginning the first entry. Selects of what is at hand and no branches.
inline double SlopeSolver::table_value(double log_ratio) const {
    const double last = static_cast<double>(table_.size() - 1);
    const double position = (log_ratio + octaves) * entries_per_octave;
    const double from_begin = position > 0 ? position : 0;
    const double nearly_last = last * (1 - 1e-12);
    const double inside = from_begin < nearly_last ? from_begin : nearly_last;
    const double beyond = position - nearly_last > 0 ? position - nearly_last : 0;
    const auto at = static_cast<std::int32_t>(inside);
    const double t = inside - at;
    const Entry* const entry = table_.data();
    const double a = entry[at].value, a_rise = entry[at].rise;
    const double b = entry[at + 1].value, b_rise = entry[at + 1].rise;
    const double chord = b - a;
    return a + t * (a_rise + t * ((3 * chord - 2 * a_rise - b_rise) + t * (a_rise + b_rise - 2 * chord))) -
           beyond * inverse_n_ / entries_per_octave;
}

inline double SlopeSolver::start(double drop, double length, double c) const {
    const double per_length = 1 / length;
    const double log_gentle = detail::quick_log2(drop * per_length);
    const double log_ratio = detail::quick_log2(c * per_length) + (n_ - 1) * log_gentle;
    return detail::quick_exp2(log_gentle + table_value(log_ratio));
}

inline SlopeSolver::Corrected SlopeSolver::correct(double slope, double drop, double length, double c) const {
    const double power = normal_power(slope, n_);  // n − 1 as exponent would not be exact
    const double along = length * slope;
    const double incision = c * power;
    // along·(1 − d) + incision·(1 − d)^n = drop, solved for d as a series in Newton's step e.
    const double inverse = 1 / (along + n_ * incision);
    const double e = (along + incision - drop) * inverse;
    const double a2 = second_ * incision * inverse;
    const double a3 = third_ * incision * inverse;
    const double d = e * (1 + e * (a2 + e * (2 * a2 * a2 - a3)));
    return {slope - slope * d, incision * (1 - d * (n_ - d * (second_ - d * third_))), e};
}

inline SlopeAndIncision SlopeSolver::solve_power(double drop, double length, double c) const {
    double slope = start(drop, length, c);
    for (int step = 1; step <= most_steps; ++step) {
        const Corrected corrected = correct(slope, drop, length, c);
        if (!(std::abs(corrected.newton_step) < largest_step)) break;
        slope = corrected.slope;
        if (std::abs(corrected.newton_step) < last_step) return {slope, corrected.incision_m, step};
    }
    return solve_scaled(drop, length, c);
}

template <int lanes>
int SlopeSolver::solve(const double* drop, const double* length, const double* c, double* slope,
                       double* incision_m) const {
    double height[lanes], found[lanes], incision[lanes], newton_step[lanes];
    for (int i = 0; i < lanes; ++i) height[i] = drop[i] > 0 ? drop[i] : 1;
    for (int i = 0; i < lanes; ++i) found[i] = start(height[i], length[i], c[i]);
    for (int i = 0; i < lanes; ++i) {
        const Corrected corrected = correct(found[i], height[i], length[i], c[i]);
        found[i] = corrected.slope;
        incision[i] = corrected.incision_m;
        newton_step[i] = std::abs(corrected.newton_step);
    }
    for (int i = 0; i < lanes; ++i) slope[i] = drop[i] > 0 ? found[i] : 0;
    for (int i = 0; i < lanes; ++i) incision_m[i] = drop[i] > 0 ? incision[i] : 0;
    double largest = 0;
    for (int i = 0; i < lanes; ++i) largest = newton_step[i] < last_step ? largest : 1;
    if (largest == 0) return 1;
    int iterations = 1;
    for (int i = 0; i < lanes; ++i) {
        if (newton_step[i] < last_step || !(drop[i] > 0)) continue;
        const SlopeAndIncision solution = solve_power(drop[i], length[i], c[i]);
        slope[i] = solution.slope;
        incision_m[i] = solution.incision_m;
        iterations = iterations < solution.iterations ? solution.iterations : iterations;
    }
    return iterations;
}

}  // namespace thalweg::evolve
