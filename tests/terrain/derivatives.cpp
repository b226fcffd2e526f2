// SPDX-License-Identifier: GPL-3.0-or-later
#include "thalweg/terrain/derivatives.hpp"

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <functional>
#include <limits>
#include <numbers>

#include "support/terrains.hpp"
#include "thalweg/core/error.hpp"
#include "thalweg/core/parallel.hpp"
#include "thalweg/core/random.hpp"

using namespace thalweg;
using namespace thalweg::terrain;

namespace {

constexpr double pi = std::numbers::pi;
using Surface = std::function<double(double x, double y)>;  // metres east and north of the middle

struct Sampled {
    Grid grid;
    std::vector<double> height;
    double x(Index node) const { return (grid.col(node) + 0.5 - 0.5 * grid.cols) * grid.east_west[0]; }
    double y(Index node) const { return (0.5 * grid.rows - grid.row(node) - 0.5) * grid.north_south[0]; }
};

Sampled sampled(Index rows, Index cols, double dx, double dy, const Surface& surface) {
    Sampled s{plane_grid(rows, cols, dx, dy), {}};
    for (Index node = 0; node < s.grid.size(); ++node) s.height.push_back(surface(s.x(node), s.y(node)));
    return s;
}

bool inside(const Grid& grid, Index node) {
    const Index row = grid.row(node), col = grid.col(node);
    return row > 0 && col > 0 && row + 1 < grid.rows && col + 1 < grid.cols;
}

/// Largest difference from `truth` over the cells whose middle lies between two distances from the middle of it all.
double worst(const Sampled& s, const std::vector<double>& found, const Surface& truth, double from, double to) {
    double largest = 0;
    for (Index node = 0; node < s.grid.size(); ++node) {
        const double r = std::hypot(s.x(node), s.y(node));
        if (!inside(s.grid, node) || r < from || r > to) continue;
        REQUIRE(!std::isnan(found[node]));
        largest = std::max(largest, std::abs(found[node] - truth(s.x(node), s.y(node))));
    }
    return largest;
}

double aspect_off(double found, double truth) { return std::abs(std::remainder(found - truth, 2 * pi)); }

/// By how much the error falls, as a power of the cell, when the same ring of a surface is sampled twice as finely.
double order(const Surface& surface, const Surface& truth,
             std::vector<double> (*derivative)(const Grid&, std::span<const double>)) {
    const auto error = [&](Index cells) {
        const double dx = 400.0 / cells, dy = 1.25 * 400.0 / cells;  // oblong cells
        const Sampled s = sampled(cells, cells, dx, dy, surface);
        return worst(s, derivative(s.grid, s.height), truth, 60, 160);
    };
    return std::log2(error(160) / error(320));
}

}  // namespace

TEST_CASE("Planes have their own slope and aspect and no curvature, on oblong cells too", "[derivatives]") {
    for (std::uint64_t seed = 0; seed < 40; ++seed) {
        Random random(seed, 0);
        const double a = 2 * random.uniform() - 1, b = 2 * random.uniform() - 1;
        const double dx = 1 + 50 * random.uniform(), dy = 1 + 50 * random.uniform();
        const Sampled s = sampled(7, 9, dx, dy, [&](double x, double y) { return 3000 + a * x + b * y; });
        CHECK(worst(
                  s, slope(s.grid, s.height), [&](double, double) { return std::hypot(a, b); }, 0, 1e9) < 1e-10);
        for (const double facing : aspect(s.grid, s.height)) {
            if (std::isnan(facing)) continue;
            CHECK(aspect_off(facing, std::atan2(-a, -b)) < 1e-9);
            CHECK((facing >= 0 && facing < 2 * pi));
        }
        const auto nothing = [](double, double) { return 0.0; };
        CHECK(worst(s, profile_curvature(s.grid, s.height), nothing, 0, 1e9) < 1e-10);
        CHECK(worst(s, plan_curvature(s.grid, s.height), nothing, 0, 1e9) < 1e-8);
    }
}

TEST_CASE("Aspect goes clockwise from north, where the surface faces", "[derivatives]") {
    const auto facing = [](double a, double b) {
        const Sampled s = sampled(3, 3, 10, 20, [&](double x, double y) { return a * x + b * y; });
        return aspect(s.grid, s.height)[4] * 180 / pi;
    };
    CHECK(facing(0, -1) == Approx(0).margin(1e-12));
    CHECK(facing(-1, 0) == Approx(90));
    CHECK(facing(0, 1) == Approx(180));
    CHECK(facing(1, 0) == Approx(270));
    CHECK(facing(-1, -1) == Approx(45));
    CHECK(std::isnan(facing(0, 0)));
}

