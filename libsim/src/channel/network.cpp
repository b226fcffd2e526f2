// SPDX-License-Identifier: GPL-3.0-or-later
#include "thalweg/channel/network.hpp"

#include <algorithm>
#include <ranges>

namespace thalweg::channel {

namespace {

using terrain::FlowGraph;

/// Where a channel node's water goes within the channels, else `none`.
Index channel_receiver(const FlowGraph& graph, std::span<const std::uint8_t> channel, Index node) {
    const Index receiver = graph.receiver[node];
    return receiver != none && channel[receiver] ? receiver : none;
}

/// Number of channel donors, counted up to 2: enough to tell sources (0), links (1) and junctions (2).
std::vector<std::uint8_t> donor_counts(const FlowGraph& graph, std::span<const std::uint8_t> channel,
                                       std::span<const Index> order) {
    std::vector<std::uint8_t> donors(graph.size(), 0);
    for (const Index node : order) {
        const Index receiver = channel_receiver(graph, channel, node);
        if (receiver != none && donors[receiver] < 2) ++donors[receiver];
    }
    return donors;
}

/// The link on which each channel node's way to its receiver lies, and how the links hang together.
struct Links {
    std::vector<Index> of_node;     ///< `none` outside of links and at mouths
    std::vector<Index> downstream;  ///< per link
    std::vector<Index> lower_end;   ///< per link: its last node
};

Links number_links(const FlowGraph& graph, std::span<const std::uint8_t> channel, std::span<const Index> order,
                   std::span<const std::uint8_t> donors) {
    Links links{.of_node = std::vector<Index>(graph.size(), none), .downstream = {}, .lower_end = {}};
    for (const Index node : order) {
        const Index receiver = channel_receiver(graph, channel, node);
        if (receiver == none) continue;
        const Index below = links.of_node[receiver];
        const bool starts_at_receiver = below == none || donors[receiver] > 1;
        if (!starts_at_receiver) {
            links.of_node[node] = below;
            continue;
        }
        links.of_node[node] = static_cast<Index>(links.downstream.size());
        links.downstream.push_back(below);
        links.lower_end.push_back(receiver);
    }
    return links;
}

/// Lays the nodes of every link out in a row, running downstream.
StreamNetwork laid_out(Links links, std::span<const Index> order) {
    StreamNetwork network;
    network.downstream = std::move(links.downstream);
    const Index count = network.size();
    network.offset.assign(count + 1, 0);
    for (const Index node : order) {
        if (links.of_node[node] != none) ++network.offset[links.of_node[node] + 1];
    }
    for (Index link = 0; link < count; ++link) network.offset[link + 1] += network.offset[link] + 1;
    network.nodes.resize(network.offset[count]);
    std::vector<Index> next(network.offset.begin() + 1, network.offset.end());
    for (Index link = 0; link < count; ++link) network.nodes[--next[link]] = links.lower_end[link];
    for (const Index node : order) {  // downstream first, so each link fills up from its lower end
        const Index link = links.of_node[node];
        if (link != none) network.nodes[--next[link]] = node;
    }
    return network;
}

/// Of values per node those of each link's upper end.
std::vector<Index> at_upper_ends(const StreamNetwork& network, const std::vector<Index>& values) {
    std::vector<Index> picked;
    for (Index link = 0; link < network.size(); ++link) picked.push_back(values[network.nodes[network.offset[link]]]);
    return picked;
}

void measure_links(const FlowGraph& graph, std::span<const std::uint8_t> donors,
                   std::span<const double> drainage_area_m2, std::span<const double> elevation_m,
                   StreamNetwork& network) {
    for (Index link = 0; link < network.size(); ++link) {
        const auto nodes = network.nodes_of(link);
        const Index last = nodes.back();
        double length = 0;
        for (const Index node : nodes.first(nodes.size() - 1)) length += graph.length[node];
        const bool shared = donors[last] > 1;
        network.length_m.push_back(length);
        network.drop_m.push_back(elevation_m[nodes.front()] - elevation_m[last]);
        network.area_m2.push_back(drainage_area_m2[shared ? nodes[nodes.size() - 2] : last]);
    }
}

/// Order of every channel node; the others keep 0.
std::vector<Index> orders_along(const FlowGraph& graph, std::span<const std::uint8_t> channel,
                                std::span<const Index> nodes) {
    std::vector<Index> order(graph.size(), 0);          // highest inflow so far, then the node's own
    std::vector<std::uint8_t> shared(graph.size(), 0);  // 1 if two or more inflows have it
    for (const Index node : nodes | std::views::reverse) {
        order[node] = std::max<Index>(1, order[node] + shared[node]);
        const Index receiver = channel_receiver(graph, channel, node);
        if (receiver == none) continue;
        if (order[node] >= order[receiver]) {
            shared[receiver] = order[node] == order[receiver];
            order[receiver] = order[node];
        }
    }
    return order;
}

std::vector<Index> magnitudes_along(const FlowGraph& graph, std::span<const std::uint8_t> channel,
                                    std::span<const Index> nodes) {
    std::vector<Index> magnitude(graph.size(), 0);
    for (const Index node : nodes | std::views::reverse) {
        if (magnitude[node] == 0) magnitude[node] = 1;
        const Index receiver = channel_receiver(graph, channel, node);
        if (receiver != none) magnitude[receiver] += magnitude[node];
    }
    return magnitude;
}

}  // namespace

std::vector<std::uint8_t> channels_by_area(std::span<const double> drainage_area_m2, double threshold_m2,
                                           std::span<const std::uint8_t> used) {
    std::vector<std::uint8_t> channel(drainage_area_m2.size());
    for (std::size_t node = 0; node < channel.size(); ++node) {
        channel[node] = drainage_area_m2[node] >= threshold_m2 && (used.empty() || used[node]);
    }
    return channel;
}

std::vector<std::uint8_t> channels_from_heads(const FlowGraph& graph, std::span<const Index> heads) {
    std::vector<std::uint8_t> channel(graph.size(), 0);
    for (const Index head : heads) {
        for (Index node = head; node != none && !channel[node]; node = graph.receiver[node]) channel[node] = 1;
    }
    return channel;
}

std::vector<Index> channel_order(const FlowGraph& graph, std::span<const std::uint8_t> channel) {
    constexpr std::size_t ahead = 32;
    std::vector<Index> nodes;
    for (std::size_t at = 0; at < graph.order.size(); ++at) {
        if (at + ahead < graph.order.size()) __builtin_prefetch(&channel[graph.order[at + ahead]]);
        if (channel[graph.order[at]]) nodes.push_back(graph.order[at]);
    }
    return nodes;
}

std::vector<Index> channel_heads(const FlowGraph& graph, std::span<const std::uint8_t> channel) {
    std::vector<Index> heads = channel_order(graph, channel);
    const auto donors = donor_counts(graph, channel, heads);
    std::erase_if(heads, [&](Index node) { return donors[node] > 0; });
    std::ranges::sort(heads);
    return heads;
}

std::vector<Index> strahler_orders(const FlowGraph& graph, std::span<const std::uint8_t> channel) {
    return orders_along(graph, channel, channel_order(graph, channel));
}

std::vector<Index> shreve_magnitudes(const FlowGraph& graph, std::span<const std::uint8_t> channel) {
    return magnitudes_along(graph, channel, channel_order(graph, channel));
}

StreamNetwork stream_network(const FlowGraph& graph, std::span<const std::uint8_t> channel,
                             std::span<const double> drainage_area_m2, std::span<const double> elevation_m) {
    const std::vector<Index> nodes = channel_order(graph, channel);
    const auto donors = donor_counts(graph, channel, nodes);
    StreamNetwork network = laid_out(number_links(graph, channel, nodes, donors), nodes);
    network.strahler = at_upper_ends(network, orders_along(graph, channel, nodes));
    network.shreve = at_upper_ends(network, magnitudes_along(graph, channel, nodes));
    measure_links(graph, donors, drainage_area_m2, elevation_m, network);
    return network;
}

}  // namespace thalweg::channel
