// SPDX-License-Identifier: GPL-3.0-or-later
#include "thalweg/terrain/hypsometry.hpp"

#include <catch2/catch.hpp>
#include <cmath>

#include "support/terrains.hpp"
#include "thalweg/core/error.hpp"
#include "thalweg/terrain/accumulate.hpp"

using namespace thalweg;
using namespace thalweg::terrain;
using namespace thalweg::support;

namespace {

/// A surface of revolution 1 − r^power on a disk of radius 1, sampled on n by n cells of any aspect.
Hypsometry of_revolution(Index n, double power) {
    const Grid grid = plane_grid(n, n, 2.0 / n, 2.0 / n);
    std::vector<double> z;
    for (Index node = 0; node < grid.size(); ++node) {
        const double r = std::hypot((grid.row(node) + 0.5) * 2 / n - 1, (grid.col(node) + 0.5) * 2 / n - 1);
        z.push_back(r <= 1 ? 1 - std::pow(r, power) : nodata);
    }
    return hypsometry(z, cell_areas(grid));
}

Hypsometry of_plane(Index cols) {
    const TestTerrain plane = terrain_of("plane", 3, cols, [](Index, Index c) { return 5.0 + 2.0 * c; });
    return hypsometry(plane.elevation_m, cell_areas(plane.grid));
}

}  // namespace

TEST_CASE("four drawn cells have the curve one draws") {
    // Heights 10, 20, 20, 30 over areas 4, 1, 1, 2: shares above 0, 1/4, 1/2, 3/4 and 1 of the relief.
    const Hypsometry h = hypsometry(std::vector<double>{20, 10, 30, 20}, std::vector<double>{1, 4, 2, 1}, 5);
    CHECK(h.minimum_m == 10);
    CHECK(h.maximum_m == 30);
    CHECK(h.mean_m == 17.5);
    CHECK(h.integral == 0.375);
    CHECK(h.integral_by_curve == 0.375);
    CHECK(h.relative_height == std::vector<double>{0, 0.25, 0.5, 0.75, 1});
    CHECK(h.relative_area == std::vector<double>{1, 0.5, 0.5, 0.25, 0.25});
}

TEST_CASE("a tilted plane has an integral of exactly one half") {
    for (const Index cols : {2u, 3u, 10u, 101u}) {
        CHECK(of_plane(cols).integral == 0.5);
        CHECK(of_plane(cols).integral_by_curve == Approx(0.5).epsilon(1e-14));
    }
}

TEST_CASE("a tilted plane has the moments of a triangle") {
    // f(x) = 1 − x: mean 1/3, variance 1/18, third moment 1/135, fourth 1/135; the steps err by the square of the
    // width.
    const Hypsometry h = of_plane(2001);
    CHECK(h.skewness == Approx(2 * std::sqrt(2.0) / 5).epsilon(1e-5));
    CHECK(h.kurtosis == Approx(2.4).epsilon(1e-5));
}

TEST_CASE("cone and paraboloid have integrals of one third and one half") {
    double last_error = 1;
    for (const Index n : {50u, 200u, 800u}) {
        const double error = std::abs(of_revolution(n, 1).integral - 1.0 / 3);
        CHECK(error < 2.0 / n);
        CHECK(error < last_error);
        last_error = error;
        CHECK(of_revolution(n, 2).integral == Approx(0.5).margin(2.0 / n));
    }
}

TEST_CASE("the curve of a cone is the square of the depth below its top") {
    const Hypsometry h = of_revolution(800, 1);
    for (std::size_t i = 0; i < h.relative_height.size(); ++i) {
        CHECK(h.relative_area[i] == Approx(std::pow(1 - h.relative_height[i], 2)).margin(5e-3));
    }
}

