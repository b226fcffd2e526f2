// SPDX-License-Identifier: GPL-3.0-or-later
#include "thalweg/terrain/hypsometry.hpp"

#include <algorithm>
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

TEST_CASE("the density of a plane, a cone and a paraboloid has the moments of its formula") {
    const Hypsometry plane = of_plane(2001);  // uniform
    CHECK(plane.density_skewness == Approx(0).margin(1e-3));
    CHECK(plane.density_kurtosis == Approx(1.8).epsilon(1e-3));
    const Hypsometry paraboloid = of_revolution(800, 2);
    CHECK(paraboloid.density_skewness == Approx(0).margin(1e-2));
    CHECK(paraboloid.density_kurtosis == Approx(1.8).epsilon(1e-2));
    // A cone has f = 1 − √x, −df/dx = 1/(2√x): ∫x^k·(−df) = 1/(2k + 1).
    const double m = 1.0 / 3, variance = 1.0 / 5 - m * m;
    const double third = 1.0 / 7 - 3 * m / 5 + 2 * m * m * m;
    const double fourth = 1.0 / 9 - 4 * m / 7 + 6 * m * m / 5 - 3 * m * m * m * m;
    const Hypsometry cone = of_revolution(800, 1);
    CHECK(cone.density_skewness == Approx(third / std::pow(variance, 1.5)).epsilon(5e-3));
    CHECK(cone.density_kurtosis == Approx(fourth / (variance * variance)).epsilon(5e-3));
}

namespace {

/// Moments and curve by sorting all cells, however many there are: μ_k = ∫ a(h)^(k+1)/(k+1) dh over the relative
/// height, a(h) the area at or above it, which is ∫ x^k·f dx with the order of integration changed.
Hypsometry by_sorting(const std::vector<double>& z, const std::vector<double>& area) {
    std::vector<std::size_t> order(z.size());
    for (std::size_t i = 0; i < order.size(); ++i) order[i] = i;
    std::sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return z[a] > z[b]; });
    double total = 0;
    for (const double a : area) total += a;
    const double relief = z[order.front()] - z[order.back()];
    double raw[5] = {0, 0, 0, 0, 0}, above = 0;
    for (std::size_t i = 0; i + 1 < order.size(); ++i) {
        above += area[order[i]] / total;
        const double drop = (z[order[i]] - z[order[i + 1]]) / relief;
        for (int k = 0; k < 5; ++k) raw[k] += drop * std::pow(above, k + 1) / (k + 1);
    }
    Hypsometry h{};
    h.integral = raw[0];
    const double m = raw[1] / raw[0], variance = raw[2] / raw[0] - m * m;
    h.skewness = (raw[3] / raw[0] - 3 * m * raw[2] / raw[0] + 2 * m * m * m) / std::pow(variance, 1.5);
    h.kurtosis = (raw[4] / raw[0] - 4 * m * raw[3] / raw[0] + 6 * m * m * raw[2] / raw[0] - 3 * m * m * m * m) /
                 (variance * variance);
    return h;
}

}  // namespace

TEST_CASE("many cells in slices of the relief give what sorting each of them gives") {
    const Grid grid = uneven_grid(100, 900);
    const std::vector<double> areas = cell_areas(grid);
    for (const double step : {0.0, 0.01}) {
        std::vector<double> z = noise_terrain(100, 900, 5).elevation_m;
        for (double& height : z) {
            height = 700 + 300 * height * height;
            if (step > 0) height = step * std::round(height / step);
        }
        const Hypsometry expected = by_sorting(z, areas), h = hypsometry(z, areas);
        CHECK(h.integral == Approx(expected.integral).epsilon(1e-12));
        CHECK(h.integral_by_curve == Approx(expected.integral).epsilon(1e-9));
        CHECK(h.skewness == Approx(expected.skewness).margin(1e-8));
        CHECK(h.kurtosis == Approx(expected.kurtosis).margin(1e-8));
        double total = 0;
        for (const double area : areas) total += area;
        for (std::size_t i = 0; i < h.relative_height.size(); i += 10) {
            double above = 0;
            for (std::size_t cell = 0; cell < z.size(); ++cell) {
                const double relative = (z[cell] - h.minimum_m) / (h.maximum_m - h.minimum_m);
                if (relative >= h.relative_height[i]) above += areas[cell];
            }
            CHECK(h.relative_area[i] == Approx(above / total).epsilon(1e-12));
        }
    }
}

TEST_CASE("whole heights of many cells keep an exact curve") {
    const TestTerrain terrain = stepped_terrain(300, 300, 101, 3);
    const std::vector<double> areas = cell_areas(terrain.grid);
    const Hypsometry h = hypsometry(terrain.elevation_m, areas);
    for (std::size_t i = 0; i < 101; ++i) {
        const auto above = std::ranges::count_if(terrain.elevation_m, [&](double z) { return z >= 1.0 * i; });
        CHECK(h.relative_area[i] == Approx(above / 90000.0).epsilon(1e-12));
    }
}

TEST_CASE("the hypsometry of each basin is that of its own cells") {
    const TestTerrain terrain = with_holes(noise_terrain(20, 30, 2), 0.1, 2);
    const std::vector<double> areas = cell_areas(uneven_grid(20, 30));
    const std::vector<Index> offset{0, 250, 250, 600};
    std::vector<Index> nodes;
    for (Index node = 0; node < 600; ++node) nodes.push_back((node * 7) % 600);
    const auto all = hypsometries(terrain.elevation_m, areas, offset, nodes, 11);
    REQUIRE(all.size() == 3);
    for (const std::size_t basin : {0u, 2u}) {
        std::vector<double> z, a;
        for (Index i = offset[basin]; i < offset[basin + 1]; ++i) {
            z.push_back(terrain.elevation_m[nodes[i]]);
            a.push_back(areas[nodes[i]]);
        }
        const Hypsometry expected = hypsometry(z, a, 11);
        CHECK(all[basin].integral == expected.integral);
        CHECK(all[basin].density_skewness == expected.density_skewness);
        CHECK(all[basin].relative_area == expected.relative_area);
    }
    CHECK(std::isnan(all[1].minimum_m));
}
