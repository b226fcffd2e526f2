// SPDX-License-Identifier: GPL-3.0-or-later
// Private: to which link's valley the ground belongs.
#pragma once

#include <span>
#include <vector>

#include "thalweg/channel/links.hpp"
#include "thalweg/channel/network.hpp"
#include "thalweg/channel/tributaries.hpp"
#include "thalweg/terrain/graph.hpp"

namespace thalweg::channel {

/// Link of every channel node; a node that links share is of the one below.
std::vector<Index> link_of_nodes(const StreamNetwork&, Index nodes);

/// Where each node's water reaches a channel, and from which bank. `none` where it reaches none; channels are their
/// own.
struct Valleys {
    std::vector<Index> foot;
    std::vector<Bank> bank;
};

Valleys valleys(const terrain::FlowGraph&, const OffsetOf&, std::span<const Index> link_of);

}  // namespace thalweg::channel
