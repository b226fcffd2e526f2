// SPDX-License-Identifier: GPL-3.0-or-later
#include "thalweg/terrain/receivers.hpp"

#include <algorithm>
#include <functional>

#include "terrain/row_lengths.hpp"

namespace thalweg::terrain {
namespace {

bool all_alike(const std::vector<double>& values) {
    return std::ranges::adjacent_find(values, std::not_equal_to()) == values.end();
}

bool rows_are_alike(const Grid& grid) {
    return grid.rows > 2 && all_alike(grid.east_west) && all_alike(grid.north_south) && all_alike(grid.diagonal);
}

}  // namespace

Receivers::Receivers(const Grid& grid, std::shared_ptr<const FlowDirections> directions)
    : directions_(std::move(directions)), slot_(directions_->data()) {
    const Index middle = 0;
    for (Slot slot = 0; slot < 8; ++slot) offset_[slot] = grid.neighbor(middle, slot);
}

std::vector<Index> Receivers::list() const {
    if (slot_ == nullptr) return list_;
    std::vector<Index> all(size());
    for (std::size_t node = 0; node < all.size(); ++node) all[node] = (*this)[node];
    return all;
}

const FlowDirections& Receivers::directions() const {
    static const FlowDirections nothing;
    return directions_ ? *directions_ : nothing;
}

ReceiverLengths::ReceiverLengths(const Grid& grid, std::shared_ptr<const FlowDirections> directions)
    : directions_(std::move(directions)), slot_(directions_->data()), per_row_(grid.cols) {
    if (rows_are_alike(grid)) {
        of_row_.push_back(row_lengths(grid, 1));  // an inner row has all eight
        per_row_ = grid.size();
        return;
    }
    for (Index row = 0; row < grid.rows; ++row) of_row_.push_back(row_lengths(grid, row));
}

std::vector<double> ReceiverLengths::list() const {
    if (slot_ == nullptr) return list_;
    std::vector<double> all(size());
    for (std::size_t node = 0; node < all.size(); ++node) all[node] = (*this)[node];
    return all;
}

}  // namespace thalweg::terrain
