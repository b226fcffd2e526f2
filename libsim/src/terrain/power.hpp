// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <bit>
#include <cstdint>
#include <span>

namespace thalweg::terrain {

/// log2 of a positive normal number to 4e-16 + 2e-16·|log2|: no branch and no table, so that a loop over it vectorises.
inline double plain_log2(double x) {
    constexpr std::int64_t root_of_half = 0x3fe6a09e667f3bcd;
    constexpr std::int64_t exponent_of_two_to_52 = 0x4330000000000000;
    const auto bits = std::bit_cast<std::int64_t>(x);
    const std::int64_t biased =
        static_cast<std::int64_t>(static_cast<std::uint64_t>(bits - root_of_half + (std::int64_t{1024} << 52)) >> 52);
    const std::int64_t exponent = biased - 1024;
    const double mantissa = std::bit_cast<double>(
        bits - static_cast<std::int64_t>(static_cast<std::uint64_t>(exponent) << 52));  // in [√½, √2)
    const double whole = std::bit_cast<double>(biased | exponent_of_two_to_52) - (4503599627370496.0 + 1024);
    const double t = (mantissa - 1) / (mantissa + 1);
    const double t2 = t * t;
    // 2/ln 2 · Σ t^(2i)/(2i + 1), |t| < 0.1716: the next term is under 1e-17.
    double sum = 2.8853900817779268 / 21;
    sum = sum * t2 + 2.8853900817779268 / 19;
    sum = sum * t2 + 2.8853900817779268 / 17;
    sum = sum * t2 + 2.8853900817779268 / 15;
    sum = sum * t2 + 2.8853900817779268 / 13;
    sum = sum * t2 + 2.8853900817779268 / 11;
    sum = sum * t2 + 2.8853900817779268 / 9;
    sum = sum * t2 + 2.8853900817779268 / 7;
    sum = sum * t2 + 2.8853900817779268 / 5;
    sum = sum * t2 + 2.8853900817779268 / 3;
    sum = sum * t2 + 2.8853900817779268;
    return whole + t * sum;
}

/// 2^y for y ≤ 0 to 4e-16; what lies under 2^-1000 is 2^-1000.
inline double plain_exp2(double y) {
    constexpr double round_to_whole = 6755399441055744.0;  // 1.5·2^52: the sum's low bits are the nearest whole number
    const double z = y > -1000 ? y : -1000;
    const double shifted = z + round_to_whole;
    const double f = (z - (shifted - round_to_whole)) * 0.6931471805599453;
    double sum = 1.0 / 6227020800;
    sum = sum * f + 1.0 / 479001600;
    sum = sum * f + 1.0 / 39916800;
    sum = sum * f + 1.0 / 3628800;
    sum = sum * f + 1.0 / 362880;
    sum = sum * f + 1.0 / 40320;
    sum = sum * f + 1.0 / 5040;
    sum = sum * f + 1.0 / 720;
    sum = sum * f + 1.0 / 120;
    sum = sum * f + 1.0 / 24;
    sum = sum * f + 1.0 / 6;
    sum = sum * f + 0.5;
    sum = sum * f + 1;
    sum = sum * f + 1;
    return std::bit_cast<double>(std::bit_cast<std::uint64_t>(sum) + (std::bit_cast<std::uint64_t>(shifted) << 52));
}

/// Raises ratios in (0, 1] to a positive power; what would fall under 2^-1000 becomes 2^-1000, so none becomes 0.
inline void raise_ratios(std::span<double> ratios, double exponent) {
    if (exponent == 1) return;
    for (double& ratio : ratios) ratio = plain_exp2(exponent * plain_log2(ratio));
}

}  // namespace thalweg::terrain
