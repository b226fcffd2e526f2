// SPDX-License-Identifier: GPL-3.0-or-later
#include "thalweg/terrain/lakes.hpp"

#include <catch2/catch.hpp>
#include <cstring>
#include <iterator>
#include <set>

#include "support/drawing.hpp"
#include "support/terrain_oracles.hpp"
#include "support/terrains.hpp"
#include "thalweg/core/parallel.hpp"
#include "thalweg/terrain/accumulate.hpp"
#include "thalweg/terrain/flats.hpp"

using namespace thalweg;
using namespace thalweg::terrain;
using namespace thalweg::support;

namespace {

bool same_bytes(const std::vector<double>& a, const std::vector<double>& b) {
    return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size() * sizeof(double)) == 0;
}

/// Interior but for a few cells, so that many pieces have one outlet or none.
std::vector<Boundary> sparse_boundary(Index nodes, std::uint64_t seed) {
    Random random(seed, 8);
    std::vector<Boundary> boundary(nodes, Boundary::interior);
    for (Boundary& b : boundary) {
        if (random.uniform() < 0.03) b = random.uniform() < 0.5 ? Boundary::open : Boundary::base_level;
    }
    return boundary;
}

/// Calls check(topology, heights, boundary) for hundreds of terrains, each as grid and as mesh, with the edge open and
/// with few outlets.
template <class Check>
void for_many_terrains(Check check) {
    std::vector<TestTerrain> terrains = shaped_terrains();
    for (std::uint64_t seed = 1; seed <= 40; ++seed) {
        for (TestTerrain& terrain : assorted_terrains(seed)) terrains.push_back(std::move(terrain));
    }
    std::uint64_t seed = 0;
    for (const TestTerrain& terrain : terrains) {
        const Mesh mesh = mesh_of(terrain.grid);
        const std::vector<double>& z = terrain.elevation_m;
        for (const auto& boundary : {data_edge(terrain.grid, z), sparse_boundary(terrain.grid.size(), ++seed)}) {
            INFO(terrain.name << " " << terrain.grid.rows << " x " << terrain.grid.cols << ", " << seed);
            check(terrain.grid, z, boundary);
            check(mesh, z, boundary);
        }
    }
}

/// Lakes counted by the definition: flats (connected, of one height) that hold water, that is whose filled level is
/// above them, have no lower neighbour.
template <Topology T>
Index count_pits(const T& topology, std::span<const double> z, std::span<const double> level) {
    std::vector<int> seen(topology.size(), 0);
    Index pits = 0;
    for (Index start = 0; start < topology.size(); ++start) {
        if (seen[start] || !(level[start] > z[start])) continue;
        bool lowest = true;
        std::vector<Index> flat{start};
        seen[start] = 1;
        for (std::size_t i = 0; i < flat.size(); ++i) {
            topology.neighbors(flat[i], [&](Index other, double, Slot) {
                if (z[other] < z[start]) lowest = false;
                if (seen[other] || z[other] != z[start]) return;
                seen[other] = 1;
                flat.push_back(other);
            });
        }
        pits += lowest;
    }
    return pits;
}

/// Highest point of the way from a node to its outlet.
template <Topology T>
double highest_on_way(const T& topology, std::span<const double> z, const FlowDirections& directions, Index node) {
    double highest = z[node];
    while (directions[node] != no_flow) {
        node = topology.neighbor(node, directions[node]);
        highest = std::max(highest, z[node]);
    }
    return highest;
}

}  // namespace

TEST_CASE("a drawn lake fills to its lower pass") {
    const Drawing drawing = draw(R"(
        9 9 9 9 9 9
        9 2 3 6 1 9
        9 1 4 5 0 7
        9 9 9 9 9 9)");
    const Drawing expected = draw(R"(
        9 9 9 9 9 9
        9 7 7 7 7 9
        9 7 7 7 7 7
        9 9 9 9 9 9)");
    const Grid grid = plane_grid(drawing.rows, drawing.cols, 1, 1);
    CHECK(fill(grid, drawing.values, data_edge(grid, drawing.values)) == expected.values);
}

TEST_CASE("two drawn lakes drain over their passes, one through the other") {
    const Drawing drawing = draw("9 3 6 2 1 7 4 0");
    const Grid grid = plane_grid(1, 8, 1, 1);
    std::vector<Boundary> boundary(8, Boundary::interior);
    boundary[7] = Boundary::base_level;
    FlowDirections directions = route(grid, drawing.values, boundary);
    CHECK(show_directions(directions, 8) == "> . > > . < > .\n");
    CHECK(drain_lakes(grid, drawing.values, boundary, directions) == 2);
    CHECK(show_directions(directions, 8) == "> > > > > > > .\n");
    CHECK(fill(grid, drawing.values, boundary) == std::vector<double>{9, 7, 7, 7, 7, 7, 4, 0});
}

