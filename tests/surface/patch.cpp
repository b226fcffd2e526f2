// SPDX-License-Identifier: GPL-3.0-or-later
#include "thalweg/surface/patch.hpp"

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <cstring>
#include <limits>

#include "support/tension_surfaces.hpp"
#include "thalweg/core/error.hpp"
#include "thalweg/core/parallel.hpp"
#include "thalweg/surface/heightfield.hpp"
#include "thalweg/surface/tension_spline.hpp"

using namespace thalweg;
using namespace thalweg::surface;
using namespace support;

namespace {

/// A surface with its network and patches.
struct Built {
    TensionSurface s;
    MinimumNormNetwork network = minimum_norm_network(s.mesh());
    std::vector<TensionPatch> patches = tension_patches(s.mesh(), network);

    SurfacePoint at(Index triangle, const Point& p) const { return surface_at(s.mesh(), patches, triangle, p); }
};

Built rough(std::uint64_t seed, Index count = 150) { return {rough_surface(random_star(9, seed), count, seed)}; }

Point operator-(const Point& a, const Point& b) { return {a.x - b.x, a.y - b.y}; }
double dot(const Point& a, const Point& b) { return a.x * b.x + a.y * b.y; }

/// The definition of the patch step by step in the plane, with whole heights and real gradients.
struct Definition {
    const Built& built;
    Index triangle;

    Point corner(int k) const { return built.s.vertex(vertex(k)); }
    Index vertex(int k) const { return built.s.triangles[triangle][k % 3]; }
    double height(int k) const { return built.s.height[vertex(k)]; }
    Point gradient(int k) const { return {built.network.slope_x[vertex(k)], built.network.slope_y[vertex(k)]}; }
    double tension_opposite(int k) const {
        return built.network.edge_tension[built.network.edges_of_triangle[triangle][k % 3]];
    }

    TensionCurve curve_of_side(int k) const {  // opposite to corner k, from corner k + 1
        const Point along = corner(k + 2) - corner(k + 1);
        const double length = std::hypot(along.x, along.y);
        return {length,
                height(k + 1),
                height(k + 2),
                dot(gradient(k + 1), along) / length,
                dot(gradient(k + 2), along) / length,
                tension_opposite(k)};
    }

    /// Height and gradient on the side opposite to corner k.
    SurfacePoint on_side(int k, double share) const {
        const TensionCurve curve = curve_of_side(k);
        const CurvePoint point = point_on(curve, share * curve.length);
        const Point side = corner(k + 2) - corner(k + 1);
        const Point u{side.x / curve.length, side.y / curve.length};
        const Point n{-u.y, u.x};
        const double across = (1 - share) * dot(gradient(k + 1), n) + share * dot(gradient(k + 2), n);
        return {point.height, point.slope * u.x + across * n.x, point.slope * u.y + across * n.y};
    }

    double from_corner(int k, const Point& p, const std::array<double, 3>& b) const {
        const double share = b[(k + 2) % 3] / (b[(k + 1) % 3] + b[(k + 2) % 3]);
        const Point start = corner(k + 1);
        const Point side = corner(k + 2) - start;
        const Point foot{start.x + share * side.x, start.y + share * side.y};
        const SurfacePoint end = on_side(k, share);
        const Point way = foot - corner(k);
        const double length = std::hypot(way.x, way.y);
        const TensionCurve curve{length,
                                 height(k),
                                 end.height,
                                 dot(gradient(k), way) / length,
                                 (end.slope_x * way.x + end.slope_y * way.y) / length,
                                 (1 - share) * tension_opposite(k + 2) + share * tension_opposite(k + 1)};
        const Point from = p - corner(k);
        return point_on(curve, std::hypot(from.x, from.y)).height;
    }

