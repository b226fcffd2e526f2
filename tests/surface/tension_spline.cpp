// SPDX-License-Identifier: GPL-3.0-or-later
#include "thalweg/surface/tension_spline.hpp"

#include <catch2/catch.hpp>
#include <cmath>
#include <functional>

using namespace thalweg::surface;

namespace {

struct Values {
    long double value, slope, own, cross;
};

/// The formulas with hyperbolic functions, as printed, with eleven more bits; good where they neither cancel nor
/// overflow.
Values printed(long double sigma, long double b) {
    const long double sh = sinhl(sigma);
    const long double ch = coshl(sigma);
    const long double e = sigma * sh - 2 * (ch - 1);
    const long double rest = sigma * (1 - b);
    return {((sh - sigma) * (coshl(rest) - 1) - (ch - 1) * (sinhl(rest) - rest)) / (sigma * e),
            (-(sh - sigma) * sinhl(rest) + (ch - 1) * (coshl(rest) - 1)) / e, sigma * (sigma * ch - sh) / e,
            sigma * (sh - sigma) / e};
}

/// For stiff curves: p + q b + r e^(−σb) + s e^(−σ(1−b)) solves F⁗ = σ²F″; the four conditions at the ends give p, q, r
/// and s, the bending moments there the energy.
Values by_conditions(long double sigma, long double b) {
    const long double w = expl(-sigma);
    const long double difference = -1 / (sigma * (1 + w) - 2 * (1 - w));  // r − s, from the sum of the slopes
    const long double total = -1 / (sigma * (1 - w));                     // r + s, from their difference
    const long double q = (1 - w) * difference;                           // from the heights
    const long double r = (total + difference) / 2;
    const long double s = (total - difference) / 2;
    const long double p = -r - s * w;
    const long double near = expl(-sigma * b);
    const long double far = expl(-sigma * (1 - b));
    return {p + q * b + r * near + s * far, q - sigma * r * near + sigma * s * far, -sigma * sigma * (r + s * w),
            sigma * sigma * (r * w + s)};
}

double simpson(double from, double to, int pieces, const std::function<double(double)>& f) {
    const double h = (to - from) / pieces;
    double sum = f(from) + f(to);
    for (int i = 1; i < pieces; ++i) sum += (i % 2 == 1 ? 4 : 2) * f(from + i * h);
    return sum * h / 3;
}

/// ∫ [F″² + α²(F′ − s)²] dt of a curve given by its slope, F″ by difference quotients.
double energy_by_quadrature(const TensionCurve& curve, const std::function<double(double)>& slope) {
    const double chord = (curve.end_height - curve.start_height) / curve.length;
    const double alpha = curve.tension / curve.length;
    const double step = 1e-5 * curve.length;
    return simpson(0, curve.length, 4000, [&](double t) {
        const double low = std::max(t - step, 0.0);
        const double high = std::min(t + step, curve.length);
        const double bend = t == 0 || t == curve.length
                                ? (t == 0 ? -3 * slope(0) + 4 * slope(step) - slope(2 * step)
                                          : 3 * slope(t) - 4 * slope(t - step) + slope(t - 2 * step)) /
                                      (2 * step)
                                : (slope(high) - slope(low)) / (high - low);
        const double stretch = alpha * (slope(t) - chord);
        return bend * bend + stretch * stretch;
    });
}

TensionCurve example(double tension) {
    return {
        .length = 3, .start_height = 7, .end_height = 5, .start_slope = 1.5, .end_slope = -0.25, .tension = tension};
}

void check_against(double tension, Values (*oracle)(long double, long double), double tolerance) {
    INFO(tension);
    for (int i = 0; i <= 64; ++i) {
        const Values expected = oracle(tension, i / 64.0L);
        const TensionShape shape = tension_shape(tension, i / 64.0);
        CHECK(std::abs(shape.value - double(expected.value)) < tolerance);
        CHECK(std::abs(shape.slope - double(expected.slope)) < tolerance);
    }
    const EdgeEnergy energy = tension_energy(tension);
    const Values expected = oracle(tension, 0);
    CHECK(std::abs(energy.own / double(expected.own) - 1) < tolerance);
    CHECK(std::abs(energy.cross / double(expected.cross) - 1) < tolerance);
}

}  // namespace

TEST_CASE("The energy coefficients have the values worked out by hand") {
    struct Value {
        double tension, own, cross;
    };
    for (const Value& v : {Value{0, 4, 2},
                           {0.5, 4.033225, 1.991731},
                           {1, 4.131623, 1.967670},
                           {2, 4.507563, 1.881493},
                           {5, 6.608451, 1.540614},
                           {10, 11.249745, 1.248837},
                           {20, 21.111111, 1.111111},
                           {50, 51.041667, 1.041667}}) {
        const EdgeEnergy energy = tension_energy(v.tension);
        CHECK(std::abs(energy.own - v.own) < 5.1e-7);
        CHECK(std::abs(energy.cross - v.cross) < 5.1e-7);
    }
}

