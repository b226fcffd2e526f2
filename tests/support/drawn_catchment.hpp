// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>

#include "support/drawing.hpp"
#include "support/terrains.hpp"
#include "thalweg/core/raster.hpp"

namespace thalweg::support {

/// A valley in columns 2 to 6 that falls south, with the crests that shed its neighbours: everything inside flows to
/// the middle, down it and out at the bottom (35 cells). Five cells of the north rim leave by its middle; both flanks
/// are cut by the edge. The hole in the south-west corner lies far below, but not in the valley.
inline constexpr const char* drawn_catchment_text = R"(
       # 24   24.5 14.5  4.5 14.5 24.5 24
       # 24.5 25   15    5   15   25   24.5
       # 23.5 24   14    4   14   24   23.5
       # 22.5 23   13    3   13   23   22.5
       # 21.5 22   12    2   12   22   21.5
       # 20.5 21   11    1   11   21   20.5
       # 19.5 20   10    0   10   20   19.5
    -100 19   19.5  9.5 -0.5  9.5 19.5 19)";

/// A terrain on a map in metres whose north-west corner lies at (500 000, 4 000 000).
inline Raster raster_of(const TestTerrain& terrain) {
    const Grid& grid = terrain.grid;
    return {grid,
            {.west = 5e5,
             .north = 4e6,
             .cell_width = grid.east_west.front(),
             .cell_height = grid.north_south.empty() ? grid.east_west.front() : grid.north_south.front(),
             .crs_wkt = "",
             .geographic = false},
            terrain.elevation_m};
}

inline Raster drawn_catchment() {
    const Drawing d = draw(drawn_catchment_text);
    return raster_of({"drawn catchment", plane_grid(d.rows, d.cols, 10, 10), d.values});
}

}  // namespace thalweg::support
