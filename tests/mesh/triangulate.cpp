// SPDX-License-Identifier: GPL-3.0-or-later
#include "thalweg/mesh/triangulate.hpp"

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <numeric>

#include "support/outlines.hpp"
#include "thalweg/core/error.hpp"
#include "thalweg/core/random.hpp"

using namespace thalweg;
using namespace thalweg::mesh;
using namespace support;

namespace {

Point node_at(const Mesh& mesh, Index node) { return {mesh.x[node], mesh.y[node]}; }

double cross(const Point& a, const Point& b, const Point& c) {
    return (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
}

double sum_of_cells(const Mesh& mesh) { return std::accumulate(mesh.cell_area.begin(), mesh.cell_area.end(), 0.0); }

/// What lies of a polygon on the side of `near` of the bisector between two points. Of a concave polygon the result may
/// run back along itself, which its signed area forgives.
Polygon nearer_part(const Polygon& polygon, const Point& near, const Point& far) {
    const Point middle{(near.x + far.x) / 2, (near.y + far.y) / 2};
    const auto beyond = [&](const Point& p) {
        return (p.x - middle.x) * (far.x - near.x) + (p.y - middle.y) * (far.y - near.y);
    };
    Polygon part;
    for (std::size_t i = 0; i < polygon.size(); ++i) {
        const Point& a = polygon[i];
        const Point& b = polygon[(i + 1) % polygon.size()];
        const double from = beyond(a);
        const double to = beyond(b);
        if (from <= 0) part.push_back(a);
        if ((from < 0 && to > 0) || (from > 0 && to < 0)) {
            const double at = from / (from - to);
            part.push_back({a.x + at * (b.x - a.x), a.y + at * (b.y - a.y)});
        }
    }
    return part;
}

/// The Voronoi cell from its definition: the domain clipped by the bisectors with all other points.
double clipped_cell(const Mesh& mesh, Index node) {
    Polygon cell = mesh.outline;
    for (Index other = 0; other < mesh.size(); ++other) {
        if (other != node) cell = nearer_part(cell, node_at(mesh, node), node_at(mesh, other));
    }
    return polygon_area(cell);
}

/// Points scattered without any distance kept: sharp triangles, and points in the outline's diametral discs.
PointSet careless_points(const Polygon& outline, int count, std::uint64_t seed) {
    PointSet set{.points = outline, .outline_count = static_cast<Index>(outline.size())};
    Random random(seed, 3);
    while (static_cast<int>(set.points.size()) < count) {
        const Point p{6 * random.uniform() - 3, 6 * random.uniform() - 3};
        if (is_inside(outline, p)) set.points.push_back(p);
    }
    return set;
}

PointSet regular_points(Index side) {
    PointSet set;
    const auto last = static_cast<double>(side - 1);
    for (double i = 0; i < last; ++i) set.points.push_back({i, 0});
    for (double i = 0; i < last; ++i) set.points.push_back({last, i});
    for (double i = last; i > 0; --i) set.points.push_back({i, last});
    for (double i = last; i > 0; --i) set.points.push_back({0, i});
    set.outline_count = static_cast<Index>(set.points.size());
    for (double i = 1; i < last; ++i) {
        for (double j = 1; j < last; ++j) set.points.push_back({i, j});
    }
    return set;
}

}  // namespace

TEST_CASE("A hexagon with a point in its middle is cut in six equilateral triangles") {
    PointSet set;
    for (int i = 0; i < 6; ++i) set.points.push_back({std::cos(i * std::acos(0.5)), std::sin(i * std::acos(0.5))});
    const Polygon hexagon = set.points;
    set.points.push_back({0, 0});
    set.outline_count = 6;
    const Mesh mesh = triangulate(hexagon, set);
    REQUIRE(mesh.size() == 7);
    CHECK(mesh.triangles.size() == 6);
    CHECK(mesh.neighbor_list.size() == 24);
    for (Index node = 0; node < 7; ++node) {
        const bool middle = node_at(mesh, node) == Point{0, 0};
        CHECK(mesh.on_outline[node] == (middle ? 0 : 1));
        CHECK(mesh.offset[node + 1] - mesh.offset[node] == (middle ? 6 : 3));
        CHECK(mesh.cell_area[node] == Approx(middle ? std::sqrt(0.75) : std::sqrt(1.0 / 12)));
        mesh.neighbors(node, [](Index, double length, Slot) { CHECK(length == Approx(1)); });
    }
}

TEST_CASE("No node lies inside the circle of a triangle") {
    for (const auto& [name, outline] : many_outlines()) {
        INFO(name);
        const Mesh mesh = triangulate(outline, poisson_disk_count(outline, 300, 1));
        for (const auto& [i, j, k] : mesh.triangles) {
            const Point a = node_at(mesh, i), b = node_at(mesh, j), c = node_at(mesh, k);
            const double twice = cross(a, b, c);
            REQUIRE(twice > 0);
            const double ab = std::pow(distance(a, b), 2), ac = std::pow(distance(a, c), 2);
            const Point center{a.x + (ab * (c.y - a.y) - ac * (b.y - a.y)) / (2 * twice),
                               a.y + (ac * (b.x - a.x) - ab * (c.x - a.x)) / (2 * twice)};
            const double radius = distance(center, a);
            for (Index node = 0; node < mesh.size(); ++node) {
                REQUIRE(distance(center, node_at(mesh, node)) >= radius * (1 - 1e-9));
            }
        }
    }
}

TEST_CASE("The cells are those of the bisectors, clipped to the domain, concave or not") {
    for (const auto& [name, outline] : many_outlines()) {
        INFO(name);
        const Mesh mesh = triangulate(outline, poisson_disk_count(outline, 200, 4));
        const double tolerance = 1e-9 * polygon_area(outline) / mesh.size();
        for (Index node = 0; node < mesh.size(); ++node) {
            REQUIRE(std::abs(mesh.cell_area[node] - clipped_cell(mesh, node)) <= tolerance);
        }
    }
}

TEST_CASE("Careless points give true cells too, with points added on the outline") {
    for (std::uint64_t seed = 0; seed < 20; ++seed) {
        const Polygon outline = seed % 2 ? random_star(8, seed) : random_convex(6, seed);
        const PointSet set = careless_points(outline, 60, seed);
        const Mesh mesh = triangulate(outline, set);
        CHECK(mesh.size() > set.points.size());
        CHECK(std::count(mesh.on_outline.begin(), mesh.on_outline.end(), 1) ==
              static_cast<std::ptrdiff_t>(mesh.size() - set.points.size() + set.outline_count));
        for (Index node = 0; node < mesh.size(); ++node) {
            REQUIRE(std::abs(mesh.cell_area[node] - clipped_cell(mesh, node)) <= 1e-9 * polygon_area(outline));
        }
    }
}

TEST_CASE("The cells of hundreds of outlines, concave and with acute corners, add up to the domain") {
    for (std::uint64_t seed = 0; seed < 300; ++seed) {
        INFO(seed);
        const Polygon outline = random_star(5 + static_cast<int>(seed % 40), seed);
        const Mesh mesh = triangulate(outline, poisson_disk(outline, 0.07, seed));
        CHECK(std::abs(sum_of_cells(mesh) - polygon_area(outline)) <= 1e-9 * polygon_area(outline));
        CHECK(*std::min_element(mesh.cell_area.begin(), mesh.cell_area.end()) > 0);
    }
}

TEST_CASE("Vertices, edges and triangles obey Euler's formula") {
    for (const auto& [name, outline] : many_outlines()) {
        INFO(name);
        const Mesh mesh = triangulate(outline, poisson_disk_count(outline, 2000, 2));
        const auto edges = static_cast<std::int64_t>(mesh.neighbor_list.size() / 2);
        CHECK(mesh.size() - edges + static_cast<std::int64_t>(mesh.triangles.size()) == 1);
        CHECK(std::count(mesh.on_outline.begin(), mesh.on_outline.end(), 1) ==
              2 * edges - 3 * static_cast<std::int64_t>(mesh.triangles.size()));
    }
}

TEST_CASE("Neighbours ascend, know each other and agree on their distance to the last bit") {
    const Mesh mesh = triangulate(random_star(20, 3), poisson_disk_count(random_star(20, 3), 3000, 2));
    for (Index node = 0; node < mesh.size(); ++node) {
        Index before = none;
        mesh.neighbors(node, [&](Index other, double length, Slot slot) {
            REQUIRE((before == none || before < other));
            before = other;
            const Slot back = mesh.reverse(node, slot);
            REQUIRE(mesh.neighbor(other, back) == node);
            REQUIRE(mesh.length(other, back) == length);
            REQUIRE(length == Approx(distance(node_at(mesh, node), node_at(mesh, other))).epsilon(1e-14));
        });
    }
}

TEST_CASE("No edge crosses the notch of a concave outline") {
    const Mesh mesh = triangulate(l_shape(), poisson_disk(l_shape(), 0.13, 2));
    for (Index node = 0; node < mesh.size(); ++node) {
        mesh.neighbors(node, [&](Index other, double, Slot) {
            const Point a = node_at(mesh, node), b = node_at(mesh, other);
            const Point middle{(a.x + b.x) / 2, (a.y + b.y) / 2};
            REQUIRE_FALSE((middle.x > 1 && middle.y > 1));
        });
    }
}

TEST_CASE("A regular grid, where four points share every circle, has unit cells") {
    const Index side = 40;
    const Mesh mesh = triangulate(rectangle(side - 1, side - 1), regular_points(side));
    REQUIRE(mesh.size() == side * side);
    CHECK(mesh.triangles.size() == 2 * (side - 1) * (side - 1));
    for (Index node = 0; node < mesh.size(); ++node) {
        const auto on_rim = [](double at) { return at == 0 || at == side - 1; };
        const double expected = (on_rim(mesh.x[node]) ? 0.5 : 1) * (on_rim(mesh.y[node]) ? 0.5 : 1);
        REQUIRE(mesh.cell_area[node] == Approx(expected).epsilon(1e-12));
    }
}

TEST_CASE("Neighbours in space are neighbours in memory") {
    const Mesh mesh = triangulate(rectangle(1, 1), poisson_disk_count(rectangle(1, 1), 40000, 1));
    double near = 0, sum = 0;
    for (Index node = 0; node < mesh.size(); ++node) {
        mesh.neighbors(node, [&](Index other, double, Slot) {
            const double gap = std::abs(static_cast<double>(other) - node);
            near += gap < 64;
            sum += gap;
        });
    }
    const auto edges = static_cast<double>(mesh.neighbor_list.size());
    CHECK(near / edges > 0.8);                // numbered by rows it would be a third
    CHECK(sum / edges < 0.02 * mesh.size());  // at random it would be a third of the size
}

TEST_CASE("The same points give the same mesh, and triangles are listed by their lowest node") {
    const PointSet set = poisson_disk_count(l_shape(), 3000, 9);
    const Mesh one = triangulate(l_shape(), set);
    const Mesh two = triangulate(l_shape(), set);
    CHECK(one.x == two.x);
    CHECK(one.cell_area == two.cell_area);
    CHECK(one.neighbor_list == two.neighbor_list);
    CHECK(one.triangles == two.triangles);
    CHECK(std::is_sorted(one.triangles.begin(), one.triangles.end()));
    for (const auto& t : one.triangles) REQUIRE((t[0] < t[1] && t[0] < t[2]));
}

TEST_CASE("A clockwise outline is turned round") {
    Polygon clockwise = l_shape();
    std::reverse(clockwise.begin(), clockwise.end());
    const Mesh mesh = triangulate(clockwise, poisson_disk(clockwise, 0.2, 1));
    CHECK(polygon_area(mesh.outline) == Approx(3));
    CHECK(sum_of_cells(mesh) == Approx(3).epsilon(1e-12));
}

TEST_CASE("Points that do not fit the outline are refused") {
    const Polygon square = rectangle(2, 2);
    const auto refuses = [&](std::vector<Point> points, Index on_outline) {
        CHECK_THROWS_AS(triangulate(square, {.points = std::move(points), .outline_count = on_outline}), Error);
    };
    refuses({{0, 0}, {2, 0}, {2, 2}, {0, 2}, {1, 1}, {1, 1}}, 4);  // twice the same
    refuses({{0, 0}, {2, 0}, {2, 2}, {0, 2}, {3, 1}}, 4);          // outside
    refuses({{0, 0}, {2, 2}, {2, 0}, {0, 2}}, 4);                  // not in order
    refuses({{0, 0}, {2, 0}, {1, 1.5}, {2, 2}, {0, 2}}, 5);        // the ring is not the outline
    refuses({{0, 0}, {2, 0}}, 2);
    refuses({}, 0);
    refuses({{0, 0}, {1, 0}, {2, 0}}, 3);  // all on one line
    refuses({{0, 0}, {2, 0}, {2, 2}, {0, 2}}, 5);
}

TEST_CASE("The area of a polygon is positive counter-clockwise, exact far from the origin") {
    CHECK(polygon_area({{0, 0}, {4, 0}, {0, 3}}) == 6);
    CHECK(polygon_area({{0, 0}, {0, 3}, {4, 0}}) == -6);
    CHECK(polygon_area({{5e6, 4e7}, {5e6 + 1, 4e7}, {5e6 + 1, 4e7 + 1}, {5e6, 4e7 + 1}}) == 1);
}
