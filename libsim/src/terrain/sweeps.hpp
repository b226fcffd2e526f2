// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "terrain/blocks.hpp"
#include "thalweg/terrain/graph.hpp"

namespace thalweg::terrain {

/// Whether the order's parts are known and are those of the blocks: then they may be swept on several threads.
inline bool has_parts(const FlowGraph& graph, const Blocks& blocks) {
    return graph.layers.part.size() == blocks.count() + 2;
}

/// Calls take(node), which changes what belongs to the node alone, once for every node with data: after its receiver.
template <class Take>
void from_outlets_up(const FlowGraph& graph, const Take& take) {
    const Blocks blocks(graph.size());
    if (!has_parts(graph, blocks)) {
        for (const Index node : graph.order) take(node);
        return;
    }
    const auto part = [&](Index number) {
        const FlowLayers& layers = graph.layers;
        const Index end = layers.begin[layers.part[number + 1]];
        for (Index at = layers.begin[layers.part[number]]; at < end; ++at) take(graph.order[at]);
    };
    part(0);
    blocks.for_each([&](Index block) { part(block + 1); });
}

/// Sweeps jump about in memory, but the list says where they will be: this many nodes ahead are asked for early.
inline constexpr Index sweep_ahead = 24;

/// Calls give(node) for the nodes order[begin, end) that have a receiver, the last first. Those whose receiver lies
/// outside of the block are only noted.
template <class Give>
void part_down(const FlowGraph& graph, Index begin, Index end, Index first, Index size, const Give& give,
               std::vector<Index>& crossing) {
    for (Index at = end; at-- > begin;) {
        if (at >= begin + sweep_ahead) graph.receiver.fetch(graph.order[at - sweep_ahead]);
        const Index node = graph.order[at];
        const Index receiver = graph.receiver[node];
        if (receiver - first < size) {
            give(node);
        } else if (receiver != none) {
            crossing.push_back(node);
        }
    }
}

/// Calls give(node), which changes the receiver alone, for every node that has one: after all that flow to the node,
/// and for each receiver in a fixed order. By blocks where the order's parts are known.
template <class Give>
void from_leaves_down(const FlowGraph& graph, const Give& give) {
    const auto& layers = graph.layers;
    const Blocks blocks(graph.size());
    std::vector<Index> all;
    if (!has_parts(graph, blocks)) {
        part_down(graph, 0, static_cast<Index>(graph.order.size()), 0, graph.size(), give, all);
        return;
    }
    std::vector<std::vector<Index>> crossing(blocks.count());
    blocks.for_each([&](Index block) {
        part_down(graph, layers.begin[layers.part[block + 1]], layers.begin[layers.part[block + 2]],
                  blocks.first(block), blocks.last(block) - blocks.first(block), give, crossing[block]);
    });
    for (const std::vector<Index>& nodes : crossing) {
        for (const Index node : nodes) give(node);
    }
    part_down(graph, 0, layers.begin[layers.part[1]], 0, graph.size(), give, all);
}

}  // namespace thalweg::terrain
