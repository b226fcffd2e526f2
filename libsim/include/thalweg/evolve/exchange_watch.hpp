// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <vector>

#include "thalweg/core/topology.hpp"

namespace thalweg::evolve {

/// Watches which nodes exchange their receivers from step to step, so that those that do so for ever can be frozen.
///
/// A change is new when the node had not changed within the last `patience` steps. When no change has been new for
/// `patience` steps and yet there are changes, only the same nodes exchange their receivers.
struct ExchangeWatch {
    Index patience = 0;
    Index step = 0;             ///< numbered from 1, so that 0 means never
    Index last_new_change = 0;  ///< step of the last change of a node that had been quiet
    Index last_any_change = 0;
    std::vector<Index> last_change;  ///< per node
    FlowDirections before;           ///< of the step before; empty until there was one
    FlowDirections frozen;           ///< direction of each frozen node, `no_flow` elsewhere; empty until one is frozen
};

ExchangeWatch exchange_watch(Index nodes, Index patience);  ///< before the first step, with nothing frozen

/// To be called with the directions of every step; returns how many nodes changed since the call before.
Index observe(ExchangeWatch&, const FlowDirections&);

/// True if for `patience` steps the same nodes exchanged their receivers, and no others.
bool only_the_same(const ExchangeWatch&);

/// Freezes the nodes that exchange receivers to their present directions and starts watching anew.
void freeze(ExchangeWatch&);

Index frozen_count(const ExchangeWatch&);                     ///< number of nodes that are frozen
std::vector<std::uint8_t> frozen_mask(const ExchangeWatch&);  ///< per node, 1 where it is frozen

}  // namespace thalweg::evolve
