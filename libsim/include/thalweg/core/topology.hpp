// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <concepts>
#include <cstdint>
#include <vector>

#include "thalweg/core/index.hpp"

namespace thalweg {

/// Number of one of a node's neighbours, counted from 0 in the topology's own order.
using Slot = std::uint8_t;

/// A node that gives its water to nobody: an outlet, a pit not yet drained, or a node without data.
inline constexpr Slot no_flow = 255;

/// Where each node's water goes, as one byte per node: a slot, or `no_flow`.
using FlowDirections = std::vector<Slot>;

/// What water may do at a node that has no lower neighbour.
enum class Boundary : std::uint8_t {
    interior,   ///< it must reach another node: the node lies in a lake
    open,       ///< it leaves the domain here, unless a lower neighbour takes it (the edge of a DEM, beside no data)
    base_level  ///< it always leaves the domain here (an outlet of a simulation; its elevation is prescribed)
};

/// All that routing needs of a terrain's geometry. `Grid` and `Mesh` model it; routing is written once for both.
///
/// `neighbors(node, visit)` calls `visit(neighbor, length_m, slot)` for every neighbour in the order of the slots;
/// `neighbor(node, slot)` and `length(node, slot)` give the same one by one; `reverse(node, slot)` is the slot under
/// which that neighbour knows `node`. Lengths (m) are symmetric to the last bit. `area(node)` is the cell's area (m²).
template <class T>
concept Topology = requires(const T& topology, Index node, Slot slot) {
    { topology.size() } -> std::same_as<Index>;
    { topology.neighbor(node, slot) } -> std::same_as<Index>;
    { topology.length(node, slot) } -> std::same_as<double>;
    { topology.reverse(node, slot) } -> std::same_as<Slot>;
    { topology.area(node) } -> std::same_as<double>;
    topology.neighbors(node, [](Index, double, Slot) {});
};

}  // namespace thalweg
