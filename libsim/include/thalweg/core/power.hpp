// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>

namespace thalweg {

/// A logarithm in two doubles, the second far smaller than the first.
struct LogarithmOfTwo {
    double high, low;
};

/// log2 of a positive normal number, absolute error under 2e-18·(1 + |log2|): x = 2^k·m with m in [√½, √2), and log2 m
/// = 2/ln 2·artanh(t) with t = (m − 1)/(m + 1), whose first term is kept in two doubles. Neither branch nor table, so
/// that a loop over it vectorises; fused operations stand where they are meant, so the bytes are the same everywhere.
inline LogarithmOfTwo precise_log2(double x) {
    constexpr std::uint64_t root_of_half = 0x3fe6a09e667f3bcd;
    constexpr std::uint64_t bias = std::uint64_t{1024} << 52;
    constexpr std::uint64_t two_to_52 = 0x4330000000000000;
    const auto bits = std::bit_cast<std::uint64_t>(x);
    const std::uint64_t biased = (bits - root_of_half + bias) >> 52;  // k + 1024
    const double k = std::bit_cast<double>(biased | two_to_52) - (4503599627370496.0 + 1024);
    const double m = std::bit_cast<double>(bits - (biased << 52) + bias);

    const double above = m - 1;  // exact
    const double sum = m + 1;
    const double sum_low = m - (sum - 1);  // what rounding took from the sum
    const double inverse = 1 / sum;
    const double t = above * inverse;
    const double t_low = std::fma(-t, sum_low, std::fma(-t, sum, above)) * inverse;

    // Σ t^(2i)·2/((2i + 1)·ln 2) from i = 1, even and odd i apart; |t| < 0.1716, the next term under 1e-18.
    constexpr double two_over_ln2 = 2.8853900817779268, two_over_ln2_low = 4.0710547481862066e-17;
    const double t2 = t * t;
    const double t4 = t2 * t2;
    double even = two_over_ln2 / 21;
    even = std::fma(even, t4, two_over_ln2 / 17);
    even = std::fma(even, t4, two_over_ln2 / 13);
    even = std::fma(even, t4, two_over_ln2 / 9);
    even = std::fma(even, t4, two_over_ln2 / 5);
    double odd = two_over_ln2 / 19;
    odd = std::fma(odd, t4, two_over_ln2 / 15);
    odd = std::fma(odd, t4, two_over_ln2 / 11);
    odd = std::fma(odd, t4, two_over_ln2 / 7);
    odd = std::fma(odd, t4, two_over_ln2 / 3);
    const double series = std::fma(even, t2, odd);

    const double first = t * two_over_ln2;
    const double first_low = std::fma(t, two_over_ln2, -first) + std::fma(t, two_over_ln2_low, t_low * two_over_ln2);
    const double high = k + first;
    const double left = (k - high) + first;  // exact: |k| ≥ 1 > |first|, or k = 0
    return {high, left + std::fma(t * t2, series, first_low)};
}

/// 2^(high + low) for |high + low| ≤ 1020, to 0.6 units of the last place or so. `low` is far smaller than `high`.
inline double precise_exp2(double high, double low) {
    constexpr double round_to_whole = 6755399441055744.0;  // 1.5·2^52: the sum's low bits are the nearest whole number
    const double shifted = high + round_to_whole;
    const double f = (high - (shifted - round_to_whole)) + low;  // in [−½, ½]
    const double f2 = f * f;
    double odd = 1.3691488853904128e-12;  // (ln 2)^i/i! to i = 13, even and odd i apart
    odd = std::fma(odd, f2, 4.4455382718708116e-10);
    odd = std::fma(odd, f2, 1.01780860092397e-07);
    odd = std::fma(odd, f2, 1.5252733804059841e-05);
    odd = std::fma(odd, f2, 0.0013333558146428443);
    odd = std::fma(odd, f2, 0.05550410866482158);
    odd = std::fma(odd, f2, 0.6931471805599453);
    double even = 2.5678435993488206e-11;
    even = std::fma(even, f2, 7.054911620801123e-09);
    even = std::fma(even, f2, 1.321548679014431e-06);
    even = std::fma(even, f2, 0.0001540353039338161);
    even = std::fma(even, f2, 0.009618129107628477);
    even = std::fma(even, f2, 0.24022650695910072);
    const double power = std::fma(std::fma(even, f, odd), f, 1.0);
    return std::bit_cast<double>(std::bit_cast<std::uint64_t>(power) + (std::bit_cast<std::uint64_t>(shifted) << 52));
}

/// base^exponent to 1.3 units of the last place for positive normal numbers; NaN where the result would leave 2^±1020.
/// A multiple faster than the C library's in a loop, and the same bytes on every machine.
inline double normal_power(double base, double exponent) {
    const LogarithmOfTwo log = precise_log2(base);
    const double high = exponent * log.high;
    const double low = std::fma(exponent, log.high, -high) + exponent * log.low;
    // Added and not selected: the compiler would make a branch around the exponential, and no loop of it.
    const double in_range = std::abs(high) < 1020 ? 0 : std::numeric_limits<double>::quiet_NaN();
    return precise_exp2(high, low) + in_range;
}

/// base^exponent for all numbers: what is out of the ordinary is left to the C library.
inline double power(double base, double exponent) {
    const bool normal = base >= std::numeric_limits<double>::min() && base <= std::numeric_limits<double>::max();
    const double result = normal ? normal_power(base, exponent) : std::numeric_limits<double>::quiet_NaN();
    return std::isnan(result) ? std::pow(base, exponent) : result;
}

}  // namespace thalweg