    double at(const std::array<double, 3>& b) const {
        const Point p = built.s.place(triangle, b[0], b[1], b[2]);
        const double sum = b[0] * b[1] + b[1] * b[2] + b[2] * b[0];
        double height_sum = 0;
        for (int k = 0; k < 3; ++k) height_sum += b[(k + 1) % 3] * b[(k + 2) % 3] / sum * from_corner(k, p, b);
        return height_sum;
    }
};

/// Barycentric coordinates all over a triangle, none on its sides.
std::vector<std::array<double, 3>> places_inside(int steps) {
    std::vector<std::array<double, 3>> places;
    for (int i = 1; i < steps; ++i) {
        for (int j = 1; i + j < steps; ++j) {
            places.push_back({double(i) / steps, double(j) / steps, double(steps - i - j) / steps});
        }
    }
    return places;
}

/// Calls visit(triangle, corner opposite, other triangle) for every edge between two triangles.
template <class Visit>
void visit_inner_edges(const Built& built, Visit visit) {
    std::vector<Index> first(built.network.edges.size(), none);
    for (Index t = 0; t < built.s.triangles.size(); ++t) {
        for (int k = 0; k < 3; ++k) {
            Index& other = first[built.network.edges_of_triangle[t][k]];
            if (other != none) visit(t, k, other);
            other = t;
        }
    }
}

/// A fan of sharp triangles from the origin to x = 100, y from 0 to 2; before them two without area on its lower side.
TensionSurface fan(int blades) {
    TensionSurface s{{0, 25, 50, 100}, {0, 0, 0, 0}, {}, {}, {{0, 1, 3}, {1, 2, 3}}, {}};
    for (int i = 1; i <= blades; ++i) {
        s.x.push_back(100);
        s.y.push_back(i * 2.0 / blades);
        s.triangles.push_back({0, Index(i + 2), Index(i + 3)});
    }
    for (std::size_t i = 0; i < s.x.size(); ++i) s.height.push_back(std::sin(0.1 * s.x[i]) + s.y[i]);
    s.tension.assign(s.x.size(), 2);
    return s;
}

}  // namespace

TEST_CASE("A patch is what its definition says, step by step") {
    for (std::uint64_t seed = 1; seed < 6; ++seed) {
        const Built built = rough(seed);
        for (Index t = 0; t < built.s.triangles.size(); ++t) {
            for (const auto& b : places_inside(7)) {
                const double expected = Definition{built, t}.at(b);
                const Point p = built.s.place(t, b[0], b[1], b[2]);
                REQUIRE(built.at(t, p).height == Approx(expected).epsilon(1e-12).margin(1e-12));
            }
        }
    }
}

TEST_CASE("The surface goes through every vertex to the last bit, with the network's gradient") {
    const Built built = rough(3);
    for (Index t = 0; t < built.s.triangles.size(); ++t) {
        for (const Index i : built.s.triangles[t]) {
            const SurfacePoint found = built.at(t, built.s.vertex(i));
            REQUIRE(found.height == built.s.height[i]);
            REQUIRE(found.slope_x == Approx(built.network.slope_x[i]).epsilon(1e-9).margin(1e-9));
            REQUIRE(found.slope_y == Approx(built.network.slope_y[i]).epsilon(1e-9).margin(1e-9));
        }
    }
}

TEST_CASE("The gradient tends to the vertex's from all directions") {
    const Built built = rough(4);
    for (Index t = 0; t < built.s.triangles.size(); ++t) {
        const Index i = built.s.triangles[t][0];
        for (const double turn : {0.02, 0.3, 0.7, 0.99}) {
            const double near = 1e-9;
            const Point p = built.s.place(t, 1 - near, near * turn, near * (1 - turn));
            const SurfacePoint found = built.at(t, p);
            const Point step = p - built.s.vertex(i);
            const double rise = built.network.slope_x[i] * step.x + built.network.slope_y[i] * step.y;
            REQUIRE(found.height - built.s.height[i] == Approx(rise).epsilon(1e-4).margin(1e-14));
            REQUIRE(found.slope_x == Approx(built.network.slope_x[i]).epsilon(1e-5).margin(1e-4));
            REQUIRE(found.slope_y == Approx(built.network.slope_y[i]).epsilon(1e-5).margin(1e-4));
        }
    }
}

