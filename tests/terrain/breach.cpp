// SPDX-License-Identifier: GPL-3.0-or-later
#include "thalweg/terrain/breach.hpp"

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <limits>
#include <set>
#include <tuple>

#include "support/drawing.hpp"
#include "support/terrains.hpp"
#include "thalweg/terrain/lakes.hpp"
#include "thalweg/terrain/route.hpp"

using namespace thalweg;
using namespace thalweg::terrain;
using support::draw;
using support::TestTerrain;

namespace {

std::vector<double> breached(const TestTerrain& t, const BreachLimits& limits = {}) {
    return breach(t.grid, t.elevation_m, data_edge(t.grid, t.elevation_m), limits);
}

/// The same by brute force: ways are improved over all edges until nothing changes (Bellman & Ford), from every cell
/// without a lower neighbour, lowest first, whether or not it needs one.
std::vector<double> breached_by_force(const Grid& grid, std::vector<double> z, const std::vector<Boundary>& boundary) {
    using Cost = std::tuple<double, double, Index>;  // cost, length, where from
    std::vector<Index> cells;
    for (Index node = 0; node < grid.size(); ++node) {
        if (!std::isnan(z[node]) && boundary[node] == Boundary::interior) cells.push_back(node);
    }
    std::sort(cells.begin(), cells.end(), [&](Index a, Index b) { return std::pair(z[a], a) < std::pair(z[b], b); });
    for (const Index pit : cells) {
        bool falls = false;
        grid.neighbors(pit, [&](Index n, double, Slot) { falls = falls || z[n] < z[pit]; });
        if (falls) continue;
        const auto is_end = [&](Index n) { return z[n] < z[pit] || boundary[n] != Boundary::interior; };
        const double far = std::numeric_limits<double>::infinity();
        std::vector<Cost> best(grid.size(), Cost{far, far, none});
        best[pit] = {0, 0, none};
        for (bool changed = true; changed;) {
            changed = false;
            for (Index node = 0; node < grid.size(); ++node) {
                const auto [cost, length, from] = best[node];
                if (cost == far || is_end(node)) continue;
                grid.neighbors(node, [&, cost = cost, length = length](Index n, double step, Slot) {
                    if (std::isnan(z[n])) return;
                    const Cost way{cost + step * std::max(0.0, z[n] - z[pit]), length + step, node};
                    if (way < best[n]) best[n] = way, changed = true;
                });
            }
        }
        Index end = none;
        for (Index node = 0; node < grid.size(); ++node) {
            if (std::isnan(z[node]) || !is_end(node) || std::get<0>(best[node]) == far) continue;
            const auto key = [&](Index n) { return std::tuple(std::get<0>(best[n]), std::get<1>(best[n]), n); };
            if (end == none || key(node) < key(end)) end = node;
        }
        const double height = z[pit];
        for (Index node = end; node != none; node = std::get<2>(best[node])) z[node] = std::min(z[node], height);
    }
    return z;
}

std::vector<TestTerrain> many_terrains() {
    std::vector<TestTerrain> terrains;
    for (std::uint64_t seed = 0; seed < 25; ++seed) {
        terrains.push_back(support::noise_terrain(11, 13, seed));
        terrains.push_back(support::stepped_terrain(12, 10, 4, seed));
        terrains.push_back(support::with_holes(support::noise_terrain(12, 12, seed + 100), 0.05, seed));
        terrains.push_back(support::with_holes(support::stepped_terrain(12, 12, 6, seed), 0.03, seed));
    }
    terrains.push_back(support::bowl(11, 12));
    terrains.push_back(support::flat_terrain(5, 6));
    return terrains;
}

}  // namespace

