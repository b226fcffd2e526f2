// SPDX-License-Identifier: GPL-3.0-or-later
#include "thalweg/grow/basin.hpp"

#include <catch2/catch.hpp>
#include <limits>

#include "support/basins.hpp"
#include "thalweg/core/error.hpp"

using namespace thalweg;
using namespace thalweg::grow;
using support::square_basin;

TEST_CASE("A clockwise outline is turned round and an outlet nearly on it is put onto it") {
    Basin basin = square_basin(1000);
    std::reverse(basin.outline.begin(), basin.outline.end());
    basin.outlet = {300, 1e-4};
    const Basin checked = checked_basin(basin);
    CHECK(mesh::polygon_area(checked.outline) == Approx(1e6));
    CHECK(checked.outlet == Point{300, 0});
    basin.outlet = {1e-4, 1e-4};
    CHECK(checked_basin(basin).outlet == Point{0, 0});
}

TEST_CASE("A trunk may start in a corner, also one that points inwards") {
    Basin basin{.outline = support::l_shape(), .outlet = {1, 1}, .source = {0.2, 0.3}};
    CHECK_NOTHROW(checked_basin(basin));
    basin.outlet = {2, 0};
    CHECK_NOTHROW(checked_basin(basin));
}

TEST_CASE("A basin that cannot be is refused with what is wrong") {
    const double nan = std::numeric_limits<double>::quiet_NaN();
    Basin basin = square_basin(1000);
    SECTION("outlet off the outline") {
        basin.outlet = {500, 10};
        CHECK_THROWS_WITH(checked_basin(basin), Catch::Contains("10 m off the basin's outline"));
    }
    SECTION("source outside") {
        basin.source = {500, 1200};
        CHECK_THROWS_WITH(checked_basin(basin), Catch::Contains("not inside"));
    }
    SECTION("trunk drawn downstream") {
        std::swap(basin.outlet, basin.source);
        basin.outlet = {500, 1000};
        CHECK_THROWS_WITH(checked_basin(basin), Catch::Contains("turn it round"));
    }
    SECTION("source on the outline") {
        basin.source = {500, 1000};
        CHECK_THROWS_AS(checked_basin(basin), Error);
    }
    SECTION("trunk through the outside") {
        basin.outline = support::l_shape();
        basin.outlet = {2, 0.9};
        basin.source = {0.9, 1.9};
        CHECK_THROWS_WITH(checked_basin(basin), Catch::Contains("leaves the basin"));
    }
    SECTION("trunk over a corner that points inwards") {
        basin.outline = support::l_shape();
        basin.outlet = {1.5, 0};
        basin.source = {0.75, 1.5};
        CHECK_THROWS_WITH(checked_basin(basin), Catch::Contains("leaves the basin"));
    }
    SECTION("trunk along a side") {
        basin.outlet = {0, 0};
        basin.source = {500, 0};
        CHECK_THROWS_AS(checked_basin(basin), Error);
    }
    SECTION("outline that crosses itself") {
        std::swap(basin.outline[0], basin.outline[1]);
        CHECK_THROWS_AS(checked_basin(basin), Error);
    }
    SECTION("no number") {
        basin.source.x = nan;
        CHECK_THROWS_WITH(checked_basin(basin), Catch::Contains("finite"));
        basin = square_basin(1000);
        basin.base_level_m = nan;
        CHECK_THROWS_WITH(checked_basin(basin), Catch::Contains("base level"));
    }
}