TEST_CASE("Linear heights are reproduced, with their gradient, whatever the tension") {
    const auto plane = [](double x, double y) { return 3 + 2 * x - 5 * y; };
    for (const auto& [name, outline] : many_outlines()) {
        for (const double tension : {0.0, 1.0, 5.0, 50.0, -1.0}) {
            INFO(name << ", tension " << tension);
            TensionSurface s = surface_over(outline, 150, plane, tension);
            if (tension < 0) set_channel_and_ridge_tension(s);
            const Built built{s};
            for (Index t = 0; t < s.triangles.size(); ++t) {
                for (const auto& b : places_inside(4)) {
                    const Point p = s.place(t, b[0], b[1], b[2]);
                    const SurfacePoint found = built.at(t, p);
                    REQUIRE(std::abs(found.height - plane(p.x, p.y)) < 1e-12 * (10 + std::abs(plane(p.x, p.y))));
                    REQUIRE(std::abs(found.slope_x - 2) < 1e-9);
                    REQUIRE(std::abs(found.slope_y + 5) < 1e-9);
                }
            }
        }
    }
}

TEST_CASE("The gradient is that of difference quotients") {
    for (std::uint64_t seed = 1; seed < 4; ++seed) {
        const Built built = rough(seed, 60);
        for (Index t = 0; t < built.s.triangles.size(); ++t) {
            const Point side = built.s.place(t, 1, 0, 0) - built.s.place(t, 0, 1, 0);
            const double h = 1e-5 * std::hypot(side.x, side.y);
            for (const auto& b : places_inside(5)) {
                const Point p = built.s.place(t, b[0], b[1], b[2]);
                const SurfacePoint found = built.at(t, p);
                const double x = (built.at(t, {p.x + h, p.y}).height - built.at(t, {p.x - h, p.y}).height) / (2 * h);
                const double y = (built.at(t, {p.x, p.y + h}).height - built.at(t, {p.x, p.y - h}).height) / (2 * h);
                const double size = 1 + std::hypot(found.slope_x, found.slope_y);
                REQUIRE(std::abs(found.slope_x - x) < 1e-5 * size);
                REQUIRE(std::abs(found.slope_y - y) < 1e-5 * size);
            }
        }
    }
}

TEST_CASE("Across every edge value and gradient go on, by formula and by difference quotients") {
    for (std::uint64_t seed = 1; seed < 6; ++seed) {
        const Built built = rough(seed);
        int edges = 0;
        visit_inner_edges(built, [&](Index t, int k, Index other) {
            ++edges;
            const Definition sides{built, t};
            const Point along = sides.corner(k + 2) - sides.corner(k + 1);
            const double length = std::hypot(along.x, along.y);
            const Point across{along.y / length, -along.x / length};  // out of t
            for (const double share : {0.01, 0.2, 0.5, 0.77, 0.99}) {
                const Point p{sides.corner(k + 1).x + share * along.x, sides.corner(k + 1).y + share * along.y};
                const SurfacePoint here = built.at(t, p);
                const SurfacePoint there = built.at(other, p);
                const double size = 1 + std::hypot(here.slope_x, here.slope_y);
                REQUIRE(std::abs(here.height - there.height) < 1e-12 * size);
                REQUIRE(std::abs(here.slope_x - there.slope_x) < 1e-8 * size);
                REQUIRE(std::abs(here.slope_y - there.slope_y) < 1e-8 * size);
                const SurfacePoint expected = sides.on_side(k, share);
                REQUIRE(std::abs(here.height - expected.height) < 1e-11 * size);
                REQUIRE(std::abs(here.slope_x - expected.slope_x) < 1e-8 * size);
                REQUIRE(std::abs(here.slope_y - expected.slope_y) < 1e-8 * size);
                const double h = 1e-7 * length;
                const Point out{p.x + h * across.x, p.y + h * across.y};
                const Point in{p.x - h * across.x, p.y - h * across.y};
                const double slope = expected.slope_x * across.x + expected.slope_y * across.y;
                REQUIRE(std::abs((built.at(other, out).height - expected.height) / h - slope) < 2e-3 * size);
                REQUIRE(std::abs((expected.height - built.at(t, in).height) / h - slope) < 2e-3 * size);
            }
        });
        CHECK(edges > 200);
    }
}