TEST_CASE("a lake spills out of an open cell at the cell's own height") {
    const Drawing drawing = draw("9 5 1 3 9");
    const Grid grid = plane_grid(1, 5, 1, 1);
    std::vector<Boundary> boundary(5, Boundary::interior);
    boundary[3] = Boundary::open;
    FlowDirections directions = route(grid, drawing.values, boundary);
    CHECK(show_directions(directions, 5) == "> > . < <\n");
    CHECK(drain_lakes(grid, drawing.values, boundary, directions) == 1);
    CHECK(show_directions(directions, 5) == "> > > . <\n");
    CHECK(fill(grid, drawing.values, boundary) == std::vector<double>{9, 5, 3, 3, 9});
}

TEST_CASE("a piece without outlet drains at its lowest node, the first of equals") {
    const Drawing drawing = draw("4 2 5 2 3 # 7 # 1 0");
    const Grid grid = plane_grid(1, 10, 1, 1);
    std::vector<Boundary> boundary(10, Boundary::interior);
    boundary[9] = Boundary::base_level;
    FlowDirections directions = route(grid, drawing.values, boundary);
    CHECK(drain_lakes(grid, drawing.values, boundary, directions) == 1);
    CHECK(show_directions(directions, 10) == "> . < < < . . . > .\n");
    const std::vector<double> level = fill(grid, drawing.values, boundary);
    CHECK(std::vector<double>(level.begin(), level.begin() + 5) == std::vector<double>{4, 2, 5, 5, 5});
    CHECK(level[6] == 7);
}

TEST_CASE("a flat is one lake, and none if the water leaves at its own height") {
    const Grid grid = plane_grid(3, 5, 1, 1);
    const Drawing closed = draw(R"(
        1 9 1 9 1
        1 9 1 9 1
        9 1 9 1 9)");
    const auto lakes = [&](const Drawing& drawing, std::vector<Boundary> boundary) {
        FlowDirections directions = route(grid, drawing.values, boundary);
        return drain_lakes(grid, drawing.values, boundary, directions);
    };
    std::vector<Boundary> boundary(15, Boundary::interior);
    boundary[3] = Boundary::base_level;
    CHECK(lakes(closed, boundary) == 1);
    boundary[3] = Boundary::interior;
    boundary[4] = Boundary::base_level;
    CHECK(lakes(closed, boundary) == 0);
}

TEST_CASE("the filled surface is that of the slow filler and of a priority flood, cell for cell") {
    for_many_terrains([](const auto& topology, const std::vector<double>& z, const std::vector<Boundary>& boundary) {
        const std::vector<double> level = fill(topology, z, boundary);
        REQUIRE(same_bytes(level, fill_by_iteration(topology, z, boundary)));
        REQUIRE(same_bytes(level, fill_by_priority_flood(topology, z, boundary)));
    });
}

TEST_CASE("filling twice changes nothing") {
    for_many_terrains([](const auto& topology, const std::vector<double>& z, const std::vector<Boundary>& boundary) {
        const std::vector<double> level = fill(topology, z, boundary);
        REQUIRE(same_bytes(fill(topology, level, boundary), level));
    });
}

TEST_CASE("with lakes drained every node reaches an outlet, without loops, never above its water level") {
    for_many_terrains([](const auto& topology, const std::vector<double>& z, const std::vector<Boundary>& boundary) {
        FlowDirections directions = route(topology, z, boundary);
        drain_lakes(topology, z, boundary, directions);
        const std::vector<Index> found = outlets_by_search(topology, z, boundary);
        const std::set<Index> outlets(found.begin(), found.end());
        const std::vector<double> level = fill_by_priority_flood(topology, z, boundary);
        for (Index node = 0; node < topology.size(); ++node) {
            if (std::isnan(z[node])) {
                REQUIRE(directions[node] == no_flow);
                continue;
            }
            const Index end = end_of_flow(topology, directions, node);
            REQUIRE(end != none);
            REQUIRE(outlets.contains(end));
            REQUIRE(highest_on_way(topology, z, directions, node) == level[node]);
        }
    });
}

TEST_CASE("only water in lakes is led over passes: elsewhere the steepest descent stays") {
    for_many_terrains([](const auto& topology, const std::vector<double>& z, const std::vector<Boundary>& boundary) {
        const FlowDirections before = route(topology, z, boundary);
        FlowDirections directions = before;
        drain_lakes(topology, z, boundary, directions);
        const std::vector<double> level = fill_by_priority_flood(topology, z, boundary);
        for (Index node = 0; node < topology.size(); ++node) {
            const Index end = end_of_flow(topology, before, node);
            const bool reached_outlet = std::isnan(z[end]) || boundary[end] != Boundary::interior;
            if (reached_outlet) REQUIRE(directions[node] == before[node]);
            if (boundary[node] == Boundary::base_level) REQUIRE(directions[node] == no_flow);
        }
    });
}

