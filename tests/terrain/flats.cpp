// SPDX-License-Identifier: GPL-3.0-or-later
#include "thalweg/terrain/flats.hpp"

#include <catch2/catch.hpp>

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
        const Grid& grid = terrain.grid;
        const std::vector<double>& z = terrain.elevation_m;
        auto boundary = data_edge(grid, z);
        Random random(seed, 10);
        for (Boundary& b : boundary) {
            if (random.uniform() < 0.3) b = random.uniform() < 0.1 ? Boundary::base_level : Boundary::interior;
        }
        const FlowDirections before = route(grid, z, boundary);
        const Gradients steps = gradients(grid, z, boundary, before);
        const auto [directions, cells] = resolved(grid, z, boundary);
        const auto surface = [&](Index node) {
            if (!steps.stuck[node]) return -1'000'000;
            return 2 * steps.to_exit[node] - std::min(steps.from_higher[node], 1000);
        };
        for (Index node = 0; node < grid.size(); ++node) {
            if (!steps.stuck[node]) continue;
            REQUIRE((directions[node] != no_flow) == (steps.to_exit[node] < 1000));
            REQUIRE(end_of_flow(grid, directions, node) != none);
            if (directions[node] == no_flow) continue;
            const Index chosen = grid.neighbor(node, directions[node]);
            REQUIRE(z[chosen] == z[node]);
            grid.neighbors(node, [&](Index other, double, Slot slot) {
                if (z[other] != z[node]) return;
                REQUIRE(surface(chosen) <= surface(other));
                const bool straighter = directions[node] % 2 <= slot % 2;
                if (surface(chosen) == surface(other)) REQUIRE(straighter);
            });
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