TEST_CASE("With large tension the surface tends to the planes of the triangles") {
    for (const double tension : {1e3, 1e6, 1e12}) {
        TensionSurface s = rough_surface(l_shape(), 150, 2);
        s.tension.assign(s.tension.size(), tension);
        const Built built{s};
        for (Index t = 0; t < s.triangles.size(); ++t) {
            const auto& [i, j, k] = s.triangles[t];
            for (const auto& b : places_inside(5)) {
                const double plane = b[0] * s.height[i] + b[1] * s.height[j] + b[2] * s.height[k];
                const double found = built.at(t, s.place(t, b[0], b[1], b[2])).height;
                REQUIRE(std::abs(found - plane) < 20 / tension + 1e-13);
            }
        }
    }
}

TEST_CASE("A raster holds what single points give, to the last bit, where linear interpolation has values") {
    for (const auto& [name, outline] : many_outlines()) {
        INFO(name);
        const Mesh mesh = mesh::triangulate(outline, mesh::poisson_disk_count(outline, 200, 1));
        const Built built{rough_surface(outline, 200, 1)};
        REQUIRE(built.s.x == mesh.x);
        Raster raster = covering_raster(mesh, 120);
        Raster linear = raster;
        interpolate_linear(mesh, built.s.height, linear);
        evaluate(built.s.mesh(), built.patches, raster);
        std::vector<Point> centers;
        for (Index cell = 0; cell < raster.grid.size(); ++cell) {
            centers.push_back(raster.placement.center(raster.grid.row(cell), raster.grid.col(cell)));
        }
        const std::vector<SurfacePoint> points = surface_at(built.s.mesh(), built.patches, centers);
        for (Index cell = 0; cell < raster.grid.size(); ++cell) {
            REQUIRE(std::isnan(raster.values[cell]) == std::isnan(linear.values[cell]));
            REQUIRE(std::isnan(raster.values[cell]) == std::isnan(points[cell].height));
            if (!std::isnan(raster.values[cell])) REQUIRE(raster.values[cell] == points[cell].height);
        }
    }
}

TEST_CASE("Many points are found in the triangles that a search over all of them finds") {
    for (std::uint64_t seed = 1; seed < 5; ++seed) {
        const Built built = rough(seed, 80);
        Random random(seed, 8);
        std::vector<Point> points;
        for (int i = 0; i < 3000; ++i) points.push_back({2.2 * random.uniform() - 1.1, 2.2 * random.uniform() - 1.1});
        for (Index i = 0; i < built.s.x.size(); ++i) points.push_back(built.s.vertex(i));
        points.push_back({1e300, -1e300});
        points.push_back({std::numeric_limits<double>::quiet_NaN(), 0});
        const std::vector<SurfacePoint> found = surface_at(built.s.mesh(), built.patches, points);
        for (std::size_t i = 0; i < points.size(); ++i) {
            Index holder = none;
            for (Index t = 0; t < built.s.triangles.size() && holder == none; ++t) {
                bool inside = true;
                for (int k = 0; k < 3; ++k) {
                    const Point a = built.s.vertex(built.s.triangles[t][k]);
                    const Point b = built.s.vertex(built.s.triangles[t][(k + 1) % 3]);
                    inside &= (b.x - a.x) * (points[i].y - a.y) - (b.y - a.y) * (points[i].x - a.x) >= 0;
                }
                if (inside) holder = t;
            }
            REQUIRE(std::isnan(found[i].height) == (holder == none));
            if (holder == none) continue;
            REQUIRE(found[i].height == Approx(built.at(holder, points[i]).height).epsilon(1e-12).margin(1e-12));
        }
    }
}

