// SPDX-License-Identifier: GPL-3.0-or-later
#include "thalweg/channel/valleys.hpp"

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <limits>
#include <numbers>

#include "support/flow_trees.hpp"
#include "thalweg/core/random.hpp"
#include "thalweg/core/raster.hpp"
#include "thalweg/terrain/accumulate.hpp"
#include "thalweg/terrain/route.hpp"

using namespace thalweg;
using namespace thalweg::channel;

namespace {

constexpr double nan = std::numeric_limits<double>::quiet_NaN();

/// A valley that falls to the south: its floor in the middle column falls by 0.02, the western side by `west` to it and
/// the eastern one by `east`; nothing beyond. The channel begins `head` rows from the north.
struct Valley {
    static constexpr Index rows = 30, cols = 21, middle = 10;
    Grid grid = plane_grid(rows, cols, 10, 10);
    std::vector<double> elevation;
    terrain::FlowGraph graph;
    std::vector<double> area;
    StreamNetwork network;

    Valley(double west, double east, Index head) {
        for (Index row = 0; row < rows; ++row) {
            for (Index col = 0; col < cols; ++col) {
                const bool rim = row == 0 || row + 1 == rows || col == 0 || col + 1 == cols;
                const double from_floor = 10 * (double(col) - middle);
                const double side = from_floor < 0 ? -west * from_floor : east * from_floor;
                elevation.push_back(rim ? nan : 0.2 * (rows - row) + side);
            }
        }
        std::vector<Boundary> boundary(grid.size(), Boundary::interior);
        boundary[grid.size() - cols - 1 - middle] = Boundary::base_level;
        graph = terrain::flow_graph(grid, elevation, terrain::route(grid, elevation, boundary));
        area = terrain::accumulate(graph, terrain::cell_areas(grid));
        std::vector<std::uint8_t> channel(grid.size(), 0);
        for (Index row = head; row + 1 < rows; ++row) channel[row * cols + middle] = 1;
        network = stream_network(graph, channel, area, elevation);
    }
};

}  // namespace

TEST_CASE("The sides of a drawn valley have their slopes, each on its bank") {
    const Valley valley(0.5, 0.25, 1);  // up to the divide: all ridge cells lie beside the channel
    REQUIRE(valley.network.size() == 1);
    const auto sides = valley_sides(ridge_pieces(valley.grid, valley.graph, valley.elevation, valley.network));
    REQUIRE(sides.size() == 2);
    CHECK(sides[0].bank == Bank::left);  // looking south, that is east
    const auto slope = [](const ValleySide& side) { return side.rise_m / side.run_m; };
    CHECK(slope(sides[0]) == Approx(0.25));
    CHECK(slope(sides[1]) == Approx(0.5));
    const UniformDraw angles = sidewall_angles(sides);
    const double a = std::atan(0.25) * 180 / std::numbers::pi, b = std::atan(0.5) * 180 / std::numbers::pi;
    CHECK(angles.count == 2);
    CHECK(angles.mean.value == Approx((a + b) / 2));
    CHECK(angles.delta.value == Approx(std::sqrt(3.0) * (b - a) / std::sqrt(2.0)));
}

namespace {

double squares_left(const std::vector<RidgePiece>& pieces, double reach) {
    double xh = 0, xx = 0, hh = 0;
    for (const RidgePiece& p : pieces) {
        const double x = std::min(p.run_m, reach);
        xh += p.length_m * x * p.rise_m;
        xx += p.length_m * x * x;
        hh += p.length_m * p.rise_m * p.rise_m;
    }
    return hh - xh * xh / xx;
}

/// Ridges at distances up to 1000 m, of 40 links, that rise by 0.3 up to `reach`, off by up to `scatter`.
std::vector<RidgePiece> drawn_ridges(std::uint64_t seed, double reach, double scatter) {
    Random random(seed, 3);
    std::vector<RidgePiece> pieces;
    for (Index i = 0; i < 2000; ++i) {
        const double run = 1000 * random.uniform();
        pieces.push_back({.link = i % 40,
                          .bank = i % 80 < 40 ? Bank::left : Bank::right,
                          .length_m = 1 + random.uniform(),
                          .rise_m = 0.3 * std::min(run, reach) + scatter * (2 * random.uniform() - 1),
                          .run_m = run});
    }
    return pieces;
}

}  // namespace

TEST_CASE("Valley sides reach as far as they rise") {
    for (const double reach : {150.0, 400.0, 700.0, 950.0}) {
        CHECK(sidewall_reach(drawn_ridges(1, reach, 0)).value == Approx(reach).epsilon(1e-9));
    }
    const auto straight = drawn_ridges(2, 1e9, 0);
    CHECK(sidewall_reach(straight).value == ridge_distance(straight, 0.99));
    CHECK(ridge_distance(straight, 0.99) == Approx(990).margin(5));
    CHECK(ridge_distance(straight, 0.5) == Approx(500).margin(40));
    CHECK(std::isnan(sidewall_reach({}).value));
    CHECK(std::isnan(sidewall_reach(std::vector<RidgePiece>{{0, Bank::left, 1, -5, 10}}).value));
    const Estimate one = sidewall_reach(std::vector<RidgePiece>{{0, Bank::left, 1, 5, 10}});
    CHECK(one.value == 10);
    CHECK(std::isnan(one.standard_error));
}

