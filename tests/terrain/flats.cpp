// SPDX-License-Identifier: GPL-3.0-or-later
#include "thalweg/terrain/flats.hpp"

#include <catch2/catch.hpp>
#include <limits>
#include <tuple>

#include "support/drawing.hpp"
#include "support/terrain_oracles.hpp"
#include "support/terrains.hpp"
#include "thalweg/core/parallel.hpp"
#include "thalweg/terrain/lakes.hpp"
#include "thalweg/terrain/route.hpp"

using namespace thalweg;
using namespace thalweg::terrain;
using namespace thalweg::support;

namespace {

struct Resolved {
    FlowDirections directions;
    Index cells;
};

Resolved resolved(const Grid& grid, std::span<const double> z, std::span<const Boundary> boundary) {
    FlowDirections directions = route(grid, z, boundary);
    const Index cells = resolve_flats(grid, z, boundary, directions);
    return {std::move(directions), cells};
}

/// Steps from the seeds (0 there) by relaxing until nothing changes; far above any count where there is no way.
std::vector<int> relaxed_steps(const Grid& grid, const std::vector<int>& stuck, const std::vector<int>& seed) {
    std::vector<int> steps(grid.size());
    for (Index node = 0; node < grid.size(); ++node) steps[node] = seed[node] ? 0 : 1'000'000;
    for (bool changed = true; changed;) {
        changed = false;
        for (Index node = 0; node < grid.size(); ++node) {
            grid.neighbors(node, [&](Index other, double, Slot) {
                if (!stuck[node] || !stuck[other] || steps[other] + 1 >= steps[node]) return;
                steps[node] = steps[other] + 1;
                changed = true;
            });
        }
    }
    return steps;
}

/// Steps of each stuck cell from the nearest way out and from the nearest higher cell.
struct Gradients {
    std::vector<int> stuck, to_exit, from_higher;
};

Gradients gradients(const Grid& grid, std::span<const double> z, std::span<const Boundary> boundary,
                    const FlowDirections& routed) {
    std::vector<int> stuck(grid.size()), exit(grid.size(), 0), rim(grid.size(), 0);
    for (Index node = 0; node < grid.size(); ++node) {
        stuck[node] = routed[node] == no_flow && boundary[node] == Boundary::interior && !std::isnan(z[node]);
    }
    for (Index node = 0; node < grid.size(); ++node) {
        grid.neighbors(node, [&](Index other, double, Slot) {
            if (!stuck[node]) return;
            if (z[other] == z[node] && !stuck[other]) exit[node] = 1;
            if (z[other] > z[node]) rim[node] = 1;
        });
    }
    return {stuck, relaxed_steps(grid, stuck, exit), relaxed_steps(grid, stuck, rim)};
}

/// Of two level neighbours, whether the first is the one to flow to by the gradients.
bool better(std::pair<int, Slot> a, std::pair<int, Slot> b) {
    return std::tuple(a.first, a.second % 2, a.second) < std::tuple(b.first, b.second % 2, b.second);
}

/// Whether a stuck cell flows where the gradients say (nowhere, if its flat has no way out).
bool flows_by_gradients(const TestTerrain& terrain, const Gradients& steps, const FlowDirections& directions,
                        Index node) {
    std::pair<int, Slot> best{std::numeric_limits<int>::max(), no_flow};
    terrain.grid.neighbors(node, [&](Index other, double, Slot slot) {
        if (terrain.elevation_m[other] != terrain.elevation_m[node]) return;
        const int surface =
            steps.stuck[other] ? 2 * steps.to_exit[other] - std::min(steps.from_higher[other], 1000) : -1'000'000;
        if (better({surface, slot}, best)) best = {surface, slot};
    });
    return directions[node] == (steps.to_exit[node] < 1'000'000 ? best.second : no_flow);
}

void check_by_gradients(const TestTerrain& terrain, const std::vector<Boundary>& boundary) {
    const FlowDirections before = route(terrain.grid, terrain.elevation_m, boundary);
    const Gradients steps = gradients(terrain.grid, terrain.elevation_m, boundary, before);
    const auto [directions, cells] = resolved(terrain.grid, terrain.elevation_m, boundary);
    Index stuck = 0, wrong = 0, moved = 0, given = 0;
    for (Index node = 0; node < terrain.grid.size(); ++node) {
        moved += !steps.stuck[node] && directions[node] != before[node];
        stuck += steps.stuck[node];
        given += steps.stuck[node] && directions[node] != no_flow;
        wrong += steps.stuck[node] && !flows_by_gradients(terrain, steps, directions, node);
    }
    CHECK(stuck > 0);
    CHECK(given == cells);
    REQUIRE(wrong == 0);
    REQUIRE(moved == 0);
}

}  // namespace

TEST_CASE("a drawn flat flows to its only way out and away from the higher rim") {
    // The flat of 2s drains through the 1 in the east. Along the walls water first turns to the middle; the last
    // stuck column goes straight to the cells that flow.
    const Drawing drawing = draw(R"(
        9 9 9 9 9 9 9
        9 2 2 2 2 2 9
        9 2 2 2 2 2 1
        9 2 2 2 2 2 9
        9 9 9 9 9 9 9)");
    const Grid grid = plane_grid(drawing.rows, drawing.cols, 1, 1);
    const auto [directions, cells] = resolved(grid, drawing.values, data_edge(grid, drawing.values));
    CHECK(cells == 12);
    const FlowDirections expected = draw_directions(R"(
        1 v v v v v 3
        > 1 1 1 > 1 v
        > > > > > > .
        > 7 7 7 > 7 ^
        7 ^ ^ ^ ^ ^ 5)");
    CHECK(show_directions(directions, 7) == show_directions(expected, 7));
}

