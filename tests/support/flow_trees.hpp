// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <utility>
#include <vector>

#include "thalweg/channel/network.hpp"
#include "thalweg/core/random.hpp"
#include "thalweg/terrain/graph.hpp"

/// Flow graphs made by hand or drawn at random, without a terrain.
namespace thalweg::support {

/// Graph of the given receivers with all lengths alike. The order is breadth-first from the outlets.
inline terrain::FlowGraph graph_of(std::vector<Index> receiver, double length_m = 1) {
    const Index count = static_cast<Index>(receiver.size());
    std::vector<std::vector<Index>> donors(count);
    terrain::FlowGraph graph;
    std::vector<double> length;
    for (Index node = 0; node < count; ++node) {
        length.push_back(receiver[node] == none ? 0 : length_m);
        if (receiver[node] == none) graph.order.push_back(node);
        if (receiver[node] != none) donors[receiver[node]].push_back(node);
    }
    for (Index at = 0; at < graph.order.size(); ++at) {
        for (const Index donor : donors[graph.order[at]]) graph.order.push_back(donor);
    }
    graph.receiver = std::move(receiver);
    graph.length = std::move(length);
    return graph;
}

/// Number of nodes at or upstream of each: the drainage area if every cell has 1 m².
inline std::vector<double> upstream_counts(const terrain::FlowGraph& graph) {
    std::vector<double> count(graph.size(), 1);
    for (auto node = graph.order.rbegin(); node != graph.order.rend(); ++node) {
        if (graph.receiver[*node] != none) count[graph.receiver[*node]] += count[*node];
    }
    return count;
}

/// Binary tree with `sources` tips from Shreve's random model: all topologically distinct trees equally likely (Rémy's
/// algorithm: put a new tip on a link chosen at random, left or right alike).
inline terrain::FlowGraph random_tree(Index sources, Random& random) {
    std::vector<Index> receiver{none, 0};  // 0 is the mouth; every other node is one link, named by its upper end
    for (Index source = 1; source < sources; ++source) {
        const Index link = 1 + random.below(static_cast<Index>(receiver.size()) - 1);
        const Index junction = static_cast<Index>(receiver.size());
        receiver.push_back(receiver[link]);  // the junction splits the link …
        receiver[link] = junction;
        receiver.push_back(junction);  // … and takes a new tip
    }
    return graph_of(std::move(receiver));
}

/// Peano's basin of the given order: each link is replaced by two in a row with two tributaries where they join, four
/// links for one, order − 1 times.
inline terrain::FlowGraph peano_tree(Index order) {
    std::vector<Index> receiver{none, 0};
    for (Index generation = 1; generation < order; ++generation) {
        const Index count = static_cast<Index>(receiver.size());
        for (Index node = 1; node < count; ++node) {
            const Index middle = static_cast<Index>(receiver.size());
            receiver.push_back(receiver[node]);
            receiver.insert(receiver.end(), {middle, middle});
            receiver[node] = middle;
        }
    }
    return graph_of(std::move(receiver));
}

/// The links of a graph all of whose nodes are channels, each with 1 m² of its own, in a landscape without relief.
inline channel::StreamNetwork network_of(const terrain::FlowGraph& graph) {
    return channel::stream_network(graph, std::vector<std::uint8_t>(graph.size(), 1), upstream_counts(graph),
                                   std::vector<double>(graph.size(), 0));
}

}  // namespace thalweg::support
