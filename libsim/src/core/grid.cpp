// SPDX-License-Identifier: GPL-3.0-or-later
#include "thalweg/core/grid.hpp"

#include <fmt/format.h>

#include <cmath>

#include "thalweg/core/error.hpp"

namespace thalweg {

Grid plane_grid(Index rows, Index cols, double dx_m, double dy_m) {
    if (rows == 0 || cols == 0) throw Error(fmt::format("a grid needs at least one cell, not {} x {}", rows, cols));
    if (!(dx_m > 0) || !(dy_m > 0) || std::isinf(dx_m) || std::isinf(dy_m)) {
        throw Error(fmt::format("cells need a positive size, not {} x {} m", dx_m, dy_m));
    }
    if (std::uint64_t{rows} * cols >= none) {
        throw Error(fmt::format("{} x {} cells are more than 32-bit numbers can count", rows, cols));
    }
    return {.rows = rows,
            .cols = cols,
            .cell_area = std::vector<double>(rows, dx_m * dy_m),
            .east_west = std::vector<double>(rows, dx_m),
            .north_south = std::vector<double>(rows - 1, dy_m),
            .diagonal = std::vector<double>(rows - 1, std::hypot(dx_m, dy_m))};
}

}  // namespace thalweg
