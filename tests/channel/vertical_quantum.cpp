// SPDX-License-Identifier: GPL-3.0-or-later
#include <catch2/catch.hpp>
#include <cmath>
#include <limits>
#include <vector>

#include "thalweg/channel/slope_area.hpp"
#include "thalweg/core/random.hpp"

using namespace thalweg;
using channel::vertical_quantum;

namespace {

/// Heights of 0 … 800 m above `base`, in steps of `quantum` (0: as drawn).
std::vector<double> heights(std::size_t count, double quantum, double base = 0) {
    Random random(17, 0);
    std::vector<double> height;
    for (std::size_t i = 0; i < count; ++i) {
        const double drawn = 800 * std::pow(random.uniform(), 2);
        height.push_back(base + (quantum > 0 ? quantum * std::round(drawn / quantum) : drawn));
    }
    return height;
}

std::vector<double> single_precision(std::vector<double> height) {
    for (double& each : height) each = static_cast<float>(each);
    return height;
}

}  // namespace

TEST_CASE("Whole metres, feet, decimetres and odd steps are recognised") {
    for (const double quantum : {1.0, 2.0, 5.0, 10.0, 0.5, 0.3048, 0.1, 0.05, 0.01, 1200.0 / 3937.0}) {
        for (const std::size_t count : {500u, 20000u, 200000u}) {
            CAPTURE(quantum, count);
            CHECK(vertical_quantum(heights(count, quantum)) == Approx(quantum).epsilon(1e-4));
            CHECK(vertical_quantum(heights(count, quantum, -431.7)) == Approx(quantum).epsilon(1e-4));
        }
    }
}

TEST_CASE("Rounding to single precision does not hide the quantum") {
    for (const double quantum : {1.0, 0.3048, 0.1, 0.01}) {
        CAPTURE(quantum);
        CHECK(vertical_quantum(single_precision(heights(50000, quantum))) == Approx(quantum).epsilon(1e-4));
        CHECK(vertical_quantum(single_precision(heights(50000, quantum, 1500 * quantum))) ==
              Approx(quantum).epsilon(1e-4));
    }
}

TEST_CASE("Real numbers have no quantum, in double or single precision, few or many") {
    for (const std::size_t count : {30u, 1000u, 300000u}) {
        CAPTURE(count);
        CHECK(vertical_quantum(heights(count, 0)) == 0);
        CHECK(vertical_quantum(single_precision(heights(count, 0))) == 0);
        CHECK(vertical_quantum(single_precision(heights(count, 0, 3000))) == 0);
    }
}

TEST_CASE("A real-valued lake level does not make a DEM quantised") {
    auto height = heights(20000, 0);
    for (std::size_t i = 0; i < height.size(); i += 3) height[i] = i % 2 ? 211.37 : 96.04;
    CHECK(vertical_quantum(height) == 0);
}

TEST_CASE("A small patch of other origin does not hide whole metres, a large one does") {
    auto height = heights(40000, 1);
    Random random(3, 0);
    for (std::size_t i = 0; i < height.size(); i += 200) height[i] += random.uniform();
    CHECK(vertical_quantum(height) == Approx(1));
    for (std::size_t i = 0; i < height.size(); i += 2) height[i] += random.uniform();
    CHECK(vertical_quantum(height) == 0);
}

TEST_CASE("Gaps of two and three metres only still mean whole metres") {
    CHECK(vertical_quantum(std::vector<double>{100, 102, 105, 107, 110, 110, 105}) == Approx(1));
    CHECK(vertical_quantum(std::vector<double>{0, 6, 10, 15}) == Approx(1));
}

TEST_CASE("No data is skipped, and no difference in height has no quantum") {
    const double nan = std::numeric_limits<double>::quiet_NaN();
    CHECK(vertical_quantum(std::vector<double>{nan, 3, 4, nan, 7, 4}) == Approx(1));
    CHECK(vertical_quantum(std::vector<double>{5, 5, 5}) == 0);
    CHECK(vertical_quantum(std::vector<double>{nan, nan}) == 0);
    CHECK(vertical_quantum({}) == 0);
}

TEST_CASE("A quantum finer than asked for counts as none") {
    CHECK(vertical_quantum(heights(5000, 0.01), 0.05) == 0);
    CHECK(vertical_quantum(heights(5000, 0.1), 0.05) == Approx(0.1));
}
