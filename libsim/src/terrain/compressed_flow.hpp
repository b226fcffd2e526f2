// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <functional>
#include <span>
#include <vector>

#include "thalweg/core/grid.hpp"
#include "thalweg/core/mesh.hpp"
#include "thalweg/terrain/multiple_flow.hpp"

namespace thalweg::terrain {

/// Receivers of a cell as bits 1 << slot.
using SlotBits = std::uint8_t;

/// Makes room: offsets from the number of receivers of each node. Throws Error if there are too many for an Index.
void lay_out(std::span<const std::uint8_t> receivers_of, MultipleFlow&);

/// Writes offsets, receivers and lengths of a grid from its cells' bits, and calls shares(first, last) on pieces that
/// cover all nodes once those are there.
void write_receivers(const Grid&, std::span<const SlotBits> bits, const std::function<void(Index, Index)>& shares,
                     MultipleFlow&);

/// Writes the order, and adds up `upstream` (or nothing) along it. Nodes without data (NaN) are left out.
void write_order(std::span<const double> elevation_m, MultipleFlow&, std::span<double> upstream = {});

}  // namespace thalweg::terrain
