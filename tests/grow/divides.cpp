// SPDX-License-Identifier: GPL-3.0-or-later
#include "thalweg/grow/divides.hpp"

#include <catch2/catch.hpp>
#include <cmath>
#include <numbers>

#include "thalweg/core/random.hpp"

using namespace thalweg;
using namespace thalweg::grow;
using std::numbers::pi;

namespace {

constexpr double degree = pi / 180;

/// Height at unit distance from the junction, in a direction, of the valley side that lies counter-clockwise (hand 1)
/// or clockwise (hand −1) of its link: its height along the link is the link's, and its steepest slope is the
/// sidewall's. Found by trying steepest directions, not by the formula in use.
double height_on_side(const ValleySide& side, double hand, double direction_rad) {
    const double along = side.junction == JunctionAt::lower_end ? side.gradient : -side.gradient;
    // slope·cos(steepest − link) = along, and the steepest direction points into the interfluve
    const double off_link = std::acos(along / side.sidewall_slope);
    return side.sidewall_slope * std::cos(direction_rad - (side.direction_rad + hand * off_link));
}

}  // namespace

TEST_CASE("Flint's gradient is p at sources and falls with magnitude") {
    const Flint flint{.p = 0.2, .q = -0.6};
    CHECK(gradient(flint, 1) == Approx(0.2).epsilon(1e-15));
    CHECK(gradient(flint, 2) == Approx(0.2 * std::pow(3, -0.6)).epsilon(1e-14));
    CHECK(gradient(flint, 50) / gradient(flint, 1) == Approx(std::pow(99, -0.6)).epsilon(1e-14));
}

TEST_CASE("Howard's angles are those worked out for slopes that fall with the root of discharge") {
    const auto slope = [](double discharge) { return std::pow(discharge, -0.5); };
    CHECK(2 * junction_angle(slope(2), slope(1)) == Approx(90 * degree));
    CHECK(junction_angle(slope(10), slope(1)) == Approx(71.565051 * degree));
    CHECK(junction_angle(slope(10), slope(9)) == Approx(18.434949 * degree));
    CHECK(junction_angle(0.3, 0.2) == 0);
}

TEST_CASE("Between two like inflows the divide bisects their angle") {
    const ValleySide right{30 * degree, JunctionAt::lower_end, 0.05, 0.4};
    const ValleySide left{110 * degree, JunctionAt::lower_end, 0.05, 0.4};
    CHECK(divide_direction(right, left) == Approx(70 * degree));
}

TEST_CASE("The divide moves towards the gentler valley side") {
    // A gentle side needs more ground to reach the height at which the steep one meets it, so the divide leaves it
    // more.
    const ValleySide steep{30 * degree, JunctionAt::lower_end, 0.05, 0.5};
    const ValleySide gentle{110 * degree, JunctionAt::lower_end, 0.05, 0.3};
    CHECK(divide_direction(steep, gentle) < 70 * degree);
}

TEST_CASE("Both valley sides are equally high on the divide, which lies between the links") {
    Random random(1, 1);
    int met = 0;
    for (int trial = 0; trial < 2000; ++trial) {
        const double start = 6 * random.uniform();
        const double sector = 0.3 + (pi - 0.3) * random.uniform();
        const auto end = [&] { return random.below(2) ? JunctionAt::lower_end : JunctionAt::upper_end; };
        const ValleySide first{start, end(), 0.2 * random.uniform(), 0.3 + random.uniform()};
        const ValleySide second{start + sector, end(), 0.2 * random.uniform(), 0.3 + random.uniform()};
        const double divide = divide_direction(first, second);
        REQUIRE(divide >= start + 0.0999 * sector);
        REQUIRE(divide <= start + 0.9001 * sector);
        const double share = (divide - start) / sector;
        const bool kept_away = share < 0.10001 || share > 0.89999;
        const bool bisects = std::abs(share - 0.5) < 1e-12;
        if (kept_away || bisects) continue;
        ++met;
        const double height = height_on_side(first, 1, divide);
        REQUIRE(height == Approx(height_on_side(second, -1, divide)).margin(1e-12));
    }
    CHECK(met > 1500);
}

TEST_CASE("Links steeper than their sidewalls still get a divide between them") {
    const ValleySide first{0, JunctionAt::lower_end, 3, 0.1};
    const ValleySide second{1, JunctionAt::lower_end, 0.01, 0.1};
    const double divide = divide_direction(first, second);
    CHECK(divide > 0);
    CHECK(divide < 1);
}