TEST_CASE("Shapes and coefficients are those of the hyperbolic functions in more digits") {
    for (const double tension : {0.2, 0.5, 0.8}) check_against(tension, printed, 1e-15 / tension / tension);
    for (const double tension : {0.999, 1.0, 1.001, 1.5, 2.0, 3.7, 5.0}) check_against(tension, printed, 4e-15);
}

TEST_CASE("Stiff curves meet the conditions at their ends") {
    for (const double tension : {2.0, 5.0, 10.0, 30.0, 100.0, 699.0, 701.0, 5000.0}) {
        check_against(tension, by_conditions, 4e-15);
    }
}

TEST_CASE("A shape leaves with slope 1 and is otherwise flat and zero at its ends") {
    for (const double tension : {0.0, 1e-8, 0.4, 1.0, 7.0, 300.0, 1e6, 1e15}) {
        INFO(tension);
        CHECK(std::abs(tension_shape(tension, 0).value) < 1e-15);
        CHECK(std::abs(tension_shape(tension, 1).value) < 1e-15);
        CHECK(std::abs(tension_shape(tension, 0).slope - 1) < 4e-15);
        CHECK(std::abs(tension_shape(tension, 1).slope) < 4e-15);
    }
}

TEST_CASE("Without tension a curve is the cubic of Hermite") {
    for (const double tension : {0.0, 1e-9, 1e-6}) {
        for (int i = 0; i <= 20; ++i) {
            const double b = i / 20.0;
            CHECK(std::abs(tension_shape(tension, b).value - b * (1 - b) * (1 - b)) < 1e-13);
            CHECK(std::abs(tension_shape(tension, b).slope - (1 - b) * (1 - 3 * b)) < 1e-12);
            const double h00 = (1 + 2 * b) * (1 - b) * (1 - b);
            const double cubic =
                h00 * 7 + 3 * b * (1 - b) * (1 - b) * 1.5 + (1 - h00) * 5 - 3 * b * b * (1 - b) * -0.25;
            CHECK(point_on(example(tension), 3 * b).height == Approx(cubic).epsilon(1e-12));
        }
    }
}

TEST_CASE("With large tension a curve tends to its chord, and its energy to that of two bends") {
    for (const double tension : {1e2, 1e4, 1e8, 1e15}) {
        for (int i = 0; i <= 20; ++i) {
            const double t = 3 * i / 20.0;
            CHECK(std::abs(point_on(example(tension), t).height - (7 - 2 * t / 3)) < 3 * 2.2 / tension + 1e-14);
        }
        CHECK(tension_energy(tension).own / tension == Approx(1).epsilon(2 / tension));
        CHECK(tension_energy(tension).cross == Approx(1).epsilon(4 / tension));
    }
}

TEST_CASE("The slope is the derivative of the height") {
    for (const double tension : {0.0, 0.7, 1.3, 12.0, 90.0}) {
        for (double t = 0.1; t < 2.9; t += 0.17) {
            const double h = 1e-5;
            const double rise = point_on(example(tension), t + h).height - point_on(example(tension), t - h).height;
            CHECK(std::abs(point_on(example(tension), t).slope - rise / (2 * h)) < 2e-7);
        }
    }
}

TEST_CASE("The energy is the integral of bending and stretching") {
    for (const double tension : {0.0, 0.3, 0.99, 1.01, 2.0, 5.0, 20.0, 50.0}) {
        const TensionCurve curve = example(tension);
        const double expected = energy_by_quadrature(curve, [&](double t) { return point_on(curve, t).slope; });
        CHECK(energy(curve) == Approx(expected).epsilon(1e-6));
    }
}

TEST_CASE("Every other curve between the same ends takes more energy") {
    for (const double tension : {0.0, 0.5, 3.0, 15.0}) {
        const TensionCurve curve = example(tension);
        const double least = energy_by_quadrature(curve, [&](double t) { return point_on(curve, t).slope; });
        for (const double amplitude : {-0.1, 0.1}) {
            for (int waves = 1; waves < 4; ++waves) {  // sin² (π waves t/L): ends and end slopes stay
                const double k = 3.14159265358979 * waves / curve.length;
                const auto slope = [&](double t) {
                    return point_on(curve, t).slope + amplitude * k * std::sin(2 * k * t);
                };
                CHECK(energy_by_quadrature(curve, slope) > least * 1.0001);
            }
        }
    }
}

TEST_CASE("Where series and exponentials meet nothing is to be seen") {
    const double below = std::nextafter(1.0, 0.0);
    for (int i = 0; i <= 50; ++i) {
        const double b = i / 50.0;
        CHECK(std::abs(tension_shape(below, b).value - tension_shape(1, b).value) < 3e-15);
        CHECK(std::abs(tension_shape(below, b).slope - tension_shape(1, b).slope) < 3e-15);
    }
    CHECK(tension_energy(below).own == Approx(tension_energy(1).own).epsilon(4e-15));
    CHECK(tension_energy(below).cross == Approx(tension_energy(1).cross).epsilon(4e-15));
}
