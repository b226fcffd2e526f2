// SPDX-License-Identifier: GPL-3.0-or-later
#include "thalweg/terrain/accumulate.hpp"

#include <algorithm>
#include <ranges>

#include "terrain/blocks.hpp"
#include "terrain/check_sizes.hpp"

namespace thalweg::terrain {
namespace {

/// Sweeps jump about in memory, but the list says where they will be: this many nodes ahead are asked for early.
constexpr Index ahead = 24;

/// Calls give(node) for the nodes order[begin, end) that have a receiver, the last first. Those whose receiver lies
/// outside of the block are only noted.
template <class Give>
void part_down(const FlowGraph& graph, Index begin, Index end, Index first, Index size, const Give& give,
               std::vector<Index>& crossing) {
    for (Index at = end; at-- > begin;) {
        if (at >= begin + ahead) graph.receiver.fetch(graph.order[at - ahead]);
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
    if (layers.part.size() != blocks.count() + 2) {
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

}  // namespace

std::vector<double> accumulate(const FlowGraph& graph, std::span<const double> amount) {
    check_sizes(graph.size(), amount.size(), amount.size());
    std::vector<double> sum(amount.begin(), amount.end());
    if (graph.order.size() < sum.size()) {
        std::fill(sum.begin(), sum.end(), 0.0);
        for (const Index node : graph.order) sum[node] = amount[node];
    }
    from_leaves_down(graph, [&](Index node) { sum[graph.receiver[node]] += sum[node]; });
    return sum;
}

std::vector<double> cell_areas(const Grid& grid) {
    std::vector<double> areas(grid.size());
    for (Index row = 0; row < grid.rows; ++row) {
        std::fill_n(areas.begin() + std::size_t{row} * grid.cols, grid.cols, grid.cell_area[row]);
    }
    return areas;
}

std::vector<double> cell_areas(const Mesh& mesh) { return mesh.cell_area; }

std::vector<double> carve(const FlowGraph& graph, std::span<const double> elevation_m) {
    check_sizes(graph.size(), elevation_m.size(), elevation_m.size());
    std::vector<double> carved(elevation_m.begin(), elevation_m.end());
    from_leaves_down(graph, [&](Index node) {
        const Index receiver = graph.receiver[node];
        carved[receiver] = std::min(carved[receiver], carved[node]);
    });
    return carved;
}

std::vector<double> largest_upstream(const FlowGraph& graph, std::span<const double> values) {
    check_sizes(graph.size(), values.size(), values.size());
    std::vector<double> largest(values.begin(), values.end());
    for (const Index node : std::views::reverse(graph.order)) {
        const Index receiver = graph.receiver[node];
        if (receiver != none) largest[receiver] = std::max(largest[receiver], largest[node]);
    }
    return largest;
}

}  // namespace thalweg::terrain
