// SPDX-License-Identifier: GPL-3.0-or-later
#include "thalweg/grow/links.hpp"

#include <algorithm>
#include <numeric>

namespace thalweg::grow {
namespace {

/// Strahler (1957): one more than the inflows' order where both share it.
std::vector<Index> strahler_orders(const Network& network) {
    std::vector<Index> order(network.size(), 1);
    for (Index link = network.size(); link-- > 0;) {
        if (network.is_exterior(link)) continue;
        const Index a = order[network.upstream[link][0]];
        const Index b = order[network.upstream[link][1]];
        order[link] = a == b ? a + 1 : std::max(a, b);
    }
    return order;
}

}  // namespace

double total_length(const Network& network) {
    return std::accumulate(network.length_m.begin(), network.length_m.end(), 0.0);
}

double total_area(const Network& network) {
    return std::accumulate(network.polygon_area_m2.begin(), network.polygon_area_m2.end(), 0.0);
}

channel::StreamNetwork stream_network(const Network& network, std::span<const double> elevation_m) {
    channel::StreamNetwork streams;
    streams.downstream = network.downstream;
    streams.shreve = network.magnitude;
    streams.strahler = strahler_orders(network);
    streams.length_m = network.length_m;
    streams.offset.push_back(0);
    for (Index link = 0; link < network.size(); ++link) {
        streams.nodes.insert(streams.nodes.end(), {network.upper[link], network.lower[link]});
        streams.offset.push_back(static_cast<Index>(streams.nodes.size()));
        streams.drop_m.push_back(elevation_m[network.upper[link]] - elevation_m[network.lower[link]]);
        streams.area_m2.push_back(network.area_m2(link));
    }
    for (Index link = network.size(); link-- > 1;) {
        streams.area_m2[network.downstream[link]] += streams.area_m2[link];
    }
    return streams;
}

}  // namespace thalweg::grow