TEST_CASE("the moments of a cone's curve are those of its formula") {
    // f(x) = 1 − sqrt x on [0, 1]: ∫f = 1/3, ∫x^k f = 1/(k+1) − 1/(k+3/2).
    const auto raw = [](int k) { return 3 * (1 / (k + 1.0) - 1 / (k + 1.5)); };
    const double m = raw(1);
    const double variance = raw(2) - m * m;
    const double third = raw(3) - 3 * m * raw(2) + 2 * m * m * m;
    const double fourth = raw(4) - 4 * m * raw(3) + 6 * m * m * raw(2) - 3 * m * m * m * m;
    const Hypsometry h = of_revolution(800, 1);
    CHECK(h.skewness == Approx(third / std::pow(variance, 1.5)).epsilon(2e-3));
    CHECK(h.kurtosis == Approx(fourth / (variance * variance)).epsilon(2e-3));
}

TEST_CASE("integral and curve agree on any terrain, with cells of any size") {
    for (std::uint64_t seed = 1; seed <= 50; ++seed) {
        const Grid grid = uneven_grid(30, 40);
        const TestTerrain heights =
            with_holes(seed % 2 ? noise_terrain(30, 40, seed) : stepped_terrain(30, 40, 9, seed), 0.2, seed);
        const Hypsometry h = hypsometry(heights.elevation_m, cell_areas(grid));
        CHECK(h.integral_by_curve == Approx(h.integral).epsilon(1e-13));
        CHECK(h.relative_area.front() == 1);
        CHECK(h.relative_area.back() > 0);
        CHECK(std::is_sorted(h.relative_area.rbegin(), h.relative_area.rend()));
    }
}

TEST_CASE("each point of the curve is the share of the area at or above its height") {
    const TestTerrain terrain = stepped_terrain(20, 30, 17, 3);
    const std::vector<double> areas = cell_areas(uneven_grid(20, 30));
    const Hypsometry h = hypsometry(terrain.elevation_m, areas, 33);
    double total = 0;
    for (const double area : areas) total += area;
    for (std::size_t i = 0; i < h.relative_height.size(); ++i) {
        double above = 0;
        for (std::size_t cell = 0; cell < areas.size(); ++cell) {
            if (terrain.elevation_m[cell] / 16 >= h.relative_height[i]) above += areas[cell];
        }
        CHECK(h.relative_area[i] == Approx(above / total).epsilon(1e-12));
    }
}

TEST_CASE("height unit, datum and area unit do not change what is relative") {
    const TestTerrain terrain = noise_terrain(25, 25, 8);
    const std::vector<double> areas = cell_areas(terrain.grid);
    std::vector<double> feet, hectares;
    for (const double z : terrain.elevation_m) feet.push_back(-300 + z / 0.3048);
    for (const double a : areas) hectares.push_back(a * 1e-4);
    const Hypsometry a = hypsometry(terrain.elevation_m, areas);
    const Hypsometry b = hypsometry(feet, hectares);
    CHECK(a.integral == Approx(b.integral).epsilon(1e-11));
    CHECK(a.skewness == Approx(b.skewness).epsilon(1e-11));
    CHECK(a.kurtosis == Approx(b.kurtosis).epsilon(1e-11));
}

TEST_CASE("a surface without relief, or without data, has no curve") {
    const Hypsometry level = hypsometry(std::vector<double>{4, nodata, 4}, std::vector<double>{1, 1, 1});
    CHECK(level.minimum_m == 4);
    CHECK(level.mean_m == 4);
    CHECK(std::isnan(level.integral));
    CHECK(std::isnan(level.integral_by_curve));
    CHECK(std::isnan(level.skewness));
    CHECK(level.relative_area.empty());
    CHECK(std::isnan(hypsometry(std::vector<double>{nodata}, std::vector<double>{1}).minimum_m));
    CHECK_THROWS_AS(hypsometry(std::vector<double>{1, 2}, std::vector<double>{1}), Error);
    CHECK_THROWS_AS(hypsometry(std::vector<double>{1, 2}, std::vector<double>{1, 1}, 1), Error);
}
