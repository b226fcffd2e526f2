// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <bit>
#include <cstdint>

namespace thalweg::surface {

// What a surface is computed with: one number, four numbers side by side, or a number with its derivatives. Formulas
// are templates over them. Lanes do exactly what four single numbers would, so that batches and single points agree to
// the last bit.

/// Four doubles in one register.
using Lanes = double __attribute__((vector_size(32)));
using LaneMask = std::int64_t __attribute__((vector_size(32)));
inline constexpr int lane_count = 4;

/// A number with its derivatives by two variables.
struct Dual {
    double value = 0;
    double by_u = 0;
    double by_v = 0;
};

inline Dual operator-(const Dual& a) { return {-a.value, -a.by_u, -a.by_v}; }
inline Dual operator+(const Dual& a, const Dual& b) { return {a.value + b.value, a.by_u + b.by_u, a.by_v + b.by_v}; }
inline Dual operator-(const Dual& a, const Dual& b) { return {a.value - b.value, a.by_u - b.by_u, a.by_v - b.by_v}; }
inline Dual operator*(const Dual& a, const Dual& b) {
    return {a.value * b.value, a.by_u * b.value + a.value * b.by_u, a.by_v * b.value + a.value * b.by_v};
}
inline Dual operator/(const Dual& a, const Dual& b) {
    const double ratio = a.value / b.value;
    return {ratio, (a.by_u - ratio * b.by_u) / b.value, (a.by_v - ratio * b.by_v) / b.value};
}
inline Dual operator+(double a, const Dual& b) { return {a + b.value, b.by_u, b.by_v}; }
inline Dual operator+(const Dual& a, double b) { return b + a; }
inline Dual operator-(double a, const Dual& b) { return {a - b.value, -b.by_u, -b.by_v}; }
inline Dual operator-(const Dual& a, double b) { return {a.value - b, a.by_u, a.by_v}; }
inline Dual operator*(double a, const Dual& b) { return {a * b.value, a * b.by_u, a * b.by_v}; }
inline Dual operator*(const Dual& a, double b) { return b * a; }
inline Dual operator/(double a, const Dual& b) { return Dual{a, 0, 0} / b; }

template <class Number>
Number number(double value);
template <>
inline double number<double>(double value) {
    return value;
}
template <>
inline Lanes number<Lanes>(double value) {
    return Lanes{value, value, value, value};
}
template <>
inline Dual number<Dual>(double value) {
    return {value, 0, 0};
}

inline bool less(double a, double b) { return a < b; }
inline LaneMask less(Lanes a, double b) { return a < b; }
inline bool less(const Dual& a, double b) { return a.value < b; }

inline bool equal(double a, double b) { return a == b; }
inline LaneMask equal(Lanes a, double b) { return a == b; }
inline bool equal(const Dual& a, double b) { return a.value == b; }

inline double select(bool condition, double yes, double no) { return condition ? yes : no; }
inline Lanes select(LaneMask condition, Lanes yes, Lanes no) { return condition ? yes : no; }
inline Dual select(bool condition, const Dual& yes, const Dual& no) { return condition ? yes : no; }

inline bool any(bool condition) { return condition; }
inline bool any(LaneMask c) { return (c[0] | c[1] | c[2] | c[3]) != 0; }
inline bool all(bool condition) { return condition; }
inline bool all(LaneMask c) { return (c[0] & c[1] & c[2] & c[3]) != 0; }

/// 2^k for the whole number k that stands in the lowest bits of shifted = k + 1.5·2⁵².
inline double power_of_two(double shifted) {
    return std::bit_cast<double>((std::bit_cast<std::uint64_t>(shifted) + 1023) << 52);
}
inline Lanes power_of_two(Lanes shifted) {
    using Bits = std::uint64_t __attribute__((vector_size(32)));
    return std::bit_cast<Lanes>((std::bit_cast<Bits>(shifted) + 1023) << 52);
}

/// e^(−x) for x ≥ 0, within 1.5 units of the last place; beyond 700, where it no longer matters, e^(−700). Our own, for
/// the C library's has no lanes and differs in its last bit from processor to processor.
template <class Number>
inline Number exp_minus(Number x) {
    constexpr double shift = 0x1.8p52;  // adding it rounds to a whole number
    constexpr double log2_e = 0x1.71547652b82fep+0;
    constexpr double ln2_high = 0x1.62e42fefap-1;  // few enough bits that k times it is exact
    constexpr double ln2_low = 0x1.cf79abc9e3b3ap-40;
    const Number kept = select(less(x, 700.0), x, number<Number>(700.0));
    const Number shifted = kept * -log2_e + shift;
    const Number k = shifted - shift;
    const Number r = -kept - k * ln2_high - k * ln2_low;
    const Number r2 = r * r;
    const Number even =
        1 +
        r2 * (1.0 / 2 +
              r2 * (1.0 / 24 + r2 * (1.0 / 720 + r2 * (1.0 / 40320 + r2 * (1.0 / 3628800 + r2 * (1.0 / 479001600))))));
    const Number odd =
        1 + r2 * (1.0 / 6 +
                  r2 * (1.0 / 120 +
                        r2 * (1.0 / 5040 + r2 * (1.0 / 362880 + r2 * (1.0 / 39916800 + r2 * (1.0 / 6227020800.0))))));
    return (even + r * odd) * power_of_two(shifted);
}
template <>
inline Dual exp_minus(Dual x) {
    const double value = exp_minus(x.value);
    return {value, -value * x.by_u, -value * x.by_v};
}

}  // namespace thalweg::surface
