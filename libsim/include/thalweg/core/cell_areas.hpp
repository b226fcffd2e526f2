// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "thalweg/core/grid.hpp"

namespace thalweg {

/// Area of every node's cell, m²: one number per node or, on a grid, one per row, which is next to no memory.
class CellAreas {
  public:
    CellAreas() = default;
    CellAreas(std::vector<double> per_node)  // NOLINT: a list of areas is what this is
        : area_(std::move(per_node)), size_(area_.size()) {}
    explicit CellAreas(const Grid& grid);

    double operator[](std::size_t node) const { return per_ == 1 ? area_[node] : area_[node / per_]; }
    std::size_t size() const { return size_; }

    /// Per node.
    std::vector<double> list() const;

  private:
    std::vector<double> area_;
    std::size_t size_ = 0;
    std::uint32_t per_ = 1;  // nodes that follow each other with the same area
};

}  // namespace thalweg
