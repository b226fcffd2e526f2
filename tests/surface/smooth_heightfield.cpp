// SPDX-License-Identifier: GPL-3.0-or-later
// Gaussian and natural neighbour interpolation.
#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <limits>

#include "support/outlines.hpp"
#include "support/rasters.hpp"
#include "thalweg/core/error.hpp"
#include "thalweg/core/parallel.hpp"
#include "thalweg/surface/heightfield.hpp"

using namespace thalweg;
using namespace thalweg::surface;
using namespace support;

namespace {

double rough(double x, double y) { return std::sin(17 * x + 3 * y) + std::cos(11 * y) * x; }

Raster covered(const Mesh& mesh, Index resolution) { return covering_raster(mesh, resolution); }

/// The part of a convex polygon that is nearer to a than to b.
Polygon nearer_part(const Polygon& polygon, const Point& a, const Point& b) {
    const auto excess = [&](const Point& p) {  // of the square of the distance to a
        return (p.x - a.x) * (p.x - a.x) + (p.y - a.y) * (p.y - a.y) - (p.x - b.x) * (p.x - b.x) -
               (p.y - b.y) * (p.y - b.y);
    };
    Polygon part;
    for (std::size_t i = 0; i < polygon.size(); ++i) {
        const Point &p = polygon[i], &q = polygon[(i + 1) % polygon.size()];
        const double ep = excess(p), eq = excess(q);
        if (ep <= 0) part.push_back(p);
        if ((ep < 0 && eq > 0) || (ep > 0 && eq < 0)) {
            part.push_back({p.x + ep / (ep - eq) * (q.x - p.x), p.y + ep / (ep - eq) * (q.y - p.y)});
        }
    }
    return part;
}

/// Sibson's mean by its definition: cells cut out of a large square by every bisector there is.
double stolen_area_mean(const Mesh& mesh, const std::vector<double>& values, const Point& p) {
    Polygon cell{{-9, -9}, {9, -9}, {9, 9}, {-9, 9}};
    for (Index i = 0; i < mesh.size(); ++i) cell = nearer_part(cell, p, {mesh.x[i], mesh.y[i]});
    double area = 0, sum = 0;
    for (Index i = 0; i < mesh.size(); ++i) {
        Polygon stolen = cell;
        for (Index j = 0; j < mesh.size() && !stolen.empty(); ++j) {
            if (j != i) stolen = nearer_part(stolen, {mesh.x[i], mesh.y[i]}, {mesh.x[j], mesh.y[j]});
        }
        const double taken = stolen.size() < 3 ? 0 : mesh::polygon_area(stolen);
        area += taken;
        sum += taken * values[i];
    }
    return sum / area;
}

double gaussian_mean(const Mesh& mesh, const std::vector<double>& values, const Point& p, double sigma) {
    double weight = 0, sum = 0;
    for (Index i = 0; i < mesh.size(); ++i) {
        const double d = distance(p, {mesh.x[i], mesh.y[i]});
        const double w = std::exp(-d * d / (2 * sigma * sigma));
        weight += w;
        sum += w * values[i];
    }
    return sum / weight;
}

/// Of the lines through a polygon's sides, the nearest one.
double distance_to_sides(const Polygon& outline, const Point& p) {
    double nearest = std::numeric_limits<double>::infinity();
    for (std::size_t i = 0; i < outline.size(); ++i) {
        const Point &a = outline[i], &b = outline[(i + 1) % outline.size()];
        const double cross = (b.x - a.x) * (p.y - a.y) - (b.y - a.y) * (p.x - a.x);
        nearest = std::min(nearest, std::abs(cross) / distance(a, b));
    }
    return nearest;
}

/// One cell around a place.
Raster spot_at(const Point& p) {
    Raster spot;
    spot.grid = plane_grid(1, 1, 2, 2);
    spot.placement = {.west = p.x - 1, .north = p.y + 1, .cell_width = 2, .cell_height = 2, .crs_wkt = {}};
    return spot;
}

/// A square of side 4 with a narrow slot cut into it from the north, at x from 1.95 to 2.05, down to y = 1.
Polygon slotted_square() { return {{0, 0}, {4, 0}, {4, 4}, {2.05, 4}, {2.05, 1}, {1.95, 1}, {1.95, 4}, {0, 4}}; }

}  // namespace

