// SPDX-License-Identifier: GPL-3.0-or-later
#include "thalweg/mesh/points.hpp"

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <limits>

#include "support/outlines.hpp"
#include "thalweg/core/error.hpp"
#include "thalweg/core/random.hpp"
#include "thalweg/mesh/triangulate.hpp"

using namespace thalweg;
using namespace thalweg::mesh;
using namespace support;

namespace {

double spacing_for(const Polygon& outline, double count) { return std::sqrt(0.7 * polygon_area(outline) / count); }

double nearest_distance(const PointSet& set, const Point& place) {
    double nearest = std::numeric_limits<double>::infinity();
    for (const Point& p : set.points) nearest = std::min(nearest, distance(p, place));
    return nearest;
}

/// Distance of a place from the segment a–b.
double distance_to_side(const Point& a, const Point& b, const Point& p) {
    const double square = (b.x - a.x) * (b.x - a.x) + (b.y - a.y) * (b.y - a.y);
    const double at = std::clamp(((p.x - a.x) * (b.x - a.x) + (p.y - a.y) * (b.y - a.y)) / square, 0.0, 1.0);
    return distance(p, {a.x + at * (b.x - a.x), a.y + at * (b.y - a.y)});
}

}  // namespace

TEST_CASE("Points inside keep the spacing from each other and from the outline's points") {
    for (const auto& [name, outline] : many_outlines()) {
        INFO(name);
        const double spacing = spacing_for(outline, 600);
        const PointSet set = poisson_disk(outline, spacing, 5);
        double closest = std::numeric_limits<double>::infinity();
        for (std::size_t i = set.outline_count; i < set.points.size(); ++i) {
            for (std::size_t j = 0; j < i; ++j) closest = std::min(closest, distance(set.points[i], set.points[j]));
        }
        CHECK(closest >= spacing * (1 - 1e-12));
    }
}

TEST_CASE("All points lie inside the outline or on it") {
    for (const auto& [name, outline] : many_outlines()) {
        INFO(name);
        const PointSet set = poisson_disk(outline, spacing_for(outline, 600), 6);
        for (std::size_t i = set.outline_count; i < set.points.size(); ++i) REQUIRE(is_inside(outline, set.points[i]));
        for (std::size_t i = 0; i < set.outline_count; ++i) {
            double nearest = std::numeric_limits<double>::infinity();
            for (std::size_t k = 0; k < outline.size(); ++k) {
                const Point& next = outline[(k + 1) % outline.size()];
                nearest = std::min(nearest, distance_to_side(outline[k], next, set.points[i]));
            }
            REQUIRE(nearest < 1e-12);
        }
    }
}

TEST_CASE("There is no room for another point") {
    for (const auto& [name, outline] : many_outlines()) {
        INFO(name);
        const double spacing = spacing_for(outline, 600);
        const PointSet set = poisson_disk(outline, spacing, 7);
        const auto [west, east] = std::minmax_element(outline.begin(), outline.end(),
                                                      [](const Point& a, const Point& b) { return a.x < b.x; });
        const auto [south, north] = std::minmax_element(outline.begin(), outline.end(),
                                                        [](const Point& a, const Point& b) { return a.y < b.y; });
        Random random(8, 8);
        double widest_gap = 0;
        for (int probe = 0; probe < 20000; ++probe) {
            const Point place{west->x + random.uniform() * (east->x - west->x),
                              south->y + random.uniform() * (north->y - south->y)};
            if (is_inside(outline, place)) widest_gap = std::max(widest_gap, nearest_distance(set, place));
        }
        CHECK(widest_gap < spacing);
        CHECK(widest_gap > 0.7 * spacing);  // the probes have looked where it matters
    }
}

TEST_CASE("The outline's points go round it, hold its corners and leave no gap wider than the spacing") {
    for (const auto& [name, outline] : many_outlines()) {
        INFO(name);
        const double spacing = spacing_for(outline, 300);
        const PointSet set = poisson_disk(outline, spacing, 1);
        const Polygon ring(set.points.begin(), set.points.begin() + set.outline_count);
        CHECK(polygon_area(ring) == Approx(polygon_area(outline)).epsilon(1e-12));
        for (std::size_t i = 0; i < ring.size(); ++i) {
            REQUIRE(distance(ring[i], ring[(i + 1) % ring.size()]) <= spacing * (1 + 1e-8));
        }
        for (const Point& corner : outline) REQUIRE(std::find(ring.begin(), ring.end(), corner) != ring.end());
    }
}