TEST_CASE("Quadrics are measured exactly: the curvatures of a paraboloid, a saddle and a valley", "[derivatives]") {
    // A dome 1000 − c·r²/2: contours are circles, the profile is a parabola.
    const double c = 0.004;
    const Sampled dome = sampled(21, 31, 8, 11, [&](double x, double y) { return 1000 - c * (x * x + y * y) / 2; });
    const auto radius = [](double x, double y) { return std::hypot(x, y); };
    const auto steep = [&](double x, double y) { return c * radius(x, y); };
    CHECK(worst(dome, slope(dome.grid, dome.height), steep, 1, 1e9) < 1e-12);
    CHECK(worst(
              dome, plan_curvature(dome.grid, dome.height), [&](double x, double y) { return 1 / radius(x, y); }, 1,
              1e9) < 1e-9);
    CHECK(worst(
              dome, profile_curvature(dome.grid, dome.height),
              [&](double x, double y) { return c / std::pow(1 + steep(x, y) * steep(x, y), 1.5); }, 1, 1e9) < 1e-12);
    // The same upside down is concave both ways.
    Sampled bowl = dome;
    for (double& each : bowl.height) each = -each;
    CHECK(worst(
              bowl, plan_curvature(bowl.grid, bowl.height), [&](double x, double y) { return -1 / radius(x, y); }, 1,
              1e9) < 1e-9);
    // A saddle x·y: on the x-axis the gradient is (0, x), r = t = 0 and s = 1: no curvature of the profile; of contours
    // x·y = const through (x, 0) none either. On the diagonal, the slope runs along it: s counts fully.
    const Sampled saddle = sampled(11, 11, 2, 2, [](double x, double y) { return 0.01 * x * y; });
    const auto profile = profile_curvature(saddle.grid, saddle.height),
               plan = plan_curvature(saddle.grid, saddle.height);
    const Index on_axis = 5 * 11 + 8, on_diagonal = 2 * 11 + 8;  // (6, 0) and (6, 6)
    CHECK(profile[on_axis] == Approx(0).margin(1e-12));
    CHECK(plan[on_axis] == Approx(0).margin(1e-12));
    const double square = 2 * 0.06 * 0.06;
    CHECK(profile[on_diagonal] == Approx(-0.01 / std::pow(1 + square, 1.5)).epsilon(1e-9));
    CHECK(plan[on_diagonal] == Approx(0.01 / std::sqrt(square)).epsilon(1e-9));
}

TEST_CASE("On cones and spheres the errors fall with the square of the cell", "[derivatives]") {
    const auto radius = [](double x, double y) { return std::hypot(x, y); };
    const Surface cone = [&](double x, double y) { return 500 - 0.7 * radius(x, y); };
    const Surface cone_slope = [](double, double) { return 0.7; };
    const Surface around = [&](double x, double y) { return 1 / radius(x, y); };
    CHECK(order(cone, cone_slope, slope) == Approx(2).margin(0.1));
    CHECK(order(cone, around, plan_curvature) == Approx(2).margin(0.1));
    CHECK(order(
              cone, [](double, double) { return 0.0; }, profile_curvature) == Approx(2).margin(0.1));
    const double R = 300;
    const Surface sphere = [&](double x, double y) { return std::sqrt(R * R - x * x - y * y); };
    const Surface sphere_slope = [&](double x, double y) { return radius(x, y) / sphere(x, y); };
    CHECK(order(sphere, sphere_slope, slope) == Approx(2).margin(0.1));
    CHECK(order(sphere, around, plan_curvature) == Approx(2).margin(0.1));
    CHECK(order(
              sphere, [&](double, double) { return 1 / R; }, profile_curvature) == Approx(2).margin(0.1));
}

TEST_CASE("No data, and what is beside it, has no derivative; nor has the rim", "[derivatives]") {
    Sampled s = sampled(8, 9, 10, 10, [](double x, double y) { return x * x + 3 * y + 0.1 * x * y; });
    s.height[3 * 9 + 4] = std::numeric_limits<double>::quiet_NaN();
    for (const auto& values : {slope(s.grid, s.height), aspect(s.grid, s.height), profile_curvature(s.grid, s.height),
                               plan_curvature(s.grid, s.height)}) {
        for (Index node = 0; node < s.grid.size(); ++node) {
            const Index row = s.grid.row(node), col = s.grid.col(node);
            const bool beside = row >= 2 && row <= 4 && col >= 3 && col <= 5;
            CHECK(std::isnan(values[node]) == (beside || !inside(s.grid, node)));
        }
    }
    for (const auto& [rows, cols] : {std::pair<Index, Index>{1, 1}, {1, 9}, {9, 1}, {2, 2}}) {
        const Grid grid = plane_grid(rows, cols, 1, 1);
        const std::vector<double> height(grid.size(), 5);
        for (const double each : slope(grid, height)) CHECK(std::isnan(each));
        for (const double each : local_relief(grid, height, 3)) CHECK(each == 0);
    }
    CHECK_THROWS_AS(slope(plane_grid(3, 3, 1, 1), std::vector<double>(8)), Error);
    CHECK_THROWS_AS(local_relief(plane_grid(3, 3, 1, 1), std::vector<double>(9), 0), Error);
}