TEST_CASE("Natural neighbours weigh by the areas of cells cut by bisectors") {
    for (std::uint64_t seed = 1; seed <= 6; ++seed) {
        const Mesh mesh = poisson_mesh(random_convex(9, seed), 60, seed);
        const std::vector<double> values = node_values(mesh, rough);
        Raster raster = covered(mesh, 25);
        interpolate_natural(mesh, values, raster);
        Index compared = 0;
        visit_centers(raster, [&](Index cell, const Point& p) {
            if (std::isnan(raster.values[cell])) return;
            // Near the outline the new cell reaches beyond the oracle's square.
            if (distance_to_sides(mesh.outline, p) < 0.02) return;
            INFO(seed << ": " << p.x << ", " << p.y);
            REQUIRE(std::abs(raster.values[cell] - stolen_area_mean(mesh, values, p)) < 1e-9);
            ++compared;
        });
        CHECK(compared > 100);
    }
}

TEST_CASE("Natural neighbours of a square's centre share equally, and an edge's middle is the mean of its ends") {
    mesh::PointSet set{.points = {{0, 0}, {2, 0}, {2, 2}, {0, 2}}, .outline_count = 4};
    const Mesh mesh = mesh::triangulate(rectangle(2, 2), set);
    const std::vector<double> values = node_values(mesh, [](double x, double y) { return x * y; });
    Raster spot = spot_at({1, 1});
    interpolate_natural(mesh, values, spot);
    CHECK(spot.values[0] == Approx(1).epsilon(1e-14));
    spot = spot_at({2, 1});
    interpolate_natural(mesh, values, spot);
    CHECK(spot.values[0] == Approx(2).epsilon(1e-14));
}

TEST_CASE("Natural neighbours reproduce a plane to rounding in every outline, and nothing beyond it") {
    for (const auto& [name, outline] : many_outlines()) {
        for (std::uint64_t seed = 1; seed <= 4; ++seed) {
            INFO(name << ", seed " << seed);
            const Mesh mesh = poisson_mesh(outline, 300, seed);
            Raster raster = covered(mesh, 120);
            interpolate_natural(mesh, node_values(mesh, [](double x, double y) { return 3 + 2 * x - 5 * y; }), raster);
            visit_centers(raster, [&](Index cell, const Point& p) {
                if (is_inside(outline, p)) {
                    REQUIRE(std::abs(raster.values[cell] - (3 + 2 * p.x - 5 * p.y)) < 1e-9);
                } else {
                    REQUIRE(std::isnan(raster.values[cell]));
                }
            });
        }
    }
}

TEST_CASE("Natural neighbours stay within the values around, for random values") {
    for (std::uint64_t seed = 1; seed <= 20; ++seed) {
        const Mesh mesh = poisson_mesh(random_star(11, seed), 200, seed);
        Random random(seed, 3);
        std::vector<double> values(mesh.size());
        for (double& v : values) v = random.uniform();
        Raster raster = covered(mesh, 70), lower = raster;
        interpolate_natural(mesh, values, raster);
        for (double& v : values) v += 1000;
        interpolate_natural(mesh, values, lower);
        for (Index cell = 0; cell < raster.grid.size(); ++cell) {
            if (std::isnan(raster.values[cell])) continue;
            REQUIRE((raster.values[cell] >= 0 && raster.values[cell] <= 1));
            REQUIRE(std::abs(lower.values[cell] - raster.values[cell] - 1000) < 1e-9);
        }
    }
}

