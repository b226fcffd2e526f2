// SPDX-License-Identifier: GPL-3.0-or-later
#include "channel/valley_map.hpp"

namespace thalweg::channel {
namespace {

Bank bank_of(const Point& downstream, const Point& to_side) {
    return downstream.x * to_side.y - downstream.y * to_side.x >= 0 ? Bank::left : Bank::right;
}

/// The way on from a channel node; at a mouth the way that led there.
Point downstream_of(const terrain::FlowGraph& graph, const OffsetOf& offset, std::span<const Index> before,
                    Index node) {
    const Index receiver = graph.receiver[node];
    if (receiver != none) return offset(node, receiver);
    return before[node] == none ? Point{0, 0} : offset(before[node], node);
}

}  // namespace

std::vector<Index> link_of_nodes(const StreamNetwork& network, Index nodes) {
    std::vector<Index> link_of(nodes, none);
    for (Index link = 0; link < network.size(); ++link) {
        const auto own = network.nodes_of(link);
        const std::size_t shared = network.downstream[link] != none;
        for (const Index node : own.first(own.size() - shared)) link_of[node] = link;
    }
    return link_of;
}

Valleys valleys(const terrain::FlowGraph& graph, const OffsetOf& offset, std::span<const Index> link_of) {
    std::vector<Index> before(graph.size(), none);  // a channel node that flows into this one
    for (const Index node : graph.order) {
        if (link_of[node] != none && graph.receiver[node] != none) before[graph.receiver[node]] = node;
    }
    Valleys v{std::vector<Index>(graph.size(), none), std::vector<Bank>(graph.size(), Bank::left)};
    for (const Index node : graph.order) {
        const Index receiver = graph.receiver[node];
        if (link_of[node] != none) {
            v.foot[node] = node;
        } else if (receiver != none) {
            v.foot[node] = v.foot[receiver];
            const bool arrives = v.foot[receiver] == receiver;
            v.bank[node] = arrives ? bank_of(downstream_of(graph, offset, before, receiver), offset(receiver, node))
                                   : v.bank[receiver];
        }
    }
    return v;
}

}  // namespace thalweg::channel