TEST_CASE("No point lies in the diametral disc of an outline edge, so that triangulating adds none") {
    for (const auto& [name, outline] : many_outlines()) {
        for (double count : {20.0, 200.0, 2000.0}) {
            INFO(name << " " << count);
            const PointSet set = poisson_disk(outline, spacing_for(outline, count), 2);
            CHECK(triangulate(outline, set).size() == set.points.size());
        }
    }
}

TEST_CASE("A wanted count is met within 2 %") {
    for (const auto& [name, outline] : many_outlines()) {
        for (Index count : {150u, 400u, 1000u, 7000u, 30000u}) {
            for (std::uint64_t seed = 0; seed < (count < 2000 ? 8 : 2); ++seed) {
                INFO(name << " " << count << " seed " << seed);
                const double got = static_cast<double>(poisson_disk_count(outline, count, seed).points.size());
                CHECK(std::abs(got - count) <= 0.02 * count);
            }
        }
    }
}

TEST_CASE("A small count is met exactly in plain outlines, and within one where the outline allows only even numbers") {
    for (Index count = 16; count < 50; ++count) {
        INFO(count);
        CHECK(poisson_disk_count(rectangle(1000, 1000), count, 3).points.size() == count);
        const double in_strip = static_cast<double>(poisson_disk_count(rectangle(100, 1), count, 3).points.size());
        CHECK(std::abs(in_strip - count) <= 1);
    }
}

TEST_CASE("The same seed gives the same points and another seed others") {
    const Polygon outline = random_star(9, 4);
    const PointSet first = poisson_disk(outline, 0.02, 1);
    const PointSet again = poisson_disk(outline, 0.02, 1);
    const PointSet other = poisson_disk(outline, 0.02, 2);
    CHECK(first.points == again.points);
    CHECK(first.points.back() != other.points.back());
}

TEST_CASE("Either orientation of the outline gives the same points inside") {
    Polygon clockwise = l_shape();
    std::reverse(clockwise.begin(), clockwise.end());
    const PointSet set = poisson_disk(clockwise, 0.1, 1);
    CHECK(polygon_area(Polygon(set.points.begin(), set.points.begin() + set.outline_count)) == Approx(3));
    CHECK(polygon_area(clockwise) == Approx(-3));
}

TEST_CASE("Far from the origin, in map coordinates, the points are as good") {
    Polygon outline = random_star(11, 5);
    for (Point& p : outline) p = {500000 + 30000 * p.x, 5400000 + 30000 * p.y};
    const PointSet set = poisson_disk_count(outline, 2000, 1);
    CHECK(std::abs(static_cast<double>(set.points.size()) - 2000) <= 40);
    CHECK(triangulate(outline, set).size() == set.points.size());
}

TEST_CASE("Outlines that are no simple polygons are refused") {
    const auto refuses = [](const Polygon& outline) { CHECK_THROWS_AS(poisson_disk(outline, 0.1, 1), Error); };
    refuses({});
    refuses({{0, 0}, {1, 0}});
    refuses({{0, 0}, {1, 0}, {2, 0}});
    refuses({{0, 0}, {1, 1}, {1, 0}, {0, 1}});           // a bow tie, no area
    refuses({{0, 0}, {3, 0}, {3, 3}, {1, -1}, {0, 3}});  // a side through another
    refuses({{0, 0}, {1, 0}, {1, 1}, {1, 0}, {0, 1}});   // a corner twice
    refuses({{0, 0}, {2, 0}, {2, 2}, {1, 0}, {0, 2}});   // a corner that touches a side
    refuses({{0, 0}, {std::nan(""), 0}, {1, 1}});
}

TEST_CASE("Spacings and counts that make no sense are refused") {
    for (double spacing : {0.0, -1.0, std::nan(""), std::numeric_limits<double>::infinity(), 1e-9}) {
        CHECK_THROWS_AS(poisson_disk(rectangle(1, 1), spacing, 1), Error);
    }
    CHECK_THROWS_AS(poisson_disk_count(rectangle(1, 1), 15, 1), Error);
    CHECK_THROWS_AS(poisson_disk_count(rectangle(1, 1), (1u << 31) + 1, 1), Error);
    CHECK_THROWS_WITH(poisson_disk_count(staircase(50), 60, 1), Catch::Contains("corners"));
}
