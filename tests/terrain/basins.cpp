// SPDX-License-Identifier: GPL-3.0-or-later
#include "thalweg/terrain/basins.hpp"

#include <catch2/catch.hpp>
#include <cmath>
#include <numbers>
#include <ranges>

#include "support/drawing.hpp"
#include "support/terrain_oracles.hpp"
#include "support/terrains.hpp"
#include "thalweg/core/error.hpp"
#include "thalweg/terrain/accumulate.hpp"
#include "thalweg/terrain/lakes.hpp"
#include "thalweg/terrain/route.hpp"

using namespace thalweg;
using namespace thalweg::terrain;
using namespace thalweg::support;

namespace {

/// A terrain made into all that basins are found from.
struct Measured {
    Grid grid;
    std::vector<Boundary> boundary;
    FlowDirections directions;
    FlowGraph graph;
    std::vector<double> area_m2;
    std::vector<std::uint8_t> complete;
};

Measured measure(const Grid& grid, std::span<const double> z) {
    Measured m{
        .grid = grid, .boundary = data_edge(grid, z), .directions = {}, .graph = {}, .area_m2 = {}, .complete = {}};
    m.directions = route(grid, z, m.boundary);
    drain_lakes(grid, z, m.boundary, m.directions);
    m.graph = flow_graph(grid, z, m.directions);
    m.area_m2 = accumulate(m.graph, cell_areas(grid));
    m.complete = complete_catchments(grid, m.graph, m.boundary);
    return m;
}

/// Directions as drawn, the rim open.
Measured measure_drawn(Index rows, Index cols, const std::string& directions) {
    const std::vector<double> z(rows * cols, 0.0);
    Measured m{.grid = plane_grid(rows, cols, 1, 1),
               .boundary = {},
               .directions = draw_directions(directions),
               .graph = {},
               .area_m2 = {},
               .complete = {}};
    m.boundary = data_edge(m.grid, z);
    m.graph = flow_graph(m.grid, z, m.directions);
    m.area_m2 = accumulate(m.graph, cell_areas(m.grid));
    m.complete = complete_catchments(m.grid, m.graph, m.boundary);
    return m;
}

std::string show(const std::vector<std::uint8_t>& flags, Index cols) {
    std::string text;
    for (std::size_t i = 0; i < flags.size(); ++i) {
        text += flags[i] ? '1' : '.';
        if ((i + 1) % cols == 0) text += '\n';
    }
    return text;
}

}  // namespace

TEST_CASE("every node knows the outlet of its tree") {
    const Measured m = measure_drawn(2, 4, R"(
        v 3 > v
        . < . .)");
    CHECK(outlet_of(m.graph) == std::vector<Index>{4, 4, 7, 7, 4, 4, 6, 7});
}

TEST_CASE("the outlet of a node is where its water ends") {
    for (std::uint64_t seed = 1; seed <= 20; ++seed) {
        for (const TestTerrain& terrain : assorted_terrains(seed)) {
            const Measured m = measure(terrain.grid, terrain.elevation_m);
            const std::vector<Index> outlet = outlet_of(m.graph);
            for (Index node = 0; node < terrain.grid.size(); ++node) {
                const bool data = !std::isnan(terrain.elevation_m[node]);
                REQUIRE(outlet[node] == (data ? end_of_flow(terrain.grid, m.directions, node) : none));
            }
        }
    }
}

