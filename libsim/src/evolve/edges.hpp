// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <array>

#include "thalweg/core/grid.hpp"
#include "thalweg/core/mesh.hpp"

namespace thalweg::evolve {

/// A grid whose rows are all alike: a node's row, and so a division, is not needed for its lengths and its area.
class PlaneEdges {
  public:
    explicit PlaneEdges(const Grid& grid) : area_(grid.cell_area[0]) {
        for (Slot slot = 0; slot < 8; ++slot) {
            step_[slot] = Grid::row_step[slot] * static_cast<std::int64_t>(grid.cols) + Grid::col_step[slot];
            const bool level = slot % 4 == 0;
            const bool upright = slot % 4 == 2;
            if (level) length_[slot] = grid.east_west[0];
            if (!level && grid.rows > 1) length_[slot] = upright ? grid.north_south[0] : grid.diagonal[0];
        }
    }

    Index neighbor(Index node, Slot slot) const { return node + static_cast<Index>(step_[slot]); }
    double length(Index, Slot slot) const { return length_[slot]; }
    double area(Index) const { return area_; }

  private:
    std::array<std::int64_t, 8> step_{};
    std::array<double, 8> length_{};
    double area_;
};

inline bool rows_are_alike(const Grid& grid) {
    const auto constant = [](const std::vector<double>& values) {
        return std::ranges::all_of(values, [&](double value) { return value == values[0]; });
    };
    return constant(grid.cell_area) && constant(grid.east_west) && constant(grid.north_south) &&
           constant(grid.diagonal);
}

/// Calls body(edges), where edges has neighbor, length and area in the quickest form this topology allows.
template <class Body>
auto with_edges(const Grid& grid, Body body) {
    return rows_are_alike(grid) ? body(PlaneEdges(grid)) : body(grid);
}

template <class Body>
auto with_edges(const Mesh& mesh, Body body) {
    return body(mesh);
}

}  // namespace thalweg::evolve
