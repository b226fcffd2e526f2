// SPDX-License-Identifier: GPL-3.0-or-later
#include "thalweg/terrain/standing_water.hpp"

#include <algorithm>
#include <catch2/catch.hpp>

#include "support/drawing.hpp"
#include "support/terrains.hpp"
#include "thalweg/terrain/lakes.hpp"
#include "thalweg/terrain/route.hpp"

using namespace thalweg;
using namespace thalweg::terrain;

TEST_CASE("Two drawn lakes have their depths, areas and deepest places", "[standing water]") {
    const auto d = support::draw(R"(
        9 9 9 9 9 9 9
        9 3 2 9 4 5 9
        9 2 8 9 9 5 7
        9 9 9 9 9 9 9)");
    const Grid grid = plane_grid(d.rows, d.cols, 10, 20);
    const auto filled = fill(grid, d.values, data_edge(grid, d.values));  // to 9 in the west, to 7 in the east
    const StandingWaters w = standing_waters(grid, d.values, filled);
    REQUIRE(w.waters.size() == 2);
    CHECK(w.waters[0].lowest == 1 * 7 + 2);
    CHECK(w.waters[0].depth_m == 7);
    CHECK(w.waters[0].area_m2 == 4 * 200);
    CHECK(w.waters[1].lowest == 1 * 7 + 4);
    CHECK(w.waters[1].depth_m == 3);
    CHECK(w.waters[1].area_m2 == 3 * 200);
    CHECK(w.of_cell[0] == none);
    CHECK(w.of_cell[2 * 7 + 2] == 0);
    CHECK(w.of_cell[2 * 7 + 5] == 1);
    CHECK(w.of_cell[2 * 7 + 6] == none);
}

TEST_CASE("All water stands in one lake or another, and none deeper than that says", "[standing water]") {
    for (std::uint64_t seed = 0; seed < 20; ++seed) {
        const auto t = support::with_holes(support::stepped_terrain(20, 25, 9, seed), 0.02, seed);
        const auto filled = fill(t.grid, t.elevation_m, data_edge(t.grid, t.elevation_m));
        const StandingWaters w = standing_waters(t.grid, t.elevation_m, filled);
        std::vector<double> area(w.waters.size(), 0), depth(w.waters.size(), 0);
        for (Index cell = 0; cell < t.grid.size(); ++cell) {
            const bool wet = filled[cell] > t.elevation_m[cell];
            REQUIRE((w.of_cell[cell] != none) == wet);
            if (!wet) continue;
            const Index lake = w.of_cell[cell];
            CHECK(filled[w.waters[lake].lowest] == filled[cell]);
            area[lake] += 1;
            depth[lake] = std::max(depth[lake], filled[cell] - t.elevation_m[cell]);
            t.grid.neighbors(cell, [&](Index other, double, Slot) {
                const bool joined = filled[other] > t.elevation_m[other] && filled[other] == filled[cell];
                if (joined) REQUIRE(w.of_cell[other] == lake);
            });
        }
        for (Index lake = 0; lake < w.waters.size(); ++lake) {
            CHECK(w.waters[lake].area_m2 == area[lake]);
            CHECK(w.waters[lake].depth_m == depth[lake]);
        }
    }
}
