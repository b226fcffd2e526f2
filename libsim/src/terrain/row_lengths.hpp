// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>

#include "thalweg/core/grid.hpp"

namespace thalweg::terrain {

/// Length to the neighbour in each slot for the cells of a row, m; 0 where the row beyond does not exist.
inline std::array<double, 8> row_lengths(const Grid& grid, Index row) {
    std::array<double, 8> of_slot{};
    for (Slot slot = 0; slot < 8; ++slot) {
        const bool inside = row + Grid::row_step[slot] < grid.rows;  // row −1 wraps round to a large number
        if (inside) of_slot[slot] = grid.length(row * grid.cols, slot);
    }
    return of_slot;
}

}  // namespace thalweg::terrain
