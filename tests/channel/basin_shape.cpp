// SPDX-License-Identifier: GPL-3.0-or-later
#include "thalweg/channel/basin_shape.hpp"

#include <catch2/catch.hpp>
#include <cmath>
#include <numbers>

#include "support/flow_trees.hpp"
#include "support/terrains.hpp"

using namespace thalweg;
using namespace thalweg::channel;
using support::graph_of;

namespace {

OffsetOf offsets_of(const std::vector<Point>& at) {
    return [&at](Index from, Index to) { return Point{at[to].x - at[from].x, at[to].y - at[from].y}; };
}

/// A trunk 0 – 1 – 2 – 3 that runs south and hillslopes of one node beside it, the areas told by the nodes:
///
///         3
///     5 – 2 – 6      5 on the west, 6 and 7 on the east
///         1 – 7
///         0
///         4          which is beyond the outlet 0
struct DrawnTrunk {
    std::vector<Point> at{{0, 0}, {0, 1}, {0, 2}, {0, 3}, {0, -1}, {-1, 2}, {1, 2}, {1, 1}};
    terrain::FlowGraph graph = graph_of({4, 0, 1, 2, none, 2, 2, 1});
    std::vector<double> area_m2{17, 15, 11, 3, 40, 5, 2, 3};
    std::vector<std::uint8_t> channel{1, 1, 1, 1, 0, 0, 0, 0};
    std::vector<terrain::Basin> basins{{.outlet = 0, .area_m2 = 17, .complete = true}};

    std::vector<TrunkSides> sides() const {
        const auto network = stream_network(graph, channel, area_m2, std::vector<double>(8, 0));
        return trunk_sides(graph, area_m2, network, main_streams(network), basins, offsets_of(at));
    }
};

}  // namespace

TEST_CASE("Shape numbers are those of a circle, a square and what one has in a textbook") {
    const double r = 1000;  // a circle whose mouth lies on its rim, 500 m high
    const BasinShape circle = basin_shape(std::numbers::pi * r * r, 2 * r, 2 * std::numbers::pi * r, 500);
    CHECK(circle.form_factor == Approx(std::numbers::pi / 4));
    CHECK(circle.circularity == Approx(1));
    CHECK(circle.elongation == Approx(1));
    CHECK(circle.relief_ratio == Approx(0.25));
    CHECK(circle.ruggedness == Approx(0.5 / std::sqrt(std::numbers::pi)));
    const BasinShape square = basin_shape(1e6, 1000 * std::sqrt(2), 4000, 100);
    CHECK(square.form_factor == Approx(0.5));
    CHECK(square.circularity == Approx(std::numbers::pi / 4));
    CHECK(square.elongation == Approx(std::sqrt(2 / std::numbers::pi)));
    CHECK(std::isnan(basin_shape(100, 0, 40, 5).elongation));
    CHECK(std::isnan(basin_shape(100, 10, std::nan(""), 5).circularity));
}

TEST_CASE("A basin's length is the straight way from its outlet to the farthest node") {
    const Grid grid = support::uneven_grid(6, 5);
    // Basin 0 leaves at the south-east corner, basin 1 is one cell.
    std::vector<Index> label(30, 0);
    label[0] = 1;
    label[7] = none;
    const std::vector<terrain::Basin> basins{{.outlet = 29, .area_m2 = 1, .complete = true},
                                             {.outlet = 0, .area_m2 = 1, .complete = true}};
    const OffsetOf offset = offsets(grid);
    const auto length = basin_lengths(terrain::nodes_of_basins(label, 2), basins, offset);
    double farthest = 0;
    for (const Index node : {1u, 5u}) farthest = std::max(farthest, std::hypot(offset(29, node).x, offset(29, node).y));
    REQUIRE(length.size() == 2);
    CHECK(length[0] == Approx(farthest));
    CHECK(length[0] ==
          Approx(std::hypot(4 * (grid.east_west[5] + grid.east_west[1]) / 2,
                            grid.north_south[1] + grid.north_south[2] + grid.north_south[3] + grid.north_south[4])));
    CHECK(length[1] == 0);
}

TEST_CASE("What reaches a trunk from the west is on the right of one that runs south") {
    const auto sides = DrawnTrunk().sides();
    REQUIRE(sides.size() == 1);
    CHECK(sides[0].right_m2 == 5);
    CHECK(sides[0].left_m2 == 5);  // 2 and 3; the source's own area is on neither side
    CHECK(sides[0].asymmetry_percent() == 50);
}

TEST_CASE("Mirroring a basin turns its asymmetry over, turning it does nothing") {
    DrawnTrunk drawn;
    drawn.area_m2[5] = 9;
    const double plain = drawn.sides()[0].asymmetry_percent();
    CHECK(plain == Approx(100 * 9.0 / 14));
    DrawnTrunk mirrored = drawn, turned = drawn;
    for (Point& p : mirrored.at) p.x = -p.x;
    for (Point& p : turned.at) p = {p.x * 0.6 - p.y * 0.8, p.x * 0.8 + p.y * 0.6};
    CHECK(mirrored.sides()[0].asymmetry_percent() == Approx(100 - plain));
    CHECK(turned.sides()[0].asymmetry_percent() == Approx(plain));
}

TEST_CASE("What meets in an outlet from which water goes nowhere has no side, and a basin without links no asymmetry") {
    DrawnTrunk drawn;
    drawn.graph = graph_of({none, 0, 1, 2, 0, 2, 2, 1});  // 4 flows into the outlet from straight ahead
    CHECK(drawn.sides()[0].left_m2 == 5);
    CHECK(drawn.sides()[0].right_m2 == 5);
    drawn.channel.assign(8, 0);
    CHECK(std::isnan(drawn.sides()[0].asymmetry_percent()));
}
