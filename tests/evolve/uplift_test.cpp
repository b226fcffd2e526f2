// SPDX-License-Identifier: GPL-3.0-or-later
#include <catch2/catch.hpp>

#include "thalweg/evolve/uplift.hpp"

using namespace thalweg;
using evolve::Pattern;
using evolve::pattern_values;

TEST_CASE("The constant pattern is its maximum everywhere") {
    const std::vector<Point> points{{0, 0}, {5, 1}, {-3, 2}};
    CHECK(pattern_values(Pattern::constant, points, 4e-4) == std::vector<double>(3, 4e-4));
    CHECK(pattern_values(Pattern::constant, {}, 1).empty());
    CHECK(pattern_values(Pattern::radial, {}, 1).empty());
}

TEST_CASE("The radial pattern falls from the middle of the box to nothing at half its shorter side") {
    const std::vector<Point> points{{10, 0}, {10, 8}, {30, 8}, {30, 0}, {20, 4}, {22, 4}, {20, 3}, {24, 4}, {29, 4}};
    const auto values = pattern_values(Pattern::radial, points, 2);
    CHECK(values[0] == 0);
    CHECK(values[4] == 2);    // the middle
    CHECK(values[5] == 1);    // 2 m of 4 m away
    CHECK(values[6] == 1.5);  // 1 m of 4 m away
    CHECK(values[7] == 0);    // at the radius
    CHECK(values[8] == 0);    // beyond: nothing, never negative
}
