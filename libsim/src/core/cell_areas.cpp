// SPDX-License-Identifier: GPL-3.0-or-later
#include "thalweg/core/cell_areas.hpp"

#include <algorithm>

namespace thalweg {

CellAreas::CellAreas(const Grid& grid) : area_(grid.cell_area), size_(grid.size()), per_(grid.cols) {
    const bool even = std::ranges::adjacent_find(area_, std::not_equal_to()) == area_.end();
    if (!even || area_.empty()) return;
    // One number for all cells, and no division that tells the row.
    area_.resize(1);
    per_ = std::max<std::uint32_t>(grid.size(), 2);
}

std::vector<double> CellAreas::list() const {
    std::vector<double> all(size_);
    for (std::size_t node = 0; node < size_; ++node) all[node] = (*this)[node];
    return all;
}

}  // namespace thalweg