TEST_CASE("outlets, labels and completeness are those of the walks on terrain that several threads share") {
    const TestTerrain terrain = with_holes(noise_terrain(450, 470, 8), 0.0005, 8);
    const Measured m = measure(terrain.grid, terrain.elevation_m);
    const std::vector<Index> outlet = outlet_of(m.graph);
    const auto apart = [](Index a, Index b) { return std::abs(int(a) - int(b)); };
    std::vector<std::uint8_t> complete(terrain.grid.size(), 0);
    for (const Index node : m.graph.order) {
        const Index end = end_of_flow(m.grid, m.directions, node);
        REQUIRE(outlet[node] == end);
        complete[node] = m.boundary[node] == Boundary::interior || (apart(m.grid.row(node), m.grid.row(end)) <= 2 &&
                                                                    apart(m.grid.col(node), m.grid.col(end)) <= 2);
    }
    for (const Index node : std::views::reverse(m.graph.order)) {
        if (!complete[node] && m.graph.receiver[node] != none) complete[m.graph.receiver[node]] = 0;
    }
    CHECK(m.complete == complete);
    const std::vector<Basin> found = basins(m.graph, m.area_m2, complete, 20, EdgeBasins::drop);
    REQUIRE(found.size() > 100);
    std::vector<Index> label(terrain.grid.size(), none);
    for (Index basin = 0; basin < found.size(); ++basin) label[found[basin].outlet] = basin;
    for (const Index node : m.graph.order) {
        const Index receiver = m.graph.receiver[node];
        if (receiver != none && label[receiver] != none) label[node] = label[receiver];
    }
    CHECK(basin_labels(m.graph, found) == label);
}

TEST_CASE("in a drawn map a catchment is complete down to where water from the edge comes in") {
    // Two rivers leave at the same southern outlet (row 6, column 3). The western one starts inside; the eastern one
    // begins on the eastern rim, five columns from the outlet. Rim cells flow straight out.
    const Measured m = measure_drawn(7, 9, R"(
        . . . . . . . . .
        . v . . . . . . .
        . v . . . . . . .
        . > v . . . . . .
        . . > v < < < < <
        . . . v . . . . .
        . . . . . . . . .)");
    CHECK(show(m.complete, 9) ==
          "111111111\n"
          "111111111\n"
          "111111111\n"
          "111111111\n"
          "111......\n"
          "111.11111\n"
          "111.11111\n");
}

TEST_CASE("edge cells within two of the outlet they drain to do not cut a catchment") {
    const auto cut = [](const std::string& row) {
        const Measured m = measure_drawn(5, 9,
                                         ". . . . . . . . .  . . . . . . . . .  . . . . . . . . .  "
                                         ". . . . . . . . .  " +
                                             row);
        return m.complete[4 * 9 + 4] == 0;
    };
    CHECK_FALSE(cut(". . . > . . . . ."));
    CHECK_FALSE(cut(". . > > . . . . ."));
    CHECK_FALSE(cut(". . . . . < < . ."));
    CHECK(cut(". > > > . . . . ."));
}

TEST_CASE("a mask that leaves by one outlet is complete") {
    // A row of a hundred cells that flows east; the first few may leave by themselves.
    const auto complete_cells = [](Index strays) {
        std::string row;
        for (Index c = 0; c < 100; ++c) row += c + 1 == 100 ? ". " : (c < strays ? ". " : "> ");
        const Measured m = measure_drawn(1, 100, row);
        return std::count(m.complete.begin(), m.complete.end(), 1);
    };
    CHECK(complete_cells(0) == 100);
    CHECK(complete_cells(1) == 100);
    CHECK(complete_cells(2) < 10);
}

TEST_CASE("no node downstream of a cut one is complete, and none without reason cut") {
    for (std::uint64_t seed = 1; seed <= 40; ++seed) {
        const TestTerrain terrain = with_holes(noise_terrain(18, 21, seed), 0.01, seed);
        const Measured m = measure(terrain.grid, terrain.elevation_m);
        std::vector<std::uint8_t> cut(terrain.grid.size(), 0);
        for (Index start = 0; start < terrain.grid.size(); ++start) {
            if (m.boundary[start] == Boundary::interior) continue;
            const Index end = end_of_flow(m.grid, m.directions, start);
            const auto apart = [](Index a, Index b) { return std::abs(int(a) - int(b)); };
            if (apart(m.grid.row(start), m.grid.row(end)) <= 2 && apart(m.grid.col(start), m.grid.col(end)) <= 2) {
                continue;
            }
            for (Index node = start;; node = m.grid.neighbor(node, m.directions[node])) {
                cut[node] = 1;
                if (m.directions[node] == no_flow) break;
            }
        }
        for (Index node = 0; node < terrain.grid.size(); ++node) {
            const bool data = !std::isnan(terrain.elevation_m[node]);
            REQUIRE(m.complete[node] == (data && !cut[node]));
        }
    }
}

