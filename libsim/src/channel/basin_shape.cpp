// SPDX-License-Identifier: GPL-3.0-or-later
#include "thalweg/channel/basin_shape.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <mutex>
#include <numbers>
#include <unordered_map>

#include "channel/directions.hpp"
#include "thalweg/core/parallel.hpp"

namespace thalweg::channel {
namespace {

double over(double a, double b) { return b > 0 ? a / b : std::numeric_limits<double>::quiet_NaN(); }

/// A node of a trunk, with its neighbours along it.
struct TrunkNode {
    Index basin;
    Index up = none;
    Index down = none;
};

/// The link that carries most water to each basin's outlet (ties: the first), `none` where there is none.
std::vector<Index> last_links(const StreamNetwork& network, std::span<const terrain::Basin> basins) {
    std::unordered_map<Index, Index> basin_at;
    for (Index basin = 0; basin < basins.size(); ++basin) basin_at[basins[basin].outlet] = basin;
    std::vector<Index> last(basins.size(), none);
    for (Index link = 0; link < network.size(); ++link) {
        if (network.downstream[link] != none) continue;
        const auto found = basin_at.find(network.nodes_of(link).back());
        if (found == basin_at.end()) continue;
        Index& best = last[found->second];
        if (best == none || network.area_m2[link] > network.area_m2[best]) best = link;
    }
    return last;
}

using Trunks = std::unordered_map<Index, TrunkNode>;

/// Links of one stream are walked from the mouth up, since a link comes after the one it flows into.
Trunks trunks(const terrain::FlowGraph& graph, const StreamNetwork& network, const MainStreams& streams,
              std::span<const terrain::Basin> basins) {
    std::unordered_map<Index, Index> basin_of_stream;
    const auto last = last_links(network, basins);
    for (Index basin = 0; basin < basins.size(); ++basin) {
        if (last[basin] != none) basin_of_stream[streams.stream[last[basin]]] = basin;
    }
    Trunks trunk;
    for (Index link = 0; link < network.size(); ++link) {
        const auto found = basin_of_stream.find(streams.stream[link]);
        if (found == basin_of_stream.end()) continue;
        const auto nodes = network.nodes_of(link);
        for (std::size_t i = 0; i < nodes.size(); ++i) {
            TrunkNode& node = trunk[nodes[i]];
            node.basin = found->second;
            if (i > 0) node.up = nodes[i - 1];
            node.down = graph.receiver[nodes[i]];
        }
    }
    return trunk;
}

}  // namespace

BasinShape basin_shape(double area_m2, double length_m, double perimeter_m, double relief_m) {
    return {.form_factor = over(area_m2, length_m * length_m),
            .circularity = over(4 * std::numbers::pi * area_m2, perimeter_m * perimeter_m),
            .elongation = over(2 * std::sqrt(area_m2 / std::numbers::pi), length_m),
            .relief_ratio = over(relief_m, length_m),
            .ruggedness = over(relief_m, std::sqrt(area_m2))};
}

std::vector<double> basin_lengths(const terrain::BasinNodes& rows, std::span<const terrain::Basin> basins,
                                  const OffsetOf& offset) {
    std::vector<double> length(basins.size(), 0);
    std::mutex writing;
    const auto measure = [&](Index first, Index last) {
        auto basin = static_cast<Index>(std::ranges::upper_bound(rows.offset, first) - rows.offset.begin() - 1);
        while (first < last) {
            const Index end = std::min(last, rows.offset[basin + 1]);
            double farthest = 0;
            for (Index i = first; i < end; ++i) {
                const Point away = offset(basins[basin].outlet, rows.node[i]);
                farthest = std::max(farthest, away.x * away.x + away.y * away.y);
            }
            const std::scoped_lock lock(writing);  // a maximum is the same in any order
            length[basin] = std::max(length[basin], std::sqrt(farthest));
            first = end;
            ++basin;
        }
    };
    parallel_for(0, static_cast<Index>(rows.node.size()), measure);
    return length;
}

std::vector<TrunkSides> trunk_sides(const terrain::FlowGraph& graph, std::span<const double> drainage_area_m2,
                                    const StreamNetwork& network, const MainStreams& of_links,
                                    std::span<const terrain::Basin> basins, const OffsetOf& offset) {
    const Trunks trunk = trunks(graph, network, of_links, basins);
    std::vector<std::uint8_t> on_trunk(graph.size(), 0);
    for (const auto& [node, _] : trunk) on_trunk[node] = 1;
    std::vector<TrunkSides> sides(basins.size(), {0, 0});
    for (Index node = 0; node < graph.size(); ++node) {
        const Index receiver = graph.receiver[node];
        if (receiver == none || !on_trunk[receiver] || on_trunk[node]) continue;
        const TrunkNode& at = trunk.at(receiver);
        if (at.up == none || at.down == none) continue;
        const Point down = offset(receiver, at.down);
        const bool left = turn(down, offset(receiver, node)) < turn(down, offset(receiver, at.up));
        TrunkSides& side = sides[at.basin];
        (left ? side.left_m2 : side.right_m2) += drainage_area_m2[node];
    }
    return sides;
}

}  // namespace thalweg::channel
