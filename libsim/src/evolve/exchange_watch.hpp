// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "thalweg/core/topology.hpp"

namespace thalweg::evolve {

/// Watches which nodes exchange their receivers from step to step, and freezes those that do so for ever.
///
/// A change is new when the node had not changed within the last `patience` steps. When no change has been new for
/// `patience` steps and yet there are changes, only the same nodes exchange their receivers.
class ExchangeWatch {
  public:
    ExchangeWatch(Index nodes, Index patience) : patience_(patience), last_change_(nodes, 0) {}

    /// To be called with the directions of every step; returns how many nodes changed since the call before.
    Index observe(const FlowDirections& directions);

    /// True if for `patience` steps the same nodes exchanged their receivers, and no others.
    bool only_the_same() const;

    /// Freezes the nodes that exchange receivers to their present directions and starts watching anew.
    void freeze();

    const FlowDirections& frozen() const { return frozen_; }
    Index frozen_count() const;
    std::vector<std::uint8_t> frozen_mask() const;

  private:
    Index patience_;
    Index step_ = 0;             // numbered from 1, so that 0 means never
    Index last_new_change_ = 0;  // step of the last change of a node that had been quiet
    Index last_any_change_ = 0;
    std::vector<Index> last_change_;
    FlowDirections before_;
    FlowDirections frozen_;  // empty until something is frozen
};

}  // namespace thalweg::evolve
