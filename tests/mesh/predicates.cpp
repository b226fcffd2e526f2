// SPDX-License-Identifier: GPL-3.0-or-later
#include "thalweg/mesh/predicates.hpp"

#include <catch2/catch.hpp>
#include <cmath>

#include "support/outlines.hpp"
#include "thalweg/core/error.hpp"

using namespace thalweg;
using namespace thalweg::mesh;

TEST_CASE("Orientation is exact where the determinant in doubles is lost to rounding") {
    const Point a{0.5, 0.5};
    const Point b{12, 12};
    const Point c{24, 24};
    for (int step = -3; step <= 3; ++step) {  // a moves by one unit in the last place up or down at a time
        Point moved = a;
        for (int i = 0; i < std::abs(step); ++i) moved.y = std::nextafter(moved.y, step > 0 ? 1 : 0);
        CHECK(orientation(b, c, moved) == (step > 0) - (step < 0));
    }
}

TEST_CASE("Segments cross only in a point inside both") {
    const Point origin{0, 0};
    CHECK(segments_cross({-1, 0}, {1, 0}, {0, -1}, {0, 1}));
    CHECK_FALSE(segments_cross({-1, 0}, {1, 0}, origin, {0, 1}));
    CHECK_FALSE(segments_cross({-1, 0}, {1, 0}, {0, 1e-300}, {0, 1}));
    CHECK_FALSE(segments_cross({-1, 0}, {1, 0}, {0, 0}, {2, 0}));
    CHECK_FALSE(segments_cross({-1, 0}, {1, 0}, {3, -1}, {3, 1}));
}

TEST_CASE("A polygon is returned counter-clockwise, and one that touches itself is refused") {
    const Polygon clockwise{{0, 0}, {0, 1}, {1, 1}, {1, 0}};
    CHECK(simple_polygon(clockwise).front() == clockwise.back());
    CHECK(is_simple(support::l_shape()));
    const Polygon bow{{0, 0}, {1, 1}, {1, 0}, {0, 1}};
    CHECK_FALSE(is_simple(bow));
    const Polygon touching{{0, 0}, {2, 0}, {2, 2}, {1, 0}, {0, 2}};
    CHECK_FALSE(is_simple(touching));
    CHECK_THROWS_AS(simple_polygon(touching), Error);
}