TEST_CASE("A cell whose centre is a vertex has its height to the last bit") {
    TensionSurface s = rough_surface(l_shape(), 200, 7);
    for (Index i = 0; i < s.x.size(); ++i) s.height[i] = std::pow(-1.7, i % 40) + i / 3.0;
    const Built built{s};
    for (Index i = 0; i < s.x.size(); ++i) {
        if (s.x[i] == 0 || s.y[i] == 0) continue;
        Raster spot;  // one cell from the origin to twice the vertex's place
        spot.grid = plane_grid(1, 1, 2 * s.x[i], 2 * s.y[i]);
        spot.placement.north = spot.placement.cell_height = 2 * s.y[i];
        spot.placement.cell_width = 2 * s.x[i];
        evaluate(s.mesh(), built.patches, spot);
        REQUIRE(spot.values[0] == s.height[i]);
    }
}

TEST_CASE("Slivers and triangles without area leave no holes and no numbers out of range") {
    const Built built{fan(200)};
    Raster raster;  // centres on whole x, and on the lower side
    raster.grid = plane_grid(36, 104, 1, 0.0625);
    raster.placement = {.west = -1.5, .north = 2.09375, .cell_width = 1, .cell_height = 0.0625, .crs_wkt = {}};
    evaluate(built.s.mesh(), built.patches, raster);
    int inside = 0;
    for (Index cell = 0; cell < raster.grid.size(); ++cell) {
        const Point p = raster.placement.center(raster.grid.row(cell), raster.grid.col(cell));
        const double below_upper = 0.02 * p.x - p.y;
        INFO(p.x << ", " << p.y);
        if (p.y < 0 || p.x > 100 || below_upper < -1e-9) REQUIRE(std::isnan(raster.values[cell]));
        if (p.y < 0 || p.x > 100 || below_upper < 1e-9) continue;
        REQUIRE(std::abs(raster.values[cell]) < 4);
        ++inside;
    }
    CHECK(inside > 1500);
    CHECK(std::isnan(built.at(0, {25, 0}).height));
}

TEST_CASE("A surface of hills is nearer to them than its triangles are") {
    const auto hills = [](double x, double y) { return std::sin(3 * x) * std::cos(4 * y) + 0.3 * x * y; };
    const Built built{surface_over(rectangle(2, 2), 400, hills, 0)};
    double smooth = 0;
    double flat = 0;
    for (Index t = 0; t < built.s.triangles.size(); ++t) {
        const Point p = built.s.place(t, 1 / 3.0, 1 / 3.0, 1 / 3.0);
        if (std::min({p.x, p.y, 2 - p.x, 2 - p.y}) < 0.2) continue;
        const auto& [i, j, k] = built.s.triangles[t];
        smooth += std::abs(built.at(t, p).height - hills(p.x, p.y));
        flat += std::abs((built.s.height[i] + built.s.height[j] + built.s.height[k]) / 3 - hills(p.x, p.y));
    }
    CHECK(smooth < flat / 8);
}

TEST_CASE("A surface evaluated by one thread and by two has the same bytes") {
    const Built built = rough(2, 5000);
    const auto run = [&](int threads) {
        const ThreadLimit limit(threads);
        Raster raster;
        raster.grid = plane_grid(500, 500, 0.004, 0.004);
        raster.placement = {.west = -1, .north = 1, .cell_width = 0.004, .cell_height = 0.004, .crs_wkt = {}};
        evaluate(built.s.mesh(), built.patches, raster);
        return raster.values;
    };
    const auto one = run(1);
    const auto two = run(2);
    CHECK(std::memcmp(one.data(), two.data(), one.size() * sizeof(double)) == 0);
}

TEST_CASE("Clockwise triangles and strange networks are refused") {
    Built built = rough(1, 50);
    TensionSurface turned = built.s;
    std::swap(turned.triangles[3][0], turned.triangles[3][1]);
    CHECK_THROWS_AS(tension_patches(turned.mesh(), minimum_norm_network(turned.mesh())), Error);
    CHECK_THROWS_AS(tension_patches(built.s.mesh(), rough(1, 60).network), Error);
    Raster raster;
    raster.grid = plane_grid(2, 2, 1, 1);
    built.patches.pop_back();
    CHECK_THROWS_AS(evaluate(built.s.mesh(), built.patches, raster), Error);
    CHECK_THROWS_AS(surface_at(built.s.mesh(), built.patches, std::vector<Point>(1)), Error);
}
