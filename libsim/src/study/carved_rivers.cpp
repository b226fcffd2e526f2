// SPDX-License-Identifier: GPL-3.0-or-later
#include "study/carved_rivers.hpp"

#include <algorithm>
#include <utility>

#include "study/channel_choice.hpp"
#include "thalweg/terrain/accumulate.hpp"
#include "thalweg/terrain/flats.hpp"
#include "thalweg/terrain/lakes.hpp"
#include "thalweg/terrain/route.hpp"

namespace thalweg::study {
namespace {

struct Carved {
    terrain::GraphAndArea routed;
    std::vector<double> filled_m;  ///< where the raster is to be filled
};

Carved carved_graph(const Raster& raster, std::span<const Boundary> boundary, const MeasureOptions& options,
                    ConditioningReport& report) {
    Carved carved;
    FlowDirections directions = terrain::route(raster.grid, raster.values, boundary);
    report.flat_cells = terrain::resolve_flats(raster.grid, raster.values, boundary, directions);
    if (options.conditioning == Conditioning::fill) {
        terrain::DrainedAndFilled d = terrain::drain_and_fill(raster.grid, raster.values, boundary, directions);
        report.pits = d.lakes;
        carved.filled_m = std::move(d.filled_m);
    } else {
        report.pits = terrain::drain_lakes(raster.grid, raster.values, boundary, directions);
    }
    carved.routed = terrain::graph_and_area(raster.grid, raster.values, std::move(directions));
    return carved;
}

/// Where channels may run. Rules that are still to be decided on the conditioned terrain leave everything open.
std::vector<std::uint8_t> possible_channels(const RoutedTerrain& carved, const MeasureOptions& options) {
    const bool open = options.channels == ChannelRule::slope_area || options.channels == ChannelRule::drop;
    if (!open) return channels_in_use(carved, options, channel_threshold(carved, options));
    const auto used = nodes_in_use(carved, options);
    if (used.empty()) return std::vector<std::uint8_t>(carved.graph.size(), 1);
    return {used.begin(), used.end()};
}

/// The flagged nodes and those that they flow to.
std::vector<Index> with_receivers(const terrain::FlowGraph& graph, std::vector<std::uint8_t> flagged) {
    for (Index node = 0; node < graph.size(); ++node) {
        if ((flagged[node] & 1) != 0 && graph.receiver[node] != none) flagged[graph.receiver[node]] |= 2;
    }
    std::vector<Index> nodes;
    for (Index node = 0; node < graph.size(); ++node) {
        if (flagged[node] != 0) nodes.push_back(node);
    }
    return nodes;
}

std::vector<Index> places(std::span<const Index> nodes, Index size) {
    std::vector<Index> place(size, none);
    for (Index at = 0; at < nodes.size(); ++at) place[nodes[at]] = at;
    return place;
}

/// The graph among these nodes: water that leaves them ends there.
terrain::FlowGraph graph_among(const terrain::FlowGraph& graph, std::span<const Index> nodes) {
    const std::vector<Index> place = places(nodes, graph.size());
    std::vector<Index> receiver(nodes.size());
    std::vector<double> length(nodes.size());
    for (std::size_t at = 0; at < nodes.size(); ++at) {
        const Index below = graph.receiver[nodes[at]];
        receiver[at] = below == none ? none : place[below];
        length[at] = receiver[at] == none ? 0 : graph.length[nodes[at]];
    }
    terrain::FlowGraph part{.receiver = std::move(receiver), .length = std::move(length), .order = {}};
    for (const Index node : graph.order) {
        if (place[node] != none) part.order.push_back(place[node]);
    }
    return part;
}

template <class T, class Values>
std::vector<T> at(std::span<const Index> nodes, const Values& values) {
    std::vector<T> picked;
    picked.reserve(nodes.size());
    for (const Index node : nodes) picked.push_back(values[node]);
    return picked;
}

}  // namespace

CarvedRivers carved_rivers(const Raster& raster, std::span<const Boundary> boundary, const MeasureOptions& options,
                           ConditioningReport& report) {
    RoutedTerrain whole;
    Carved carved = carved_graph(raster, boundary, options, report);
    whole.graph = std::move(carved.routed.graph);
    whole.drainage_area_m2 = std::move(carved.routed.drainage_area_m2);
    whole.cell_area_m2 = CellAreas(raster.grid);
    whole.complete = terrain::complete_catchments(raster.grid, whole.graph, boundary);
    CarvedRivers rivers;
    rivers.filled_m = std::move(carved.filled_m);
    rivers.node = with_receivers(whole.graph, possible_channels(whole, options));
    rivers.terrain.cell_area_m2 = at<double>(rivers.node, whole.cell_area_m2);
    rivers.terrain.elevation_m = at<double>(rivers.node, terrain::carve(whole.graph, raster.values));
    rivers.terrain.graph = graph_among(whole.graph, rivers.node);
    rivers.terrain.drainage_area_m2 = at<double>(rivers.node, whole.drainage_area_m2);
    rivers.terrain.complete = at<std::uint8_t>(rivers.node, whole.complete);
    return rivers;
}

MeasureOptions on_rivers(const CarvedRivers& rivers, const MeasureOptions& options) {
    MeasureOptions placed = options;
    if (!options.heads) return placed;
    placed.heads->cells.clear();
    for (const Index cell : options.heads->cells) {
        const auto found = std::ranges::lower_bound(rivers.node, cell);
        // A head that is not among them begins a channel that is not in use.
        if (found == rivers.node.end() || *found != cell) continue;
        placed.heads->cells.push_back(static_cast<Index>(found - rivers.node.begin()));
    }
    return placed;
}

void name_raster_nodes(const CarvedRivers& rivers, std::vector<channel::SlopeAreaPoint>& slopes, ChiStatistics& chi) {
    for (channel::SlopeAreaPoint& point : slopes) {
        if (point.node != none) point.node = rivers.node[point.node];
    }
    for (Index& node : chi.profile.node) node = rivers.node[node];
}

}  // namespace thalweg::study
