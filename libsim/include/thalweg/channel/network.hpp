// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "thalweg/terrain/graph.hpp"

namespace thalweg::channel {

/// Channel links only: the pieces of river between sources, junctions and outlets. A link's nodes run downstream from
/// its upper end (source or junction) to its lower end (junction or outlet), both included, so neighbouring links share
/// a node. Links are numbered from the outlets up: a link comes after the one it flows into.
struct StreamNetwork {
    std::vector<Index> downstream;  ///< link it flows into, `none` at a mouth
    std::vector<Index> offset;      ///< links + 1: where each link's nodes begin
    std::vector<Index> nodes;
    std::vector<Index> strahler;  ///< order (Strahler 1957): rises where two or more inflows share the highest
    std::vector<Index> shreve;    ///< magnitude (Shreve 1966): number of sources upstream
    std::vector<double> length_m;
    std::vector<double> drop_m;   ///< upper minus lower end
    std::vector<double> area_m2;  ///< drainage area where the link ends: of its last node that is not shared

    Index size() const { return static_cast<Index>(downstream.size()); }
    std::span<const Index> nodes_of(Index link) const {
        return std::span(nodes).subspan(offset[link], offset[link + 1] - offset[link]);
    }
};

/// 1 at the nodes that are channel: drainage area at least `threshold_m2`, and `used` (empty: all).
std::vector<std::uint8_t> channels_by_area(std::span<const double> drainage_area_m2, double threshold_m2,
                                           std::span<const std::uint8_t> used = {});

/// 1 at the nodes that water from the heads runs through, the heads included: the union of the flow paths below them.
/// A head on another's path is legal and changes nothing. Heads must be nodes with data. Linear: every path is followed
/// until it meets one followed before.
std::vector<std::uint8_t> channels_from_heads(const terrain::FlowGraph&, std::span<const Index> heads);

/// The channel nodes, each after its receiver. Channels are few among the nodes of a DEM, so that everything else is
/// looked at once only.
std::vector<Index> channel_order(const terrain::FlowGraph&, std::span<const std::uint8_t> channel);

/// Channel nodes without a channel donor, ascending: where channels begin. `channels_from_heads` of them gives the same
/// channels again, provided that no channel ends before its water does.
std::vector<Index> channel_heads(const terrain::FlowGraph&, std::span<const std::uint8_t> channel);

/// Strahler order of every channel node: 1 at a source; where two or more inflows share the highest order, one more
/// than that, else the highest. 0 outside the channels. Linear, without recursion; any number of inflows.
std::vector<Index> strahler_orders(const terrain::FlowGraph&, std::span<const std::uint8_t> channel);

/// Shreve magnitude of every channel node: the number of sources at or upstream of it. 0 outside the channels.
std::vector<Index> shreve_magnitudes(const terrain::FlowGraph&, std::span<const std::uint8_t> channel);

/// Links of the channel nodes. A channel node without channel donors is a source; two or more donors make a junction;
/// a channel whose receiver is no channel (or which has none) ends there. A lone channel node without a channel
/// receiver makes no link; where several channels meet in a node without a channel receiver, each is a river of its own
/// that ends there. `elevation_m` gives the drops. Linear; the numbering follows the graph's order.
StreamNetwork stream_network(const terrain::FlowGraph&, std::span<const std::uint8_t> channel,
                             std::span<const double> drainage_area_m2, std::span<const double> elevation_m);

}  // namespace thalweg::channel