TEST_CASE("No other reach leaves less of the heights of scattered ridges, and its error is its scatter") {
    constexpr int trials = 60;
    std::vector<double> found, errors;
    for (std::uint64_t seed = 1; seed <= trials; ++seed) {
        const auto pieces = drawn_ridges(seed, 500, 100);
        const Estimate reach = sidewall_reach(pieces);
        const double known = ridge_distance(pieces, 0.99);
        for (double other = 1; other < known; other += 3) {
            REQUIRE(squares_left(pieces, reach.value) <= squares_left(pieces, other) * (1 + 1e-12));
        }
        found.push_back(reach.value);
        errors.push_back(reach.standard_error);
    }
    CHECK(mean(found) == Approx(500).margin(4 * mean(errors) / std::sqrt(trials)));
    CHECK(mean(errors) == Approx(standard_deviation(found)).epsilon(0.35));
}

TEST_CASE("On a raster the benches above a valley begin where its sides stop rising") {
    // A valley that widens downstream from 40 to 340 m on either side: up to 120 m from its floor the sides rise by
    // 0.5, then by 0.001.
    constexpr Index rows = 60, cols = 71, middle = 35;
    const Grid grid = plane_grid(rows, cols, 10, 10);
    std::vector<double> elevation;
    std::vector<Boundary> boundary(grid.size(), Boundary::interior);
    std::vector<std::uint8_t> channel(grid.size(), 0);
    for (Index row = 0; row < rows; ++row) {
        for (Index col = 0; col < cols; ++col) {
            const double away = 10 * std::abs(double(col) - middle);
            const double side = 0.5 * std::min(away, 120.0) + 0.001 * std::max(away - 120, 0.0);
            elevation.push_back(away > 40 + 5.0 * row ? std::nan("") : 1e-5 * (rows - row) + side);
        }
        channel[row * cols + middle] = 1;
    }
    boundary[(rows - 1) * cols + middle] = Boundary::base_level;
    const auto graph = terrain::flow_graph(grid, elevation, terrain::route(grid, elevation, boundary));
    const auto area = terrain::accumulate(graph, terrain::cell_areas(grid));
    const auto network = stream_network(graph, channel, area, elevation);
    const auto pieces = ridge_pieces(grid, graph, elevation, network);
    CHECK(ridge_distance(pieces, 1) == Approx(335).margin(10));
    const double reach = sidewall_reach(pieces).value;
    CHECK(reach == Approx(120).margin(1));
    CHECK(sidewall_angles(valley_sides(pieces, reach)).mean.value ==
          Approx(std::atan(0.5) * 180 / std::numbers::pi).margin(0.1));
    CHECK(sidewall_angles(valley_sides(pieces)).mean.value < 18);  // benches and all
}

TEST_CASE("Beyond a source the way goes straight on to the divide") {
    for (const Index head : {1u, 5u, 12u}) {
        const Valley valley(0.5, 0.5, head);
        const auto beyond = beyond_sources(valley.grid, valley.graph, valley.network, 100);
        REQUIRE(beyond.size() == 1);
        CHECK(beyond[0] == Approx(10.0 * (head - 1)).margin(5));  // row 0 holds no data
    }
}

TEST_CASE("The constant of channel maintenance is area over length, with the error of a ratio") {
    // Nodes: mouth 0, junction 1, sources 2 and 3 at one step each; every node has 1 m² of its own.
    const StreamNetwork rivers = support::network_of(support::graph_of({none, 0, 1, 1}, 10));
    const Estimate c = channel_maintenance(rivers);
    const double area = rivers.area_m2[0];
    CHECK(c.value == Approx(area / 30));
    double squares = 0;
    for (Index link = 0; link < 3; ++link) {
        const double own = link == 0 ? area - rivers.area_m2[1] - rivers.area_m2[2] : rivers.area_m2[link];
        squares += std::pow(own - c.value * 10, 2);
    }
    CHECK(c.standard_error == Approx(std::sqrt(squares * 3 / 2) / 30));
    CHECK(std::isnan(channel_maintenance(support::network_of(support::graph_of({none, 0}))).standard_error));
    CHECK(std::isnan(channel_maintenance(StreamNetwork{}).value));
}

TEST_CASE("Only streams that join another and have no tributary tell how far rivers reach") {
    // A trunk of two links with two tributaries, one of which (node 5) has a tributary of its own (7).
    const terrain::FlowGraph graph = support::graph_of({none, 0, 1, 2, 1, 1, 5, 5, 2}, 10);
    const StreamNetwork rivers = support::network_of(graph);
    const MainStreams streams = main_streams(rivers);
    std::vector<double> beyond(rivers.size(), 0);
    std::vector<double> expected;
    for (Index link = 0; link < rivers.size(); ++link) {
        if (rivers.shreve[link] != 1) continue;
        beyond[link] = 10.0 * (link + 1);
        const Index below = rivers.downstream[link];
        const bool is_tributary = below != none && streams.stream[below] != streams.stream[link];
        if (is_tributary) expected.push_back(10 / (10 + beyond[link]));
    }
    const UniformDraw reach = headward_reach(rivers, streams, beyond);
    CHECK(reach.count == expected.size());
    CHECK(reach.mean.value == Approx(mean(expected)));
}
