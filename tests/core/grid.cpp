// SPDX-License-Identifier: GPL-3.0-or-later
#include "thalweg/core/grid.hpp"

#include <catch2/catch.hpp>
#include <cmath>
#include <limits>
#include <map>

#include "support/terrains.hpp"
#include "thalweg/core/error.hpp"

using namespace thalweg;

TEST_CASE("a plane grid has the same measures everywhere") {
    const Grid grid = plane_grid(3, 4, 30, 40);
    CHECK(grid.size() == 12);
    CHECK(grid.row(7) == 1);
    CHECK(grid.col(7) == 3);
    for (Index node = 0; node < grid.size(); ++node) CHECK(grid.area(node) == 1200);
    const double expected[] = {30, 50, 40, 50, 30, 50, 40, 50};
    for (Slot slot = 0; slot < 8; ++slot) CHECK(grid.length(5, slot) == expected[slot]);
}

TEST_CASE("slots run clockwise from the east, as ESRI's codes do") {
    const Grid grid = plane_grid(3, 3, 1, 1);
    const Index expected[] = {5, 8, 7, 6, 3, 0, 1, 2};
    for (Slot slot = 0; slot < 8; ++slot) CHECK(grid.neighbor(4, slot) == expected[slot]);
}

TEST_CASE("cells at the rim have fewer neighbours, in the order of the slots") {
    const auto slots_of = [](const Grid& grid, Index node) {
        std::vector<int> slots;
        grid.neighbors(node, [&](Index, double, Slot slot) { slots.push_back(slot); });
        return slots;
    };
    const Grid grid = plane_grid(3, 3, 1, 1);
    CHECK(slots_of(grid, 0) == std::vector<int>{0, 1, 2});
    CHECK(slots_of(grid, 1) == std::vector<int>{0, 1, 2, 3, 4});
    CHECK(slots_of(grid, 4) == std::vector<int>{0, 1, 2, 3, 4, 5, 6, 7});
    CHECK(slots_of(grid, 8) == std::vector<int>{4, 5, 6});
    CHECK(slots_of(plane_grid(1, 3, 1, 1), 1) == std::vector<int>{0, 4});
    CHECK(slots_of(plane_grid(3, 1, 1, 1), 1) == std::vector<int>{2, 6});
    CHECK(slots_of(plane_grid(1, 1, 1, 1), 0).empty());
}

TEST_CASE("neighbours know each other under reversed slots and at the same length") {
    for (const Grid& grid : {plane_grid(4, 5, 2, 3), support::uneven_grid(5, 4), plane_grid(1, 6, 1, 1)}) {
        for (Index node = 0; node < grid.size(); ++node) {
            grid.neighbors(node, [&](Index other, double length_m, Slot slot) {
                CHECK(grid.neighbor(node, slot) == other);
                CHECK(grid.length(node, slot) == length_m);
                const Slot back = grid.reverse(node, slot);
                CHECK(grid.neighbor(other, back) == node);
                CHECK(grid.length(other, back) == length_m);
            });
        }
    }
}

TEST_CASE("a grid of uneven rows takes its lengths from the row and from the gap it crosses") {
    const Grid grid = support::uneven_grid(3, 3);
    CHECK(grid.length(4, 0) == grid.east_west[1]);
    CHECK(grid.length(4, 2) == grid.north_south[1]);
    CHECK(grid.length(4, 6) == grid.north_south[0]);
    CHECK(grid.length(4, 3) == grid.diagonal[1]);
    CHECK(grid.length(4, 7) == grid.diagonal[0]);
    CHECK(grid.area(7) == grid.cell_area[2]);
    CHECK(grid.length(4, 2) != grid.length(4, 6));
}

TEST_CASE("a grid without cells, of impossible cells, or of too many is refused") {
    CHECK_THROWS_AS(plane_grid(0, 3, 1, 1), Error);
    CHECK_THROWS_AS(plane_grid(3, 0, 1, 1), Error);
    CHECK_THROWS_AS(plane_grid(3, 3, 0, 1), Error);
    CHECK_THROWS_AS(plane_grid(3, 3, 1, -1), Error);
    CHECK_THROWS_AS(plane_grid(3, 3, std::nan(""), 1), Error);
    CHECK_THROWS_AS(plane_grid(3, 3, 1, std::numeric_limits<double>::infinity()), Error);
    CHECK_THROWS_AS(plane_grid(65536, 65536, 1, 1), Error);
    CHECK_THROWS_AS(plane_grid(65535, 65537, 1, 1), Error);
    CHECK_THROWS_WITH(plane_grid(0, 3, 1, 1), Catch::Contains("0 x 3"));
}

TEST_CASE("a mesh made of a grid is the same graph") {
    const Grid grid = support::uneven_grid(4, 5);
    const Mesh mesh = support::mesh_of(grid);
    REQUIRE(mesh.size() == grid.size());
    for (Index node = 0; node < grid.size(); ++node) {
        std::map<Index, double> of_grid, of_mesh;
        Index last = none;
        grid.neighbors(node, [&](Index other, double length_m, Slot) { of_grid[other] = length_m; });
        mesh.neighbors(node, [&](Index other, double length_m, Slot slot) {
            of_mesh[other] = length_m;
            CHECK((last == none || other > last));
            last = other;
            CHECK(mesh.neighbor(other, mesh.reverse(node, slot)) == node);
        });
        CHECK(of_grid == of_mesh);
        CHECK(mesh.area(node) == grid.area(node));
    }
}
