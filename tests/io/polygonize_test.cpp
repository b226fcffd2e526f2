// SPDX-License-Identifier: GPL-3.0-or-later
#include "thalweg/io/polygonize.hpp"

#include <ogr_geometry.h>

#include <algorithm>
#include <catch2/catch.hpp>
#include <memory>
#include <string>

#include "thalweg/core/error.hpp"
#include "thalweg/core/random.hpp"

using namespace thalweg;

namespace {

struct Drawing {
    Raster frame;
    std::vector<Index> labels;
};

/// Digits are labels, anything else is none. Cells are 2 by 3 in size, the north-west corner lies at (100, 50).
Drawing draw(const std::vector<std::string>& lines) {
    Drawing drawing;
    const auto rows = static_cast<Index>(lines.size());
    const auto cols = static_cast<Index>(lines.front().size());
    drawing.frame.grid = plane_grid(rows, cols, 2, 3);
    drawing.frame.placement = {.west = 100, .north = 50, .cell_width = 2, .cell_height = 3, .crs_wkt = {}};
    for (const std::string& line : lines) {
        for (const char c : line) drawing.labels.push_back(c >= '0' && c <= '9' ? static_cast<Index>(c - '0') : none);
    }
    return drawing;
}

double area_of(const Polygon& ring) {
    double doubled = 0;
    for (std::size_t i = 0; i < ring.size(); ++i) {
        const Point& a = ring[i];
        const Point& b = ring[(i + 1) % ring.size()];
        doubled += a.x * b.y - b.x * a.y;
    }
    return doubled / 2;
}

bool is_valid(const Polygon& ring) {
    OGRPolygon shape;
    auto* outer = new OGRLinearRing;
    for (const Point& p : ring) outer->addPoint(p.x, p.y);
    outer->closeRings();
    shape.addRingDirectly(outer);
    return shape.IsValid();
}

/// Cells from which those of `seen` can be reached by steps over sides through cells where `open` holds.
template <class Open>
void spread(const Grid& grid, std::vector<int>& seen, Open open) {
    for (bool changed = true; changed;) {
        changed = false;
        for (Index node = 0; node < grid.size(); ++node) {
            if (seen[node] || !open(node)) continue;
            grid.neighbors(node, [&](Index other, double, Slot slot) {
                if (slot % 2 == 0 && seen[other]) seen[node] = 1;
            });
            changed = changed || seen[node];
        }
    }
}

/// Cells of the largest part of a label, with what it encloses: all that outside water, moving over sides, cannot
/// reach.
double largest_filled_part(const Drawing& d, Index label) {
    const Grid& grid = d.frame.grid;
    double largest = 0;
    for (Index start = 0; start < grid.size(); ++start) {
        if (d.labels[start] != label) continue;
        std::vector<int> part(grid.size(), 0);
        part[start] = 1;
        spread(grid, part, [&](Index node) { return d.labels[node] == label; });
        std::vector<int> wet(grid.size(), 0);
        for (Index node = 0; node < grid.size(); ++node) {
            const bool rim = grid.row(node) == 0 || grid.row(node) + 1 == grid.rows || grid.col(node) == 0 ||
                             grid.col(node) + 1 == grid.cols;
            wet[node] = rim && !part[node];
        }
        spread(grid, wet, [&](Index node) { return !part[node]; });
        largest = std::max(largest, static_cast<double>(std::count(wet.begin(), wet.end(), 0)));
    }
    return largest;
}

/// The number of parts that hang together by their sides.
int count_parts(const Drawing& d, Index label) {
    std::vector<int> seen(d.labels.size(), 0);
    int parts = 0;
    for (Index start = 0; start < d.frame.grid.size(); ++start) {
        if (d.labels[start] != label || seen[start]) continue;
        seen[start] = 1;
        ++parts;
        spread(d.frame.grid, seen, [&](Index node) { return d.labels[node] == label; });
    }
    return parts;
}

double area_of(const MultiPolygon& parts) {
    double area = 0;
    for (const PolygonPart& part : parts) {
        area += area_of(part.outer);
        for (const Polygon& hole : part.holes) area += area_of(hole);  // clockwise: negative
    }
    return area;
}

std::unique_ptr<OGRMultiPolygon> shape_of(const MultiPolygon& parts) {
    auto shape = std::make_unique<OGRMultiPolygon>();
    for (const PolygonPart& part : parts) {
        auto* polygon = new OGRPolygon;
        const auto add = [&](const Polygon& points) {
            auto* ring = new OGRLinearRing;
            for (const Point& p : points) ring->addPoint(p.x, p.y);
            ring->closeRings();
            polygon->addRingDirectly(ring);
        };
        add(part.outer);
        for (const Polygon& hole : part.holes) add(hole);
        shape->addGeometryDirectly(polygon);
    }
    return shape;
}

/// Starts at the smallest point, so that rings compare whatever vertex they begin with.
Polygon normal(Polygon ring) {
    const auto before = [](const Point& a, const Point& b) { return a.x < b.x || (a.x == b.x && a.y < b.y); };
    std::rotate(ring.begin(), std::min_element(ring.begin(), ring.end(), before), ring.end());
    return ring;
}

}  // namespace

