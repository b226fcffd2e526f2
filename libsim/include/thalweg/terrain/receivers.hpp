// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <memory>
#include <vector>

#include "thalweg/core/grid.hpp"

namespace thalweg::terrain {

/// Receiver of each node; `none` where it has none. A list or, on a grid, nothing but the directions: one byte per
/// cell.
class Receivers {
  public:
    Receivers() = default;
    Receivers(std::vector<Index> list) : list_(std::move(list)) {}  // NOLINT: a list is what this is
    Receivers(const Grid& grid, std::shared_ptr<const FlowDirections> directions);

    Index operator[](std::size_t node) const {
        if (slot_ == nullptr) return list_[node];
        const Slot slot = slot_[node];
        return slot == no_flow ? none : static_cast<Index>(node) + offset_[slot];
    }
    std::size_t size() const { return directions_ ? directions_->size() : list_.size(); }
    std::vector<Index> list() const;
    bool operator==(const Receivers& other) const { return list() == other.list(); }

    /// The directions on a grid; empty where receivers are a list.
    const FlowDirections& directions() const;

    /// Asks for what `operator[]` will read.
    [[gnu::always_inline]] void fetch(Index node) const {
        if (slot_ == nullptr) {
            __builtin_prefetch(list_.data() + node);
        } else {
            __builtin_prefetch(slot_ + node);
        }
    }

  private:
    std::vector<Index> list_;
    std::shared_ptr<const FlowDirections> directions_;
    const Slot* slot_ = nullptr;
    std::array<Index, 8> offset_{};  // modulo 2^32, as node numbers are
};

/// Distance of each node to its receiver, m; 0 where it has none. A list or, on a grid, the directions and the lengths
/// of the eight ways from a row.
class ReceiverLengths {
  public:
    ReceiverLengths() = default;
    ReceiverLengths(std::vector<double> list) : list_(std::move(list)) {}  // NOLINT: a list is what this is
    ReceiverLengths(const Grid& grid, std::shared_ptr<const FlowDirections> directions);

    double operator[](std::size_t node) const {
        if (slot_ == nullptr) return list_[node];
        const Slot slot = slot_[node];
        return slot == no_flow ? 0 : of_row_[node / per_row_][slot];
    }
    std::size_t size() const { return directions_ ? directions_->size() : list_.size(); }
    std::vector<double> list() const;
    bool operator==(const ReceiverLengths& other) const { return list() == other.list(); }

  private:
    std::vector<double> list_;
    std::shared_ptr<const FlowDirections> directions_;
    const Slot* slot_ = nullptr;
    std::vector<std::array<double, 8>> of_row_;  // of a row and slot; one row where all rows are alike
    std::size_t per_row_ = 1;                    // cells that have them
};

}  // namespace thalweg::terrain
