// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <string>
#include <vector>

#include "thalweg/core/grid.hpp"
#include "thalweg/core/point.hpp"

namespace thalweg {

/// Where a grid lies on the earth: the corner of the north-west cell, the cell's size and the coordinate system.
struct Placement {
    double west = 0;          ///< x of the grid's western edge, in units of the coordinate system
    double north = 0;         ///< y of its northern edge
    double cell_width = 1;    ///< > 0, in units of the coordinate system
    double cell_height = 1;   ///< > 0
    std::string crs_wkt;      ///< empty: a plane in metres that lies nowhere in particular
    bool geographic = false;  ///< units are degrees; the grid's measures are ellipsoidal

    Point center(Index row, Index col) const {
        return {west + (col + 0.5) * cell_width, north - (row + 0.5) * cell_height};
    }
};

/// A grid of values on the earth. NaN is no data.
struct Raster {
    Grid grid;
    Placement placement;
    std::vector<double> values;  ///< grid.size() of them, in metres when they are elevations
};

/// The cell that holds a point given in the raster's coordinates, `none` beside it. A point between two cells is in the
/// eastern, or the southern one; on the eastern or southern edge of the raster it is in the last. Longitudes may differ
/// from the raster's by whole turns.
Index cell_at(const Raster&, Point);

/// The cell with data whose centre lies nearest to a point of the raster's coordinates, the first of those as near; `none`
/// where no cell has any.
Index nearest_cell_with_data(const Raster&, Point);

}  // namespace thalweg