TEST_CASE("lakes are counted as the flats that hold water") {
    for_many_terrains([](const auto& topology, const std::vector<double>& z, const std::vector<Boundary>& boundary) {
        FlowDirections directions = route(topology, z, boundary);
        const Index lakes = drain_lakes(topology, z, boundary, directions);
        REQUIRE(lakes == count_pits(topology, z, fill_by_priority_flood(topology, z, boundary)));
    });
}

TEST_CASE("all the area leaves at the outlets") {
    for_many_terrains([](const auto& topology, const std::vector<double>& z, const std::vector<Boundary>& boundary) {
        FlowDirections directions = route(topology, z, boundary);
        drain_lakes(topology, z, boundary, directions);
        const FlowGraph graph = flow_graph(topology, z, directions);
        const std::vector<double> nodes = accumulate(graph, std::vector<double>(topology.size(), 1.0));
        double leaving = 0;
        double with_data = 0;
        for (Index node = 0; node < topology.size(); ++node) {
            if (graph.receiver[node] == none) leaving += nodes[node];
            with_data += !std::isnan(z[node]);
        }
        REQUIRE(leaving == with_data);
    });
}

TEST_CASE("a second call finds nothing to do") {
    for_many_terrains([](const auto& topology, const std::vector<double>& z, const std::vector<Boundary>& boundary) {
        const std::vector<Index> found = outlets_by_search(topology, z, boundary);
        std::vector<Boundary> with_outlets = boundary;
        for (const Index node : found) with_outlets[node] = Boundary::open;
        FlowDirections directions = route(topology, z, with_outlets);
        drain_lakes(topology, z, with_outlets, directions);
        const FlowDirections first = directions;
        REQUIRE(drain_lakes(topology, z, with_outlets, directions) == 0);
        REQUIRE(directions == first);
    });
}

TEST_CASE("grid and mesh of one graph fill alike and find as many lakes") {
    for (std::uint64_t seed = 1; seed <= 60; ++seed) {
        for (const TestTerrain& terrain : assorted_terrains(seed)) {
            const Mesh mesh = mesh_of(terrain.grid);
            const std::vector<double>& z = terrain.elevation_m;
            const auto boundary = sparse_boundary(mesh.size(), seed);
            CHECK(same_bytes(fill(mesh, z, boundary), fill(terrain.grid, z, boundary)));
            FlowDirections of_mesh = route(mesh, z, boundary);
            FlowDirections of_grid = route(terrain.grid, z, boundary);
            CHECK(drain_lakes(mesh, z, boundary, of_mesh) == drain_lakes(terrain.grid, z, boundary, of_grid));
        }
    }
}

TEST_CASE("lakes come out in the same bytes on one thread and on two") {
    const TestTerrain terrain = with_holes(stepped_terrain(300, 400, 50, 3), 0.01, 3);
    const auto boundary = data_edge(terrain.grid, terrain.elevation_m);
    const auto with_threads = [&](int threads) {
        const ThreadLimit limit(threads);
        FlowDirections directions = route(terrain.grid, terrain.elevation_m, boundary);
        drain_lakes(terrain.grid, terrain.elevation_m, boundary, directions);
        return std::pair(directions, fill(terrain.grid, terrain.elevation_m, boundary));
    };
    const auto [directions1, level1] = with_threads(1);
    const auto [directions2, level2] = with_threads(2);
    CHECK(directions1 == directions2);
    CHECK(same_bytes(level1, level2));
    CHECK(same_bytes(level1, fill_by_priority_flood(terrain.grid, terrain.elevation_m, boundary)));
}

TEST_CASE("what drains and fills at once gives the bytes of each alone") {
    std::vector<TestTerrain> terrains = shaped_terrains();
    for (std::uint64_t seed = 1; seed <= 20; ++seed)
        std::ranges::move(assorted_terrains(seed), std::back_inserter(terrains));
    terrains.push_back(with_holes(stepped_terrain(300, 400, 50, 3), 0.01, 3));
    for (const auto& [name, grid, z] : terrains) {
        INFO(name);
        const auto boundary = data_edge(grid, z);
        FlowDirections alone = route(grid, z, boundary);
        resolve_flats(grid, z, boundary, alone);
        FlowDirections together = alone;
        const Index lakes = drain_lakes(grid, z, boundary, alone);
        const DrainedAndFilled both = drain_and_fill(grid, z, boundary, together);
        REQUIRE(both.lakes == lakes);
        REQUIRE(together == alone);
        REQUIRE(same_bytes(both.filled_m, fill(grid, z, boundary)));
    }
}

TEST_CASE("larger worst cases fill as a priority flood does") {
    for (const TestTerrain& terrain : {noise_terrain(250, 301, 9), bowl_of_bowls(301, 251), comb(200, 301)}) {
        INFO(terrain.name);
        const auto boundary = data_edge(terrain.grid, terrain.elevation_m);
        CHECK(same_bytes(fill(terrain.grid, terrain.elevation_m, boundary),
                         fill_by_priority_flood(terrain.grid, terrain.elevation_m, boundary)));
    }
}