TEST_CASE("the outline of an L is six corners, counter-clockwise", "[polygonize]") {
    const Drawing d = draw({"....",  //
                            ".0..",  //
                            ".00.",  //
                            "...."});
    const Polygon ring = io::cell_outline(d.frame, d.labels, 0);
    CHECK(normal(ring) == normal({{102, 41}, {106, 41}, {106, 44}, {104, 44}, {104, 47}, {102, 47}}));
    CHECK(area_of(ring) == 18);
}

TEST_CASE("all outlines are found in one pass, also at the edge of the grid", "[polygonize]") {
    const Drawing d = draw({"0011",  //
                            "0012",  //
                            "3..2"});
    const std::vector<MultiPolygon> all = io::cell_outlines(d.frame, d.labels, 5);
    REQUIRE(all.size() == 5);
    CHECK(normal(all[0].at(0).outer) == normal({{100, 44}, {104, 44}, {104, 50}, {100, 50}}));
    CHECK(area_of(all[1]) == 18);
    CHECK(normal(all[2].at(0).outer) == normal({{106, 41}, {108, 41}, {108, 47}, {106, 47}}));
    CHECK(area_of(all[3]) == 6);
    CHECK(all[4].empty());
    CHECK(io::cell_outline(d.frame, d.labels, 4).empty());
    for (Index label = 0; label < 4; ++label) {
        CHECK(normal(io::cell_outline(d.frame, d.labels, label)) == normal(all[label].at(0).outer));
    }
}

TEST_CASE("parts that touch at corners are all there, in the order of their first cells", "[polygonize]") {
    const Drawing d = draw({"0..0",  //
                            ".00.",  //
                            ".00.",  //
                            "0..."});
    const MultiPolygon parts = io::cell_outlines(d.frame, d.labels, 1).front();
    REQUIRE(parts.size() == 4);
    CHECK(normal(parts[0].outer) == normal({{100, 47}, {102, 47}, {102, 50}, {100, 50}}));
    CHECK(normal(parts[1].outer) == normal({{106, 47}, {108, 47}, {108, 50}, {106, 50}}));
    CHECK(normal(parts[2].outer) == normal({{102, 41}, {106, 41}, {106, 47}, {102, 47}}));
    CHECK(normal(parts[3].outer) == normal({{100, 38}, {102, 38}, {102, 41}, {100, 41}}));
    for (const PolygonPart& part : parts) CHECK(part.holes.empty());
}

TEST_CASE("a hole lies in the part around it, clockwise, and an island in it is a part", "[polygonize]") {
    const Drawing d = draw({"0.00000",  //
                            "..0...0",  //
                            "..0.0.0",  //
                            "..0...0",  //
                            "0.00000"});
    const MultiPolygon parts = io::cell_outlines(d.frame, d.labels, 1).front();
    REQUIRE(parts.size() == 4);
    REQUIRE(parts[1].holes.size() == 1);
    CHECK(normal(parts[1].holes[0]) == normal({{106, 38}, {106, 47}, {112, 47}, {112, 38}}));
    CHECK(area_of(parts[1].holes[0]) == -54);
    CHECK(normal(parts[2].outer) == normal({{108, 41}, {110, 41}, {110, 44}, {108, 44}}));
    CHECK(parts[0].holes.size() + parts[2].holes.size() + parts[3].holes.size() == 0);
}

TEST_CASE("holes that touch at a corner are two, and one that opens at a corner is one", "[polygonize]") {
    const Drawing touching = draw({"0000",  //
                                   "0.00",  //
                                   "00.0",  //
                                   "0000"});
    const MultiPolygon two = io::cell_outlines(touching.frame, touching.labels, 1).front();
    REQUIRE(two.size() == 1);
    REQUIRE(two[0].holes.size() == 2);
    CHECK(area_of(two[0].holes[0]) == -6);
    CHECK(area_of(two[0].holes[1]) == -6);
    CHECK(shape_of(two)->IsValid());
    const Drawing open = draw({"00.0",  //
                               "0.00",  //
                               "0000"});
    const MultiPolygon one = io::cell_outlines(open.frame, open.labels, 1).front();
    REQUIRE(one.size() == 1);
    REQUIRE(one[0].holes.size() == 1);
    CHECK(normal(one[0].holes[0]) == normal({{102, 44}, {102, 47}, {104, 47}, {104, 44}}));
    CHECK(shape_of(one)->IsValid());
}

