// SPDX-License-Identifier: GPL-3.0-or-later
#include "thalweg/render/colors.hpp"

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <limits>

using namespace thalweg;
using namespace thalweg::render;

namespace {

const double no_data = std::numeric_limits<double>::quiet_NaN();

/// Cells in a row: their heights, gradients and water; places a kilometre apart.
std::vector<Rgb> natural(const std::vector<double>& heights, const std::vector<double>& gradient,
                         const std::vector<double>& water = {}, std::optional<double> snow_line = {}) {
    std::vector<Point> places;
    for (std::size_t i = 0; i < heights.size(); ++i) places.push_back({1000.0 * static_cast<double>(i), 0});
    return natural_colors({.places = places,
                           .heights = heights,
                           .gradient = gradient,
                           .water = water,
                           .tree_line_m = {},
                           .snow_line_m = snow_line});
}

bool is_green(const Rgb& c) { return c.g > c.r && c.g > c.b; }
bool is_blue(const Rgb& c) { return c.b > c.r && c.b > c.g; }
bool is_white(const Rgb& c) { return std::min({c.r, c.g, c.b}) > 0.8f; }
bool is_grey(const Rgb& c) { return std::max({c.r, c.g, c.b}) < 1.5f * std::min({c.r, c.g, c.b}); }

}  // namespace

TEST_CASE("Gradients of a plane are exact, at the edge and beside no data too") {
    const Grid grid = plane_grid(5, 6, 30, 20);
    std::vector<double> heights;
    for (Index i = 0; i < grid.size(); ++i) heights.push_back(0.3 * 30 * grid.col(i) + 0.4 * 20 * grid.row(i));
    heights[14] = no_data;
    const auto gradient = gradients(grid, heights);
    for (Index i = 0; i < grid.size(); ++i) {
        if (i == 14) {
            CHECK(std::isnan(gradient[i]));
        } else {
            CHECK(gradient[i] == Approx(0.5));
        }
    }
}

TEST_CASE("Colours go with elevation and gradient: plants below, rock on steep faces, snow above, water in channels") {
    const auto c =
        natural({100, 200, 300, 3900, 4000, 4000, 100}, {0.1, 0.35, 1.5, 0.2, 0.2, 2.5, 0.01}, {0, 0, 0, 0, 0, 0, 1});
    CHECK_FALSE(is_grey(c[0]));  // meadow, dry or green by the mottle
    CHECK_FALSE(is_white(c[0]));
    CHECK(is_green(c[1]));
    CHECK(is_grey(c[2]));
    CHECK(is_white(c[3]));
    CHECK(is_white(c[4]));
    CHECK(is_grey(c[5]));
    CHECK_FALSE(is_white(c[5]));
    CHECK(is_blue(c[6]));
}

TEST_CASE("Hills have no snow unless its line is named, however much higher than their valleys they are") {
    const std::vector<double> gradient{0.1, 0.1, 0.1};
    for (const double top : {100.0, 1070.0, 2700.0}) {
        const std::vector<double> heights{0, top / 2, top};
        CHECK_FALSE(is_white(natural(heights, gradient)[2]));
        CHECK(is_white(natural(heights, gradient, {}, 0.8 * top)[2]));
    }
}

TEST_CASE("Tints by height rise from green to white and do not mind no data") {
    const auto c = elevation_colors(std::vector<double>{5, no_data, 1000, 500});
    CHECK(is_green(c[0]));
    CHECK(is_white(c[2]));
    CHECK_FALSE(is_green(c[3]));
    CHECK(elevation_colors(std::vector<double>{7, 7}).size() == 2);
    const auto clay = clay_colors(3);
    CHECK((clay.size() == 3 && clay[0].r == clay[2].r));
}