TEST_CASE("Natural neighbours meet a node's value at its place and are continuous beside it") {
    const Mesh mesh = poisson_mesh(l_shape(), 300);
    const std::vector<double> values = node_values(mesh, rough);
    for (Index node = 0; node < mesh.size(); node += 3) {
        const Point p{mesh.x[node], mesh.y[node]};
        Raster spot = spot_at(p);
        if (!(spot.placement.center(0, 0) == p)) continue;
        interpolate_natural(mesh, values, spot);
        REQUIRE(spot.values[0] == values[node]);
        for (const double step : {1e-4, 1e-8, 1e-12, 1e-15}) {
            for (int turn = 0; turn < 8; ++turn) {
                spot = spot_at({p.x + step * std::cos(turn), p.y + step * std::sin(turn)});
                interpolate_natural(mesh, values, spot);
                if (std::isnan(spot.values[0])) continue;
                REQUIRE(std::abs(spot.values[0] - values[node]) < 300 * step + 1e-12);
            }
        }
    }
}

TEST_CASE("Natural neighbours are continuous across edges, where linear interpolation has a fold") {
    const Mesh mesh = poisson_mesh(random_star(9, 4), 150);
    const std::vector<double> values = node_values(mesh, rough);
    const auto value = [&](const Point& p) {
        Raster spot = spot_at(p);
        interpolate_natural(mesh, values, spot);
        return spot.values[0];
    };
    const auto gradient_jump = [&](const auto& height, const Point& at, const Point& across) {
        const double step = 1e-5;
        const auto at_step = [&](double n) { return height({at.x + n * step * across.x, at.y + n * step * across.y}); };
        return std::abs((at_step(2) - at_step(1)) - (at_step(-1) - at_step(-2))) / step;
    };
    Index tested = 0;
    for (const auto& t : mesh.triangles) {
        const Point a{mesh.x[t[0]], mesh.y[t[0]]}, b{mesh.x[t[1]], mesh.y[t[1]]};
        if (mesh.on_outline[t[0]] || mesh.on_outline[t[1]] || t[0] > t[1]) continue;
        const double length = distance(a, b);
        const Point middle{0.4 * a.x + 0.6 * b.x, 0.4 * a.y + 0.6 * b.y};
        const Point across{(a.y - b.y) / length, (b.x - a.x) / length};
        REQUIRE(gradient_jump(value, middle, across) < 0.05);
        ++tested;
    }
    CHECK(tested > 50);
}

TEST_CASE("What lies beyond a gap of the domain has no influence on natural neighbours") {
    const Mesh mesh = poisson_mesh(slotted_square(), 600);
    std::vector<double> values = node_values(mesh, rough);
    Raster before = covered(mesh, 160), after = before;
    interpolate_natural(mesh, values, before);
    for (Index node = 0; node < mesh.size(); ++node) {
        if (mesh.x[node] > 2 && mesh.y[node] > 1.8) values[node] += 100;
    }
    interpolate_natural(mesh, values, after);
    visit_centers(before, [&](Index cell, const Point& p) {
        if (p.x < 1.9 && p.y > 1.2) REQUIRE(same_bytes({before.values[cell]}, {after.values[cell]}));
    });
}

TEST_CASE("Gaussian means are those of all nodes, to the weights left out") {
    for (const auto& [name, outline] : many_outlines()) {
        INFO(name);
        const Mesh mesh = poisson_mesh(outline, 200);
        const std::vector<double> values = node_values(mesh, [](double x, double y) { return std::sin(3 * x) * y; });
        const double highest = *std::max_element(values.begin(), values.end());
        const double lowest = *std::min_element(values.begin(), values.end());
        Raster raster = covered(mesh, 40);
        double area = 0;
        for (const double cell : mesh.cell_area) area += cell;
        for (const double spacings : {0.5, 1.0, 3.0}) {
            const double sigma = spacings * std::sqrt(area / mesh.size());
            interpolate_gaussian(mesh, values, sigma, raster);
            visit_centers(raster, [&](Index cell, const Point& p) {
                REQUIRE(std::isnan(raster.values[cell]) == !is_inside(outline, p));
                if (std::isnan(raster.values[cell])) return;
                const double expected = gaussian_mean(mesh, values, p, sigma);
                REQUIRE(std::abs(raster.values[cell] - expected) < 1e-3 * (highest - lowest));
            });
        }
    }
}