TEST_CASE("basins are the maximal complete catchments, largest first") {
    const Measured m = measure_drawn(7, 9, R"(
        . . . . . . . . .
        . v . . . . v . .
        . v . . . . v . .
        . > v . . . v . .
        . . > v < < < < <
        . . . v . . . . .
        . . . . . . . . .)");
    const std::vector<Basin> found = basins(m.graph, m.area_m2, m.complete, 2, EdgeBasins::drop);
    REQUIRE(found.size() == 2);
    CHECK(found[0].outlet == 4 * 9 + 2);
    CHECK(found[0].area_m2 == 5);
    CHECK(found[0].complete);
    CHECK(found[1].outlet == 3 * 9 + 6);
    CHECK(found[1].area_m2 == 3);
    const std::vector<Basin> trees = basins(m.graph, m.area_m2, m.complete, 2, EdgeBasins::keep);
    REQUIRE(trees.size() == 1);
    CHECK(trees[0].outlet == 6 * 9 + 3);
    CHECK(trees[0].area_m2 == 16);
    CHECK_FALSE(trees[0].complete);
}

TEST_CASE("equal basins come in the order of their outlets") {
    const Measured m = measure_drawn(3, 3, R"(
        > . v
        . . .
        . < .)");
    const std::vector<Basin> found = basins(m.graph, m.area_m2, m.complete, 2, EdgeBasins::keep);
    REQUIRE(found.size() == 3);
    CHECK(found[0].outlet == 1);
    CHECK(found[1].outlet == 5);
    CHECK(found[2].outlet == 6);
}

TEST_CASE("each node is labelled with its basin, and basins that overlap are refused") {
    const Measured m = measure_drawn(2, 4, R"(
        v 3 > v
        . < . .)");
    const std::vector<Basin> trees = basins(m.graph, m.area_m2, m.complete, 2, EdgeBasins::keep);
    REQUIRE(trees.size() == 2);
    CHECK(basin_labels(m.graph, trees) == std::vector<Index>{0, 0, 1, 1, 0, 0, none, 1});
    const std::vector<Basin> nested{{.outlet = 7, .area_m2 = 3, .complete = true},
                                    {.outlet = 3, .area_m2 = 2, .complete = true}};
    CHECK_THROWS_AS(basin_labels(m.graph, nested), Error);
}

TEST_CASE("complete basins never overlap and hold exactly the complete nodes") {
    for (std::uint64_t seed = 1; seed <= 40; ++seed) {
        for (const TestTerrain& terrain : assorted_terrains(seed)) {
            const Measured m = measure(terrain.grid, terrain.elevation_m);
            const std::vector<Basin> found = basins(m.graph, m.area_m2, m.complete, 0, EdgeBasins::drop);
            const std::vector<Index> label = basin_labels(m.graph, found);
            std::vector<double> labelled(found.size(), 0);
            for (Index node = 0; node < terrain.grid.size(); ++node) {
                REQUIRE((label[node] != none) == (m.complete[node] == 1));
                if (label[node] != none) labelled[label[node]] += terrain.grid.area(node);
            }
            for (Index b = 0; b < found.size(); ++b) REQUIRE(labelled[b] == Approx(found[b].area_m2));
        }
    }
}

