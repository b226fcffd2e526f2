// SPDX-License-Identifier: GPL-3.0-or-later
#include "thalweg/core/power.hpp"

#include <algorithm>
#include <catch2/catch.hpp>
#include <vector>

#include "thalweg/core/random.hpp"

using namespace thalweg;

namespace {

/// Error in units of the last place, against the C library's power in long doubles.
double error_in_ulps(double computed, double base, double exponent) {
    const long double exact = std::pow(static_cast<long double>(base), static_cast<long double>(exponent));
    const int binary_exponent = std::ilogb(exact);
    return static_cast<double>(std::abs(computed - exact) / std::ldexp(1.0L, binary_exponent - 52));
}

}  // namespace

TEST_CASE("A power is right to 1.3 units of the last place, over the range of landscapes and of doubles") {
    Random random(1, 1);
    double worst = 0;
    for (int i = 0; i < 400000; ++i) {
        const double exponent = -2 + 8 * random.uniform();
        const double largest = std::min(1000.0, 1000 / std::abs(exponent));
        const double spread = i % 2 == 0 ? largest : 0.05 * largest;
        const double base = std::exp2(spread * (2 * random.uniform() - 1));
        worst = std::max(worst, error_in_ulps(normal_power(base, exponent), base, exponent));
    }
    CHECK(worst < 1.3);
}

TEST_CASE("A power whose logarithm is near 0 keeps its last digits") {
    Random random(2, 1);
    double worst = 0;
    for (int i = 0; i < 100000; ++i) {
        const double base = 1 + 1e-3 * (2 * random.uniform() - 1);
        worst = std::max(worst, error_in_ulps(normal_power(base, 0.37), base, 0.37));
    }
    CHECK(worst < 1.3);
    CHECK(normal_power(1, 5) == 1);
    CHECK(normal_power(4, 0.5) == 2);
    CHECK(normal_power(7, 0) == 1);
}

TEST_CASE("Eight powers in a loop are the same bits as one by one") {
    Random random(3, 1);
    std::vector<double> base(800), together(800);
    for (double& x : base) x = std::exp2(200 * (2 * random.uniform() - 1));
    for (std::size_t i = 0; i < base.size(); ++i) together[i] = normal_power(base[i], 1.3);
    for (std::size_t i = 0; i < base.size(); ++i) {
        volatile double alone = base[i];
        CHECK(normal_power(alone, 1.3) == together[i]);
    }
}

TEST_CASE("What leaves the range of doubles is NaN in the quick power and the C library's in the other") {
    CHECK(std::isnan(normal_power(1e300, 2)));
    CHECK(std::isnan(normal_power(1e-300, 2)));
    CHECK(power(1e300, 2) == std::pow(1e300, 2));
    CHECK(power(1e-170, 2) == 0);
    CHECK(power(0, 0.5) == 0);
    CHECK(power(0, 0) == 1);
    CHECK(power(5e-324, 0.5) == std::pow(5e-324, 0.5));
    CHECK(std::isnan(power(std::numeric_limits<double>::quiet_NaN(), 2)));
}