TEST_CASE("a flat that reaches the edge leaves there, and its edge cells are outlets") {
    const Grid grid = plane_grid(4, 5, 1, 1);
    const Drawing drawing = draw(R"(
        9 9 9 9 9
        9 2 2 2 2
        9 2 2 2 9
        9 9 9 9 9)");
    const auto [directions, cells] = resolved(grid, drawing.values, data_edge(grid, drawing.values));
    CHECK(cells == 6);
    CHECK(directions[9] == no_flow);
    for (const Index node : {6, 7, 8, 11, 12, 13}) CHECK(end_of_flow(grid, directions, node) == 9);
}

TEST_CASE("a flat without a way out stays as it is") {
    const Drawing drawing = draw(R"(
        9 9 9 9 9
        9 2 2 2 9
        9 9 9 9 9)");
    const Grid grid = plane_grid(3, 5, 1, 1);
    const auto [directions, cells] = resolved(grid, drawing.values, data_edge(grid, drawing.values));
    CHECK(cells == 0);
    for (const Index node : {6, 7, 8}) CHECK(directions[node] == no_flow);
}

TEST_CASE("two flats of one height that only touch the same lower cell do not mix") {
    const Drawing drawing = draw(R"(
        9 9 9 9 9 9 9
        9 2 2 1 2 2 9
        9 9 9 0 9 9 9)");
    const Grid grid = plane_grid(3, 7, 1, 1);
    const auto [directions, cells] = resolved(grid, drawing.values, data_edge(grid, drawing.values));
    CHECK(cells == 2);
    CHECK(directions[8] == 0);
    CHECK(directions[12] == 4);
}

TEST_CASE("on filled terrain every cell then drains to the edge without loops and never uphill") {
    std::vector<TestTerrain> terrains = shaped_terrains();
    for (std::uint64_t seed = 1; seed <= 60; ++seed) {
        for (TestTerrain& terrain : assorted_terrains(seed)) terrains.push_back(std::move(terrain));
        terrains.push_back(stepped_terrain(40, 37, 2, seed));
    }
    for (const TestTerrain& terrain : terrains) {
        INFO(terrain.name << " " << terrain.grid.rows << " x " << terrain.grid.cols);
        const auto boundary = data_edge(terrain.grid, terrain.elevation_m);
        const std::vector<double> z = fill(terrain.grid, terrain.elevation_m, boundary);
        const FlowDirections before = route(terrain.grid, z, boundary);
        const auto [directions, cells] = resolved(terrain.grid, z, boundary);
        Index changed = 0;
        for (Index node = 0; node < terrain.grid.size(); ++node) {
            if (before[node] != no_flow) REQUIRE(directions[node] == before[node]);
            if (std::isnan(z[node])) {
                REQUIRE(directions[node] == no_flow);
                continue;
            }
            changed += directions[node] != before[node];
            const Index end = end_of_flow(terrain.grid, directions, node);
            REQUIRE(end != none);
            REQUIRE(boundary[end] == Boundary::open);
            REQUIRE(z[end] <= z[node]);
            if (directions[node] != no_flow) REQUIRE(z[terrain.grid.neighbor(node, directions[node])] <= z[node]);
        }
        REQUIRE(changed == cells);
    }
}

TEST_CASE("on any terrain the flats that can leave flow as the two gradients say, and only those") {
    for (std::uint64_t seed = 1; seed <= 80; ++seed) {
        const TestTerrain terrain = with_holes(stepped_terrain(14, 15, 2 + seed % 3, seed), 0.1, seed);
        auto boundary = data_edge(terrain.grid, terrain.elevation_m);
        Random random(seed, 10);
        for (Boundary& b : boundary) {
            if (random.uniform() < 0.3) b = random.uniform() < 0.1 ? Boundary::base_level : Boundary::interior;
        }
        INFO(terrain.name);
        check_by_gradients(terrain, boundary);
    }
}

TEST_CASE("flats that lie in several strips of rows flow as the two gradients say") {
    // Work is shared by strips of at least 65 536 cells: here two to eight, down to three rows each, and of whatever
    // shape chance gives the flats on their borders, in pieces that hang together only beyond.
    for (std::uint64_t seed = 1; seed <= 3; ++seed) {
        for (const auto& [rows, cols] : {std::pair<Index, Index>{70, 2000}, {24, 22000}, {600, 300}}) {
            const TestTerrain terrain = with_holes(stepped_terrain(rows, cols, 2 + seed, seed), 0.02, seed);
            INFO(terrain.name << " " << rows << " x " << cols);
            check_by_gradients(terrain, data_edge(terrain.grid, terrain.elevation_m));
            const std::vector<double> z =
                fill(terrain.grid, terrain.elevation_m, data_edge(terrain.grid, terrain.elevation_m));
            check_by_gradients({"filled", terrain.grid, z}, data_edge(terrain.grid, z));
        }
    }
}

TEST_CASE("flats get the same directions on one thread and on two") {
    const TestTerrain terrain = stepped_terrain(250, 250, 3, 5);
    const auto boundary = data_edge(terrain.grid, terrain.elevation_m);
    const auto with_threads = [&](int threads) {
        const ThreadLimit limit(threads);
        const std::vector<double> z = fill(terrain.grid, terrain.elevation_m, boundary);
        return resolved(terrain.grid, z, boundary).directions;
    };
    CHECK(with_threads(1) == with_threads(2));
}