TEST_CASE("Gaussian means never leave the range of the values, and a constant stays itself to the last bit") {
    for (std::uint64_t seed = 1; seed <= 20; ++seed) {
        const Mesh mesh = poisson_mesh(random_star(13, seed), 150, seed);
        Random random(seed, 9);
        std::vector<double> values(mesh.size());
        for (double& v : values) v = random.uniform();
        const auto [lowest, highest] = std::minmax_element(values.begin(), values.end());
        Raster raster = covered(mesh, 60);
        for (const double sigma : {1e-9, 1e-3, 0.1, 1e6}) {
            interpolate_gaussian(mesh, values, sigma, raster);
            for (const double v : raster.values) {
                if (!std::isnan(v)) REQUIRE((v >= *lowest && v <= *highest));
            }
            interpolate_gaussian(mesh, std::vector<double>(mesh.size(), 0.1), sigma, raster);
            for (const double v : raster.values) {
                if (!std::isnan(v)) REQUIRE(v == 0.1);
            }
        }
    }
}

TEST_CASE("Narrow weights leave the nearest node, wide ones the mean of all") {
    const Mesh mesh = poisson_mesh(random_star(12, 5), 300);
    const std::vector<double> values = node_values(mesh, rough);
    Raster raster = covered(mesh, 80);
    const std::vector<Index> nearest = nearest_node(mesh, raster);
    interpolate_gaussian(mesh, values, 1e-8, raster);
    double mean = 0;
    for (const double v : values) mean += v / static_cast<double>(values.size());
    for (Index cell = 0; cell < raster.grid.size(); ++cell) {
        if (nearest[cell] != none) REQUIRE(raster.values[cell] == values[nearest[cell]]);
    }
    interpolate_gaussian(mesh, values, 1e5, raster);
    for (const double v : raster.values) {
        if (!std::isnan(v)) REQUIRE(std::abs(v - mean) < 1e-8);
    }
}

TEST_CASE("One thread and two give the same bytes, smoothed or by natural neighbours") {
    const Mesh mesh = poisson_mesh(random_star(15, 2), 3000);
    const std::vector<double> values = node_values(mesh, rough);
    const auto run = [&](int threads) {
        const ThreadLimit limit(threads);
        Raster natural = covered(mesh, 300), smooth = natural;
        interpolate_natural(mesh, values, natural);
        interpolate_gaussian(mesh, values, 0.02, smooth);
        return std::pair(natural.values, smooth.values);
    };
    const auto one = run(1), two = run(2);
    CHECK(same_bytes(one.first, two.first));
    CHECK(same_bytes(one.second, two.second));
}

TEST_CASE("Far from the origin a plane and its places keep their digits") {
    Mesh mesh = poisson_mesh(rectangle(1000, 1000), 400);
    for (double& x : mesh.x) x += 5e5;
    for (double& y : mesh.y) y += 4.2e6;
    Raster raster = covered(mesh, 100);
    interpolate_natural(mesh, mesh.x, raster);
    visit_centers(raster, [&](Index cell, const Point& p) { REQUIRE(std::abs(raster.values[cell] - p.x) < 1e-6); });
}

TEST_CASE("Smoothing refuses what it cannot do") {
    const Mesh mesh = poisson_mesh(rectangle(1, 1), 50);
    Raster raster = covered(mesh, 10);
    const std::vector<double> values(mesh.size(), 1.0), few(3, 1.0);
    CHECK_THROWS_AS(interpolate_natural(mesh, few, raster), Error);
    CHECK_THROWS_AS(interpolate_gaussian(mesh, few, 1, raster), Error);
    for (const double sigma : {0.0, -1.0, std::nan(""), HUGE_VAL}) {
        CHECK_THROWS_AS(interpolate_gaussian(mesh, values, sigma, raster), Error);
    }
}