TEST_CASE("the border is the largest of parts that touch at corners, its holes filled", "[polygonize]") {
    const Drawing corners = draw({"0...",  //
                                  ".00.",  //
                                  ".00.",  //
                                  "...0"});
    CHECK(area_of(io::cell_outline(corners.frame, corners.labels, 0)) == 24);
    CHECK(io::cell_outline(corners.frame, corners.labels, 0).size() == 4);
    const Drawing hole = draw({"000",  //
                               "0.0",  //
                               "000"});
    CHECK(area_of(io::cell_outline(hole.frame, hole.labels, 0)) == 54);
}

TEST_CASE("the border of a part that meets itself at a corner is simple", "[polygonize]") {
    const Drawing d = draw({"00.0",  //
                            "0.00",  //
                            "0000"});
    const Polygon ring = io::cell_outline(d.frame, d.labels, 0);
    CHECK(is_valid(ring));
    // The enclosed cell opens to the outside through a corner: it counts as inside.
    CHECK(area_of(ring) == 11 * 6);
}

TEST_CASE("borders of random labels are simple and enclose the largest part that hangs together", "[polygonize]") {
    Random random(7, 1);
    for (int trial = 0; trial < 200; ++trial) {
        const Index rows = 1 + random.below(9);
        const Index cols = 1 + random.below(9);
        Drawing d;
        d.frame.grid = plane_grid(rows, cols, 1, 1);
        for (Index i = 0; i < rows * cols; ++i) d.labels.push_back(random.below(3));
        for (Index label = 0; label < 3; ++label) {
            const Polygon ring = io::cell_outline(d.frame, d.labels, label);
            if (std::count(d.labels.begin(), d.labels.end(), label) == 0) {
                CHECK(ring.empty());
                continue;
            }
            REQUIRE(is_valid(ring));
            CHECK(area_of(ring) == largest_filled_part(d, label));
        }
    }
}

TEST_CASE("outlines of random labels are valid and cover the label's cells and no others", "[polygonize]") {
    Random random(11, 1);
    for (int trial = 0; trial < 400; ++trial) {
        const Index rows = 1 + random.below(14);
        const Index cols = 1 + random.below(14);
        const Index kinds = 2 + random.below(3);
        Drawing d;
        d.frame.grid = plane_grid(rows, cols, 1, 1);
        // Every other grid is mostly of one label, so that it has holes within its parts.
        for (Index i = 0; i < rows * cols; ++i) {
            d.labels.push_back(trial % 2 && random.below(3) ? 0 : random.below(kinds));
        }
        const std::vector<MultiPolygon> all = io::cell_outlines(d.frame, d.labels, kinds);
        for (Index label = 0; label < kinds; ++label) {
            const auto cells = std::count(d.labels.begin(), d.labels.end(), label);
            CHECK(area_of(all[label]) == cells);
            CHECK(static_cast<int>(all[label].size()) == count_parts(d, label));
            const auto shape = shape_of(all[label]);
            REQUIRE(shape->IsValid());
            CHECK(shape->get_Area() == cells);
            for (Index node = 0; node < d.frame.grid.size() && trial < 60; ++node) {
                const Point center = d.frame.placement.center(d.frame.grid.row(node), d.frame.grid.col(node));
                const OGRPoint point(center.x, center.y);
                CHECK(shape->Contains(&point) == (d.labels[node] == label));
            }
        }
    }
}

TEST_CASE("simplifying takes the steps off an outline and keeps its area", "[polygonize]") {
    std::vector<std::string> lines(40, std::string(40, '.'));
    for (int row = 0; row < 40; ++row) {
        for (int col = 0; col <= row; ++col) lines[row][col] = '0';
    }
    const Drawing d = draw(lines);
    const Polygon ring = io::cell_outline(d.frame, d.labels, 0);
    const Polygon simple = io::simplify(ring, 3);
    CHECK(ring.size() > 70);
    CHECK(simple.size() < 8);
    CHECK(is_valid(simple));
    CHECK(area_of(simple) > 0);
    CHECK(area_of(simple) == Approx(area_of(ring)).epsilon(0.06));
    CHECK(io::simplify(simple, 0).size() == simple.size());
}

TEST_CASE("labels that do not fit the grid are refused", "[polygonize]") {
    const Drawing d = draw({"00", "00"});
    CHECK_THROWS_AS(io::cell_outline(d.frame, std::vector<Index>(3), 0), Error);
    CHECK_THROWS_AS(io::cell_outlines(d.frame, std::vector<Index>(5), 1), Error);
}