TEST_CASE("A turned or mirrored surface has turned and mirrored derivatives", "[derivatives]") {
    for (std::uint64_t seed = 0; seed < 5; ++seed) {
        const auto noise = support::noise_terrain(13, 17, seed);
        const Index rows = 13, cols = 17;
        std::vector<double> turned(noise.elevation_m.size()), mirrored(turned);
        for (Index row = 0; row < rows; ++row) {
            for (Index col = 0; col < cols; ++col) {
                const double z = noise.elevation_m[row * cols + col];
                turned[col * rows + (rows - 1 - row)] = z;  // clockwise
                mirrored[row * cols + (cols - 1 - col)] = z;
            }
        }
        const Grid plain = plane_grid(rows, cols, 7, 11), other = plane_grid(cols, rows, 11, 7);
        const auto check = [&](auto derivative, double about_mirror, double about_turn) {
            const auto a = derivative(plain, noise.elevation_m), b = derivative(other, turned);
            const auto c = derivative(plain, mirrored);
            for (Index row = 1; row + 1 < rows; ++row) {
                for (Index col = 1; col + 1 < cols; ++col) {
                    const double value = a[row * cols + col];
                    const double expected_turn = value + about_turn;
                    const double expected_mirror = about_mirror < 0 ? -value : value;
                    const auto near = [&](double found, double expected) {
                        if (about_turn == 0) return std::abs(found - expected) < 1e-9 * (1 + std::abs(expected));
                        return aspect_off(found, expected) < 1e-9;
                    };
                    CHECK(near(b[col * rows + (rows - 1 - row)], expected_turn));
                    CHECK(near(c[row * cols + (cols - 1 - col)], expected_mirror));
                }
            }
        };
        check(slope, 1, 0);
        check(aspect, -1, pi / 2);
        check(profile_curvature, 1, 0);
        check(plan_curvature, 1, 0);
        check([](const Grid& grid, std::span<const double> z) { return local_relief(grid, z, 33); }, 1, 0);
    }
}

TEST_CASE("Local relief is that of a slow search in a circle, with holes, edges and oblong cells", "[derivatives]") {
    for (std::uint64_t seed = 0; seed < 20; ++seed) {
        Random random(seed, 1);
        const Index rows = 1 + random.below(30), cols = 1 + random.below(30);
        const double dx = 5 + 10 * random.uniform(), dy = 5 + 10 * random.uniform(), radius = 80 * random.uniform() + 5;
        const Grid grid = plane_grid(rows, cols, dx, dy);
        std::vector<double> z;
        for (Index node = 0; node < grid.size(); ++node) {
            z.push_back(random.uniform() < 0.15 ? std::numeric_limits<double>::quiet_NaN() : 100 * random.uniform());
        }
        const auto found = local_relief(grid, z, radius);
        for (Index node = 0; node < grid.size(); ++node) {
            double low = 1e9, high = -1e9;
            for (Index other = 0; other < grid.size(); ++other) {
                const double east = dx * (double(grid.col(other)) - grid.col(node));
                const double south = dy * (double(grid.row(other)) - grid.row(node));
                if (std::isnan(z[other]) || std::hypot(east, south) > radius) continue;
                low = std::min(low, z[other]);
                high = std::max(high, z[other]);
            }
            if (std::isnan(z[node]))
                CHECK(std::isnan(found[node]));
            else
                CHECK(found[node] == Approx(high - low).margin(1e-12));
        }
    }
}

TEST_CASE("Local relief of a plane is its slope across the circle, and threads change nothing", "[derivatives]") {
    const Sampled s = sampled(90, 80, 10, 10, [](double x, double y) { return 0.3 * x + 0.4 * y; });
    const auto relief = local_relief(s.grid, s.height, 250);
    CHECK(relief[45 * 80 + 40] == Approx(0.5 * 2 * 250).epsilon(1e-9));  // 15, 20 and 25 cells: on the circle
    const ThreadLimit limit(1);
    CHECK(local_relief(s.grid, s.height, 250) == relief);
    CHECK(slope(s.grid, s.height)[45 * 80 + 40] == Approx(0.5));
}