TEST_CASE("A drawn pit is led out where the least is cut away, not over the lowest pass", "[breach]") {
    // To the west the pass is 6 m high but four cells wide, to the east 8 m high and one cell wide; the cut costs
    // 4 + 4 + 4 + 4 there, 6 here, and ends in the lower ground beyond.
    const auto d = draw(R"(
        9 9 9 9 9 9 9 9 9 9
        0 6 6 6 6 2 8 1 0 0
        9 9 9 9 9 9 9 9 9 9)");
    const auto expected = draw(R"(
        9 9 9 9 9 9 9 9 9 9
        0 6 6 6 6 2 2 1 0 0
        9 9 9 9 9 9 9 9 9 9)");
    const TestTerrain t{"drawn", plane_grid(d.rows, d.cols, 1, 1), d.values};
    CHECK(breached(t) == expected.values);
    CHECK(breached(t, {.depth_m = 6}) == expected.values);
    CHECK(breached(t, {.depth_m = 5})[1 * 10 + 6] == 8);  // then the way west is the cheapest that is left
    CHECK(breached(t, {.depth_m = 5})[1 * 10 + 1] == 2);
    CHECK(breached(t, {.depth_m = 3}) == d.values);
    CHECK(breached(t, {.length_m = 2}) == expected.values);
    CHECK(breached(t, {.length_m = 1.9})[1 * 10 + 6] == 8);
    CHECK(breached(t, {.length_m = 0.9}) == d.values);
}

TEST_CASE("The breached surface equals that of a brute-force search, cell for cell", "[breach]") {
    for (const TestTerrain& t : many_terrains()) {
        INFO(t.name);
        const auto boundary = data_edge(t.grid, t.elevation_m);
        const auto found = breach(t.grid, t.elevation_m, boundary);
        const auto expected = breached_by_force(t.grid, t.elevation_m, boundary);
        for (Index node = 0; node < t.grid.size(); ++node) {
            if (!std::isnan(t.elevation_m[node])) REQUIRE(found[node] == expected[node]);
        }
    }
}

TEST_CASE("After breaching nothing is left to be filled, and nothing was raised", "[breach]") {
    for (TestTerrain t : many_terrains()) {
        INFO(t.name);
        for (double& height : t.elevation_m) height *= 10;
        const auto boundary = data_edge(t.grid, t.elevation_m);
        const auto surface = breach(t.grid, t.elevation_m, boundary);
        const auto filled = fill(t.grid, surface, boundary);
        const auto deeper = breach(t.grid, t.elevation_m, boundary, {.depth_m = 3});
        for (Index node = 0; node < t.grid.size(); ++node) {
            if (std::isnan(t.elevation_m[node])) {
                REQUIRE(std::isnan(surface[node]));
                continue;
            }
            REQUIRE(filled[node] == surface[node]);
            REQUIRE(surface[node] <= t.elevation_m[node]);
            REQUIRE(deeper[node] <= t.elevation_m[node]);
        }
    }
}

TEST_CASE("A flat lake is led out once, by the shortest of equal ways", "[breach]") {
    const auto d = draw(R"(
        9 9 9 9 9 9 9
        9 3 3 3 3 5 0
        9 3 3 3 3 9 9
        9 3 3 3 3 9 9
        9 9 9 9 9 9 9)");
    const TestTerrain t{"lake", plane_grid(d.rows, d.cols, 1, 1), d.values};
    auto expected = d.values;
    expected[1 * 7 + 5] = 3;
    CHECK(breached(t) == expected);
}

TEST_CASE("Cuts that cost as much again are chosen by length on the ground, also of oblong cells", "[breach]") {
    const auto d = draw(R"(
        0 9 9 9 0
        9 9 4 9 9
        9 4 1 4 9
        9 9 4 9 9
        0 9 9 9 0)");
    // East and west the cells are three times as long, so the way through the 4 above and below costs less.
    const TestTerrain t{"cross", plane_grid(d.rows, d.cols, 3, 1), d.values};
    const auto surface = breached(t);
    CHECK((surface[1 * 5 + 2] == 1 || surface[3 * 5 + 2] == 1));
    CHECK(surface[2 * 5 + 1] == 4);
    CHECK(surface[2 * 5 + 3] == 4);
}

TEST_CASE("A piece of ground without an outlet stays as it is", "[breach]") {
    const TestTerrain t = support::bowl(7, 7);
    const std::vector<Boundary> closed(t.grid.size(), Boundary::interior);
    CHECK(breach(t.grid, t.elevation_m, closed) == t.elevation_m);
}
