// SPDX-License-Identifier: GPL-3.0-or-later
#include "thalweg/mesh/predicates.hpp"

#include <algorithm>
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

TEST_CASE("Corners that repeat the one before are left out, however often and also where the ring closes") {
    const Polygon repeating{{0, 0}, {0, 0}, {1, 0}, {1, 1}, {1, 1}, {1, 1}, {0, 1}, {0, 0}, {0, 0}};
    CHECK(simple_polygon(repeating) == Polygon{{0, 0}, {1, 0}, {1, 1}, {0, 1}});
    CHECK_THROWS_WITH(simple_polygon({{0, 0}, {1, 0}, {1, 0}, {0, 0}}), Catch::Contains("not 2"));
    CHECK_THROWS_WITH(simple_polygon({}), Catch::Contains("not 0"));
}

TEST_CASE("A ring that meets itself is told where, one without area that it has none") {
    const auto refused = [](const Polygon& ring, const char* what) {
        for (std::size_t turn = 0; turn < ring.size(); ++turn) {  // wherever the ring begins
            Polygon turned = ring;
            std::rotate(turned.begin(), turned.begin() + static_cast<std::ptrdiff_t>(turn), turned.end());
            CHECK_THROWS_WITH(simple_polygon(turned), Catch::Contains(what));
        }
    };
    refused({{0, 0}, {2, 2}, {2, 0}, {0, 2}}, "itself at (1, 1)");  // a bow tie, of area 0
    refused({{0, 0}, {4, 2}, {4, 0}, {0, 2}}, "itself at (2, 1)");
    refused({{0, 0}, {8, 4}, {8, 0}, {0, 2}}, "itself at (2.66");
    refused({{0, 0}, {4, 0}, {4, 4}, {4, -2}, {0, -2}}, "itself at (4, 0)");        // a spike beyond where it began
    refused({{0, 0}, {2, 0}, {2, 2}, {1, 0}, {0, 2}}, "itself at (1, 0)");          // a corner on a side
    refused({{0, 0}, {4, 0}, {4, 4}, {4, 2}, {0, 2}}, "itself at (4, 2)");          // a spike that runs back on itself
    refused({{0, 0}, {2, 0}, {1, 1}, {2, 2}, {0, 2}, {1, 1}}, "itself at (1, 1)");  // a corner twice
    refused({{0, 0}, {1, 1}, {3, 3}}, "on one line");
    CHECK_THROWS_WITH(simple_polygon({{0, 0}, {2, 2}, {2, 0}, {0, 2}}), Catch::Contains("(0, 0)–(2, 2)"));
}
