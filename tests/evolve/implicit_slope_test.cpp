// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>

#include "thalweg/core/random.hpp"
#include "thalweg/evolve/slope.hpp"

namespace {

using thalweg::evolve::SlopeSolver;

constexpr double exponents[] = {0.3, 0.5, 0.7, 0.8, 1, 1.3, 1.5, 2, 3, 4, 5};

/// The slope by bisection on its logarithm in long doubles, whose range holds every power that occurs.
long double slope_by_bisection(long double drop, long double length, long double c, long double n) {
    long double low = -11000;  // natural logarithms
    long double high = std::log(drop / length);
    for (int i = 0; i < 120; ++i) {
        const long double middle = (low + high) / 2;
        const long double sum = length * std::exp(middle) + c * std::exp(n * middle);
        (sum > drop ? high : low) = middle;
    }
    // The logarithm of a small number has few digits after the point: two Newton steps on the slope itself.
    long double slope = std::exp((low + high) / 2);
    for (int i = 0; i < 2; ++i) {
        const long double incision = c * std::pow(slope, n);
        slope -= slope * (length * slope + incision - drop) / (length * slope + n * incision);
    }
    return slope;
}

/// Error in units of the last place, per unit of 1/min(n, 1), by which the equation itself magnifies rounding.
double error_in_ulps(double slope, double drop, double length, double c, double n) {
    const auto exact = slope_by_bisection(drop, length, c, n);
    if (exact < 1e-300L) return slope <= 1.1e-300 ? 0 : 1e9;
    return static_cast<double>(std::abs((slope - exact) / exact) / 2.2e-16L * std::min(n, 1.0));
}

double power_of_ten(thalweg::Random& random, double low, double high) {
    return std::pow(10.0, low + (high - low) * random.uniform());
}

}  // namespace

TEST_CASE("The end-of-step slope agrees with bisection to the last bits for every n in the range of landscapes") {
    thalweg::Random random(1, 1);
    for (const double n : exponents) {
        const SlopeSolver solve(n);
        double worst = 0;
        int most_iterations = 0;
        for (int i = 0; i < 4000; ++i) {
            const double drop = power_of_ten(random, -6, 5);
            const double length = power_of_ten(random, -1, 4);
            const double c = power_of_ten(random, -8, 12);
            const auto solution = solve(drop, length, c);
            worst = std::max(worst, error_in_ulps(solution.slope, drop, length, c, n));
            most_iterations = std::max(most_iterations, solution.iterations);
        }
        CAPTURE(n, most_iterations);
        CHECK(worst < 4);
        CHECK(most_iterations <= 2);
    }
}

TEST_CASE("The end-of-step slope is found for drops from 1e-300 to 1e5 and any amount of water") {
    thalweg::Random random(2, 1);
    for (const double n : exponents) {
        const SlopeSolver solve(n);
        double worst = 0;
        int most_iterations = 0;
        for (int i = 0; i < 4000; ++i) {
            const double drop = power_of_ten(random, -300, 5);
            const double length = power_of_ten(random, -3, 6);
            const double c = power_of_ten(random, -300, 300);
            const auto solution = solve(drop, length, c);
            worst = std::max(worst, error_in_ulps(solution.slope, drop, length, c, n));
            most_iterations = std::max(most_iterations, solution.iterations);
        }
        CAPTURE(n, most_iterations);
        CHECK(worst < 8);
        CHECK(most_iterations <= 60);
    }
}

TEST_CASE("Without water the slope is the drop over the length") {
    for (const double n : exponents) CHECK(SlopeSolver(n)(10, 4, 0).slope == 2.5);
}

TEST_CASE("Without a drop there is no slope") {
    constexpr double drop[] = {0, -1}, length[] = {4, 4}, c[] = {1, 1};
    for (const double n : exponents) {
        if (n == 1) continue;  // with n = 1 there is nothing to solve in lanes
        double slope[] = {9, 9}, incision[] = {9, 9};
        SlopeSolver(n).solve<2>(drop, length, c, slope, incision);
        for (const int lane : {0, 1}) {
            CHECK(slope[lane] == 0);
            CHECK(incision[lane] == 0);
        }
    }
}

TEST_CASE("Slopes that can be found by hand are exact") {
    CHECK(SlopeSolver(1)(6, 1, 2).slope == 2);                            // 2 + 2·2 = 6
    CHECK(SlopeSolver(2)(10, 1, 2).slope == Approx(2).epsilon(1e-15));    // 2 + 2·4 = 10
    CHECK(SlopeSolver(0.5)(10, 2, 1).slope == Approx(4).epsilon(1e-15));  // 2·4 + 2 = 10
    CHECK(SlopeSolver(3)(18, 1, 2).slope == Approx(2).epsilon(1e-15));    // 2 + 2·8 = 18
}

TEST_CASE("The incision that is reported is the law at the slope that is reported") {
    thalweg::Random random(3, 1);
    for (const double n : exponents) {
        const SlopeSolver solve(n);
        double worst = 0;
        for (int i = 0; i < 2000; ++i) {
            const double drop = power_of_ten(random, -6, 5);
            const double length = power_of_ten(random, -1, 4);
            const double c = power_of_ten(random, -8, 12);
            const auto solution = solve(drop, length, c);
            worst = std::max(worst, std::abs(solution.incision_m / (c * std::pow(solution.slope, n)) - 1));
        }
        CHECK(worst < 1e-14);
    }
}