TEST_CASE("the nodes of each basin are listed in their order") {
    const BasinNodes rows = nodes_of_basins(std::vector<Index>{1, 0, none, 1, 3, 1}, 4);
    CHECK(rows.offset == std::vector<Index>{0, 1, 4, 4, 5});
    CHECK(rows.node == std::vector<Index>{1, 0, 3, 5, 4});
}

namespace {

/// Label 0 within an ellipse that is a circle on the ground, about the middle of n by n cells of dx by dy metres.
double perimeter_of_circle(Index n, double radius_m, double dx_m, double dy_m) {
    const Grid grid = plane_grid(n, n, dx_m, dy_m);
    std::vector<Index> label;
    for (Index node = 0; node < grid.size(); ++node) {
        const double x = (grid.col(node) + 0.5 - 0.5 * n) * dx_m, y = (grid.row(node) + 0.5 - 0.5 * n) * dy_m;
        label.push_back(std::hypot(x, y) <= radius_m ? 0 : none);
    }
    return basin_perimeters(grid, label, 1).at(0);
}

/// Length of the divide of a half plane whose border runs at `angle` through the middle of a disc of cells, over the
/// disc's diameter.
double slanting_border(double angle) {
    const Index n = 401;
    const Grid grid = plane_grid(n, n, 1, 1);
    std::vector<Index> label;
    for (Index node = 0; node < grid.size(); ++node) {
        const double x = grid.col(node) - 200.0, y = grid.row(node) - 200.0;
        const bool above = y * std::cos(angle) - x * std::sin(angle) > 0.3;
        label.push_back(std::hypot(x, y) > 180 ? none : above ? 0 : 1);
    }
    // Each half has the border and half of the rim, which is as long by this count as the whole disc's less the border.
    std::vector<Index> whole = label;
    for (Index& basin : whole) basin = basin == none ? none : 0;
    const auto halves = basin_perimeters(grid, label, 2);
    return (halves[0] + halves[1] - basin_perimeters(grid, whole, 1)[0]) / 2 / 360;
}

}  // namespace

TEST_CASE("a circle's perimeter is right to discretisation, on oblong cells too") {
    const double exact = 2 * std::numbers::pi * 1000;
    CHECK(perimeter_of_circle(120, 1000, 20, 20) == Approx(exact).epsilon(0.02));
    CHECK(perimeter_of_circle(480, 1000, 5, 5) == Approx(exact).epsilon(0.004));
    CHECK(perimeter_of_circle(480, 1000, 5, 8) == Approx(exact).epsilon(0.01));
    CHECK(perimeter_of_circle(480, 1000, 8, 5) == Approx(exact).epsilon(0.01));
}

TEST_CASE("straight borders are right on average over their directions, and off by what the header says") {
    CHECK(slanting_border(0) == Approx(0.948).margin(0.004));
    CHECK(slanting_border(std::numbers::pi / 8) == Approx(1.026).margin(0.006));
    double sum = 0;
    constexpr int angles = 64;
    for (int i = 0; i < angles; ++i) sum += slanting_border(std::numbers::pi * i / angles);
    CHECK(sum / angles == Approx(1).margin(0.005));
}

TEST_CASE("a basin at the edge of the grid has a divide there, and a row of another width its own") {
    const std::vector<Index> all(12, 0);
    const double inside = basin_perimeters(plane_grid(3, 4, 10, 10), all, 1)[0];
    std::vector<Index> framed(30, none);
    for (Index r = 0; r < 3; ++r) {
        for (Index c = 0; c < 4; ++c) framed[(r + 1) * 6 + c + 1] = 0;
    }
    CHECK(basin_perimeters(plane_grid(5, 6, 10, 10), framed, 1)[0] == Approx(inside).epsilon(1e-14));
    Grid wide = plane_grid(3, 4, 10, 10);
    for (double& width : wide.east_west) width = 20;
    CHECK(basin_perimeters(wide, all, 1)[0] == Approx(basin_perimeters(plane_grid(3, 4, 20, 10), all, 1)[0]));
}
