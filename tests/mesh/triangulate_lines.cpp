// SPDX-License-Identifier: GPL-3.0-or-later
#include "thalweg/mesh/triangulate_lines.hpp"

#include <catch2/catch.hpp>
#include <set>

#include "thalweg/core/error.hpp"
#include "thalweg/core/random.hpp"
#include "thalweg/mesh/predicates.hpp"
#include "thalweg/mesh/triangulate.hpp"

using namespace thalweg;
using namespace thalweg::mesh;

namespace {

using Lines = std::vector<std::array<Index, 2>>;

const std::vector<Point> square{{0, 0}, {2, 0}, {2, 2}, {0, 2}};
const Lines sides{{0, 1}, {1, 2}, {2, 3}, {3, 0}};

std::set<std::pair<Index, Index>> edges_of(const std::vector<std::array<Index, 3>>& triangles) {
    std::set<std::pair<Index, Index>> edges;
    for (const auto& t : triangles) {
        for (int k = 0; k < 3; ++k) edges.insert(std::minmax(t[k], t[(k + 1) % 3]));
    }
    return edges;
}

double area_of(const std::vector<Point>& points, const std::vector<std::array<Index, 3>>& triangles) {
    double area = 0;
    for (const auto& [a, b, c] : triangles) area += polygon_area({points[a], points[b], points[c]});
    return area;
}

}  // namespace

TEST_CASE("A diagonal that is asked for is an edge, whichever of the two") {
    for (const Index from : {0, 1}) {
        Lines lines = sides;
        lines.push_back({from, from + 2});
        const auto triangles = triangulate_lines(square, lines);
        CHECK(triangles.size() == 2);
        CHECK(edges_of(triangles).count({from, from + 2}) == 1);
    }
}

TEST_CASE("Only what lines enclose is triangulated") {
    // An L: the square without its upper right quarter, whose corner is left out with the triangle beside it.
    const std::vector<Point> corners{{0, 0}, {2, 0}, {2, 1}, {1, 1}, {1, 2}, {0, 2}, {1.9, 1.9}};
    const auto triangles = triangulate_lines(corners, Lines{{0, 1}, {1, 2}, {2, 3}, {3, 4}, {4, 5}, {5, 0}});
    CHECK(triangles.size() == 4);
    CHECK(area_of(corners, triangles) == Approx(3));
    CHECK(triangulate_lines(square, Lines{{0, 1}, {1, 2}, {2, 3}}).empty());
}

TEST_CASE("Random points in a frame: all lines are edges, triangles run counter-clockwise and fill the frame") {
    for (std::uint64_t seed = 0; seed < 20; ++seed) {
        Random random(seed, 1);
        std::vector<Point> points = square;
        Lines lines = sides;
        // A zigzag from left to right, which cannot cross itself.
        for (Index i = 0; i < 40; ++i) {
            points.push_back({(i + random.uniform()) / 20, 0.1 + 1.8 * random.uniform()});
            if (i > 0) lines.push_back({i + 3, i + 4});
        }
        const auto triangles = triangulate_lines(points, lines);
        CHECK(triangles.size() == 2 * points.size() - 2 - 4);  // Euler: n points, four of them on the hull
        CHECK(area_of(points, triangles) == Approx(4).epsilon(1e-12));
        const auto edges = edges_of(triangles);
        for (const auto& [a, b] : lines) REQUIRE(edges.count(std::minmax(a, b)) == 1);
        for (const auto& [a, b, c] : triangles) REQUIRE(orientation(points[a], points[b], points[c]) == 1);
    }
}

TEST_CASE("What cannot be triangulated is refused") {
    Lines crossing = sides;
    crossing.push_back({0, 2});
    crossing.push_back({1, 3});
    CHECK_THROWS_WITH(triangulate_lines(square, crossing), Catch::Contains("crosses another"));
    CHECK_THROWS_WITH(triangulate_lines(square, Lines{{0, 4}}), Catch::Contains("needs two"));
    CHECK_THROWS_WITH(triangulate_lines(square, Lines{{1, 1}}), Catch::Contains("needs two"));
    CHECK_THROWS_WITH(triangulate_lines(std::vector<Point>{{0, 0}, {1, 1}, {0, 0}}, {}), Catch::Contains("same place"));
    CHECK_THROWS_WITH(triangulate_lines(std::vector<Point>{{0, 0}, {1, 1}, {2, 2}}, {}), Catch::Contains("one line"));
}
