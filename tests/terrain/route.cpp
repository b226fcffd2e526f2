// SPDX-License-Identifier: GPL-3.0-or-later
#include "thalweg/terrain/route.hpp"

#include <catch2/catch.hpp>

#include "support/drawing.hpp"
#include "support/terrains.hpp"
#include "thalweg/core/error.hpp"
#include "thalweg/core/parallel.hpp"

using namespace thalweg;
using namespace thalweg::terrain;
using namespace thalweg::support;

namespace {

/// D8 from its definition: the largest slope > 0 among the neighbours with data, the first of equals.
template <Topology T>
Slot steepest_by_definition(const T& topology, std::span<const double> z, Index node) {
    Slot best = no_flow;
    double steepest = 0;
    topology.neighbors(node, [&](Index other, double length_m, Slot slot) {
        if (std::isnan(z[node]) || std::isnan(z[other])) return;
        const double slope = (z[node] - z[other]) * (1 / length_m);
        if (slope > steepest) {
            steepest = slope;
            best = slot;
        }
    });
    return best;
}

template <Topology T>
FlowDirections route_by_definition(const T& topology, std::span<const double> z, std::span<const Boundary> boundary) {
    FlowDirections directions(topology.size(), no_flow);
    for (Index node = 0; node < topology.size(); ++node) {
        if (boundary[node] != Boundary::base_level) directions[node] = steepest_by_definition(topology, z, node);
    }
    return directions;
}

std::vector<Boundary> random_boundary(Index nodes, std::uint64_t seed) {
    Random random(seed, 7);
    std::vector<Boundary> boundary;
    for (Index node = 0; node < nodes; ++node) boundary.push_back(static_cast<Boundary>(random.below(3)));
    return boundary;
}

}  // namespace

TEST_CASE("a drawn valley flows as drawn") {
    const Drawing drawing = draw(R"(
        9 9 9 9 9
        9 6 5 6 9
        9 5 4 5 #
        9 4 2 4 9
        9 3 1 3 9)");
    const Grid grid = plane_grid(drawing.rows, drawing.cols, 1, 1);
    const auto boundary = data_edge(grid, drawing.values);
    const FlowDirections expected = draw_directions(R"(
        1 v v v 3
        > 1 v 3 <
        > 1 v 3 .
        > 1 v 3 <
        > > . < <)");
    CHECK(show_directions(route(grid, drawing.values, boundary), 5) == show_directions(expected, 5));
}

TEST_CASE("a diagonal drop counts less than a straight one by the length") {
    const Drawing drawing = draw(R"(
        9 9 9
        9 5 3
        9 9 2.5)");
    const std::vector<Boundary> boundary(9, Boundary::interior);
    CHECK(route(plane_grid(3, 3, 1, 1), drawing.values, boundary)[4] == 0);    // 2 against 2.5 / sqrt 2
    CHECK(route(plane_grid(3, 3, 2, 0.5), drawing.values, boundary)[4] == 1);  // 1 against 2.5 / sqrt 4.25
    CHECK(route(plane_grid(3, 3, 1, 1), drawing.values, boundary, Receiver::lowest)[4] == 1);
}

TEST_CASE("equal slopes go to the lower slot") {
    const Grid grid = plane_grid(3, 3, 1, 1);
    const std::vector<Boundary> boundary(9, Boundary::interior);
    const Drawing drawing = draw(R"(
        9 4 9
        4 5 4
        9 4 9)");
    CHECK(route(grid, drawing.values, boundary)[4] == 0);
    CHECK(route(grid, drawing.values, boundary, Receiver::lowest)[4] == 0);
    const Drawing without_east = draw(R"(
        9 4 9
        4 5 9
        9 4 9)");
    CHECK(route(grid, without_east.values, boundary)[4] == 2);
}

TEST_CASE("base level never flows, an open cell only downhill, a void never") {
    const Drawing drawing = draw("3 2 1 # 1 2 3");
    const Grid grid = plane_grid(1, 7, 1, 1);
    std::vector<Boundary> boundary(7, Boundary::open);
    CHECK(show_directions(route(grid, drawing.values, boundary), 7) == "> > . . . < <\n");
    boundary[1] = Boundary::base_level;
    CHECK(show_directions(route(grid, drawing.values, boundary), 7) == "> . . . . < <\n");
}

