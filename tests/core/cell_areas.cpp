// SPDX-License-Identifier: GPL-3.0-or-later
#include "thalweg/core/cell_areas.hpp"

#include <catch2/catch.hpp>

using namespace thalweg;

TEST_CASE("areas by rows are each node's own, whether the rows are alike or not") {
    for (const bool alike : {true, false}) {
        for (const Index cols : {1u, 4u}) {
            Grid grid = plane_grid(3, cols, 2, 5);
            if (!alike) grid.cell_area = {10, 9, 8};
            const CellAreas areas(grid);
            REQUIRE(areas.size() == grid.size());
            for (Index node = 0; node < grid.size(); ++node) CHECK(areas[node] == grid.area(node));
            CHECK(areas.list().size() == grid.size());
        }
    }
    const CellAreas listed(std::vector<double>{3, 1, 2});
    CHECK(listed[0] + 10 * listed[1] + 100 * listed[2] == 213);
    CHECK(CellAreas().size() == 0);
}
