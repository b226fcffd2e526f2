// SPDX-License-Identifier: GPL-3.0-or-later
#include "thalweg/io/polygonize.hpp"

#include <ogr_geometry.h>

#include <algorithm>
#include <catch2/catch.hpp>
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
    const std::vector<Polygon> rings = io::cell_outlines(d.frame, d.labels, 5);
    REQUIRE(rings.size() == 5);
    CHECK(normal(rings[0]) == normal({{100, 44}, {104, 44}, {104, 50}, {100, 50}}));
    CHECK(area_of(rings[1]) == 18);
    CHECK(normal(rings[2]) == normal({{106, 41}, {108, 41}, {108, 47}, {106, 47}}));
    CHECK(area_of(rings[3]) == 6);
    CHECK(rings[4].empty());
    for (Index label = 0; label < 4; ++label) {
        CHECK(normal(io::cell_outline(d.frame, d.labels, label)) == normal(rings[label]));
    }
}

TEST_CASE("of parts that touch at corners only the largest is outlined, and holes are filled", "[polygonize]") {
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

TEST_CASE("a part that meets itself at a corner has a simple outline", "[polygonize]") {
    const Drawing d = draw({"00.0",  //
                            "0.00",  //
                            "0000"});
    const Polygon ring = io::cell_outline(d.frame, d.labels, 0);
    CHECK(is_valid(ring));
    // The enclosed cell opens to the outside through a corner: it counts as inside.
    CHECK(area_of(ring) == 11 * 6);
}

TEST_CASE("outlines of random labels are simple and enclose the largest part that hangs together", "[polygonize]") {
    Random random(7, 1);
    for (int trial = 0; trial < 200; ++trial) {
        const Index rows = 1 + random.below(9);
        const Index cols = 1 + random.below(9);
        Drawing d;
        d.frame.grid = plane_grid(rows, cols, 1, 1);
        for (Index i = 0; i < rows * cols; ++i) d.labels.push_back(random.below(3));
        const std::vector<Polygon> rings = io::cell_outlines(d.frame, d.labels, 3);
        for (Index label = 0; label < 3; ++label) {
            if (std::count(d.labels.begin(), d.labels.end(), label) == 0) {
                CHECK(rings[label].empty());
                continue;
            }
            REQUIRE(is_valid(rings[label]));
            CHECK(area_of(rings[label]) == largest_filled_part(d, label));
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
}
