// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "surface/numbers.hpp"

namespace thalweg::surface {

// The basis of the curves under tension (equations in surface/tension_spline.hpp) as templates over numbers.hpp.

/// Below this tension the differences of exponentials lose digits, and the series converge in eight terms.
inline constexpr double series_below = 1;

/// (cosh x − 1)/x² as a function of x² ≤ 1/4.
template <class Number>
inline Number cosh_rest(Number x2) {
    return 1.0 / 2 +
           x2 * (1.0 / 24 +
                 x2 * (1.0 / 720 +
                       x2 * (1.0 / 40320 +
                             x2 * (1.0 / 3628800 + x2 * (1.0 / 479001600 + x2 * (1.0 / 87178291200.0 +
                                                                                 x2 * (1.0 / 20922789888000.0)))))));
}

/// (sinh x − x)/x³ as a function of x² ≤ 1/4.
template <class Number>
inline Number sinh_rest(Number x2) {
    return 1.0 / 6 +
           x2 * (1.0 / 120 +
                 x2 * (1.0 / 5040 + x2 * (1.0 / 362880 + x2 * (1.0 / 39916800 + x2 * (1.0 / 6227020800.0 +
                                                                                      x2 * (1.0 / 1307674368000.0))))));
}

/// φ(b) + φ(1 − b) and φ(b) − φ(1 − b), with their derivatives by b.
template <class Number>
struct Shape {
    Number even, even_slope;
    Number odd, odd_slope;

    /// p φ(b) + q φ(1 − b)
    Number value(Number p, Number q) const { return 0.5 * ((p + q) * even + (p - q) * odd); }
    Number slope(Number p, Number q) const { return 0.5 * ((p + q) * even_slope + (p - q) * odd_slope); }
};

template <class Number>
inline Shape<Number> shape_by_series(Number tension, Number b) {
    const Number u = b + b - 1.0;
    const Number h2 = 0.25 * tension * tension;
    const Number u2 = u * u;
    const Number x2 = h2 * u2;
    const Number cosh_h = cosh_rest(h2);
    const Number sinh_h = sinh_rest(h2);
    const Number cosh_x = cosh_rest(x2);
    const Number sinh_x = sinh_rest(x2);
    const Number even_scale = 1.0 / (1.0 + h2 * sinh_h);
    const Number odd_scale = 1.0 / (cosh_h - sinh_h);
    return {.even = 0.5 * (cosh_h - u2 * cosh_x) * even_scale,
            .even_slope = -u * (1.0 + x2 * sinh_x) * even_scale,
            .odd = 0.5 * u * (u2 * sinh_x - sinh_h) * odd_scale,
            .odd_slope = (u2 * cosh_x - sinh_h) * odd_scale};
}

template <class Number>
inline Shape<Number> shape_by_exponentials(Number tension, Number b) {
    const Number near = exp_minus(tension * b);
    const Number far = exp_minus(tension * (1.0 - b));
    const Number whole = near * far;  // e^(−σ)
    const Number rest = 1.0 - whole;
    const Number even_scale = 1.0 / rest;
    const Number odd_scale = 1.0 / (tension * (1.0 + whole) - 2.0 * rest);
    return {.even = (1.0 - near) * (1.0 - far) * even_scale / tension,
            .even_slope = (near - far) * even_scale,
            .odd = ((far - near) - (b + b - 1.0) * rest) * odd_scale,
            .odd_slope = (tension * (near + far) - 2.0 * rest) * odd_scale};
}

template <class Number>
inline Shape<Number> shape_of(Number tension, Number b) {
    const auto small = less(tension, series_below);
    if (all(small)) return shape_by_series(tension, b);
    if (!any(small)) return shape_by_exponentials(tension, b);
    const Shape<Number> series = shape_by_series(tension, b);  // in lanes above the threshold not accurate, but finite
    const Shape<Number> exact = shape_by_exponentials(select(small, number<Number>(series_below), tension), b);
    return {.even = select(small, series.even, exact.even),
            .even_slope = select(small, series.even_slope, exact.even_slope),
            .odd = select(small, series.odd, exact.odd),
            .odd_slope = select(small, series.odd_slope, exact.odd_slope)};
}

}  // namespace thalweg::surface
