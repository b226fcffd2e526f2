// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>
#include <vector>

namespace thalweg::evolve {

/// What the river does to a node in one implicit step.
struct SlopeAndIncision {
    double slope;       ///< S, at the end of the step
    double incision_m;  ///< c·S^n, from the law and not from the drop that is left
    int iterations;     ///< calls of pow; 0 where none is needed
};

/// Solves drop = length·S + c·S^n for many nodes with one n.
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

    double n_;
    double second_;  ///< n(n − 1)/2
    double third_;   ///< n(n − 1)(n − 2)/6
    std::vector<Entry> table_;
};

namespace detail {

/// log2 to 2e-6, for positive normal numbers; any other gives some finite number.
inline double quick_log2(double x) {
    constexpr std::int64_t root_of_half = 0x3fe6a09e667f3bcd;
    const auto bits = std::bit_cast<std::int64_t>(x);
    const std::int64_t exponent = (bits - root_of_half) >> 52;
    const double mantissa = std::bit_cast<double>(bits - (exponent << 52));  // in [√½, √2)
    const double t = (mantissa - 1) / (mantissa + 1);
    const double t2 = t * t;
    return static_cast<double>(exponent) +
           t * (2.8853900817779268 + t2 * (0.9617966939259756 + t2 * 0.5770780163555854));
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

/// log2 s by Hermite's cubic between entries; outside the table the one term that counts.
inline double SlopeSolver::table_value(double log_ratio) const {
    const double position = (log_ratio + octaves) * entries_per_octave;
    if (!(position > 0)) return 0;
    if (position >= static_cast<double>(table_.size() - 1)) return -log_ratio / n_;
    const auto at = static_cast<std::uint32_t>(position);
    const double t = position - at;
    const Entry& a = table_[at];
    const Entry& b = table_[at + 1];
    const double chord = b.value - a.value;
    return a.value + t * (a.rise + t * ((3 * chord - 2 * a.rise - b.rise) + t * (a.rise + b.rise - 2 * chord)));
}

inline double SlopeSolver::start(double drop, double length, double c) const {
    const double per_length = 1 / length;
    const double log_gentle = detail::quick_log2(drop * per_length);
    const double log_ratio = detail::quick_log2(c * per_length) + (n_ - 1) * log_gentle;
    return detail::quick_exp2(log_gentle + table_value(log_ratio));
}

inline SlopeAndIncision SlopeSolver::solve_power(double drop, double length, double c) const {
    double slope = start(drop, length, c);
    for (int step = 1; step <= most_steps; ++step) {
        const double power = std::pow(slope, n_);  // n − 1 as exponent would not be exact
        if (!(power >= std::numeric_limits<double>::min())) break;
        const double along = length * slope;
        const double incision = c * power;
        // along·(1 − d) + incision·(1 − d)^n = drop, solved for d as a series in Newton's step e.
        const double inverse = 1 / (along + n_ * incision);
        const double e = (along + incision - drop) * inverse;
        if (!(std::abs(e) < largest_step)) break;
        const double a2 = second_ * incision * inverse;
        const double a3 = third_ * incision * inverse;
        const double d = e * (1 + e * (a2 + e * (2 * a2 * a2 - a3)));
        slope -= slope * d;
        if (std::abs(e) < last_step) return {slope, incision * (1 - d * (n_ - d * (second_ - d * third_))), step};
    }
    return solve_scaled(drop, length, c);
}

}  // namespace thalweg::evolve