TEST_CASE("the row loop of the grid gives what the definition gives") {
    for (std::uint64_t seed = 1; seed <= 60; ++seed) {
        for (const TestTerrain& terrain : assorted_terrains(seed)) {
            INFO(terrain.name << " " << terrain.grid.rows << " x " << terrain.grid.cols);
            const auto boundary = random_boundary(terrain.grid.size(), seed);
            CHECK(route(terrain.grid, terrain.elevation_m, boundary) ==
                  route_by_definition(terrain.grid, terrain.elevation_m, boundary));
        }
    }
    const TestTerrain large = with_holes(stepped_terrain(301, 517, 40, 5), 0.02, 5);
    const auto boundary = random_boundary(large.grid.size(), 5);
    CHECK(route(large.grid, large.elevation_m, boundary) ==
          route_by_definition(large.grid, large.elevation_m, boundary));
}

TEST_CASE("a mesh is routed by the definition, and without ties like the grid it was made of") {
    for (std::uint64_t seed = 1; seed <= 20; ++seed) {
        const TestTerrain terrain = with_holes(noise_terrain(9, 11, seed), 0.1, seed);
        const Mesh mesh = mesh_of(terrain.grid);
        const auto boundary = random_boundary(mesh.size(), seed);
        for (const Receiver receiver : {Receiver::steepest, Receiver::lowest}) {
            const FlowDirections of_mesh = route(mesh, terrain.elevation_m, boundary, receiver);
            const FlowDirections of_grid = route(terrain.grid, terrain.elevation_m, boundary, receiver);
            for (Index node = 0; node < mesh.size(); ++node) {
                REQUIRE((of_mesh[node] == no_flow) == (of_grid[node] == no_flow));
                if (of_mesh[node] == no_flow) continue;
                CHECK(mesh.neighbor(node, of_mesh[node]) == terrain.grid.neighbor(node, of_grid[node]));
            }
        }
        CHECK(route(mesh, terrain.elevation_m, boundary) == route_by_definition(mesh, terrain.elevation_m, boundary));
    }
}

TEST_CASE("the lowest receiver is the lowest of the lower neighbours") {
    for (std::uint64_t seed = 1; seed <= 30; ++seed) {
        for (const TestTerrain& terrain : assorted_terrains(seed)) {
            const std::vector<Boundary> boundary(terrain.grid.size(), Boundary::interior);
            const std::vector<double>& z = terrain.elevation_m;
            const FlowDirections directions = route(terrain.grid, z, boundary, Receiver::lowest);
            for (Index node = 0; node < terrain.grid.size(); ++node) {
                double lowest = z[node];
                terrain.grid.neighbors(node, [&](Index other, double, Slot) {
                    if (z[other] < lowest) lowest = z[other];
                });
                const bool flows = directions[node] != no_flow;
                REQUIRE(flows == (lowest < z[node]));
                if (flows) CHECK(z[terrain.grid.neighbor(node, directions[node])] == lowest);
            }
        }
    }
}

TEST_CASE("routing gives the same bytes on one thread and on two") {
    const TestTerrain terrain = noise_terrain(400, 300, 11);
    const Mesh mesh = mesh_of(terrain.grid);
    const auto boundary = data_edge(terrain.grid, terrain.elevation_m);
    const auto with_threads = [&](int threads) {
        const ThreadLimit limit(threads);
        return std::pair(route(terrain.grid, terrain.elevation_m, boundary),
                         route(mesh, terrain.elevation_m, boundary));
    };
    CHECK(with_threads(1) == with_threads(2));
}

TEST_CASE("the edge of the data is open: the rim of the grid and what lies beside a void") {
    const Drawing drawing = draw(R"(
        1 1 1 1 1
        1 1 1 1 1
        1 1 1 1 1
        1 1 1 1 #
        1 1 1 1 1
        1 1 1 1 1)");
    const std::string expected = "ooooo o...o o..oo o..o. o..oo ooooo";
    std::string seen;
    const auto boundary = data_edge(plane_grid(6, 5, 1, 1), drawing.values);
    for (Index node = 0; node < boundary.size(); ++node) {
        if (node > 0 && node % 5 == 0) seen += ' ';
        seen += boundary[node] == Boundary::open ? 'o' : '.';
    }
    CHECK(seen == expected);
}

TEST_CASE("arrays of the wrong size are refused") {
    const Grid grid = plane_grid(3, 3, 1, 1);
    const std::vector<double> heights(9, 0);
    CHECK_THROWS_AS(route(grid, heights, std::vector<Boundary>(8)), Error);
    CHECK_THROWS_AS(route(grid, std::vector<double>(8), std::vector<Boundary>(9)), Error);
}
