// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <vector>

#include "thalweg/core/topology.hpp"

namespace thalweg {

/// Regular grid of cells, row 0 in the north, stored row by row. All lengths in metres, areas in m².
///
/// A geographic grid has another width in every row, so the measures are arrays over rows and over the gaps between
/// rows; on a projected grid they hold the same value throughout. `io/geodesy.hpp` fills them for degrees. Slots run
/// clockwise from the east: 0 E, 1 SE, 2 S, 3 SW, 4 W, 5 NW, 6 N, 7 NE, so that 1 << slot is ESRI's direction code.
struct Grid {
    Index rows = 0;
    Index cols = 0;
    std::vector<double> cell_area;      ///< per row, m²
    std::vector<double> east_west;      ///< per row: between the centres of horizontal neighbours, m
    std::vector<double> north_south;    ///< per gap below row r (rows − 1 of them), m
    std::vector<double> diagonal;       ///< per gap below row r (rows − 1 of them), m

    Index size() const { return rows * cols; }
    Index row(Index node) const { return node / cols; }
    Index col(Index node) const { return node % cols; }

    double area(Index node) const { return cell_area[row(node)]; }

    Index neighbor(Index node, Slot slot) const { return node + static_cast<Index>(step(slot)); }

    double length(Index node, Slot slot) const { return length_in_row(row(node), slot); }

    Slot reverse(Index, Slot slot) const { return slot ^ Slot{4}; }

    /// Calls visit(neighbor, length_m, slot) for each of the up to eight cells around `node`, slots ascending.
    template <class Visit>
    void neighbors(Index node, Visit visit) const {
        const Index r = row(node);
        const Index c = node - r * cols;
        const bool west = c > 0;
        const bool east = c + 1 < cols;
        const bool north = r > 0;
        const bool south = r + 1 < rows;
        const auto at = [&](Slot slot) { visit(neighbor(node, slot), length_in_row(r, slot), slot); };
        if (east) at(0);
        if (south && east) at(1);
        if (south) at(2);
        if (south && west) at(3);
        if (west) at(4);
        if (north && west) at(5);
        if (north) at(6);
        if (north && east) at(7);
    }

    static constexpr std::array<int, 8> row_step{0, 1, 1, 1, 0, -1, -1, -1};
    static constexpr std::array<int, 8> col_step{1, 1, 0, -1, -1, -1, 0, 1};

  private:
    std::int64_t step(Slot slot) const {
        return row_step[slot] * static_cast<std::int64_t>(cols) + col_step[slot];
    }
    double length_in_row(Index r, Slot slot) const {
        const Index gap = slot >= 5 ? r - 1 : r;
        if (slot % 4 == 0) return east_west[r];
        return slot % 4 == 2 ? north_south[gap] : diagonal[gap];
    }
};

static_assert(Topology<Grid>);

/// Grid on a plane with cells of dx by dy metres.
/// Throws Error if a size is zero, a spacing is not a positive number, or the cells do not fit 32-bit numbers.
Grid plane_grid(Index rows, Index cols, double dx_m, double dy_m);

}  // namespace thalweg
