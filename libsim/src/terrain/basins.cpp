// SPDX-License-Identifier: GPL-3.0-or-later
#include "thalweg/terrain/basins.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <ranges>
#include <tuple>

#include "terrain/check_sizes.hpp"
#include "thalweg/core/error.hpp"

namespace thalweg::terrain {
namespace {

/// True if at least 99 % of the nodes with data reach the same outlet.
bool is_one_catchment(const FlowGraph& graph, std::span<const Index> outlet) {
    std::vector<Index> reached(graph.size(), 0);
    for (const Index node : graph.order) ++reached[outlet[node]];
    const Index most = reached.empty() ? 0 : *std::max_element(reached.begin(), reached.end());
    return std::uint64_t{most} * 100 >= std::uint64_t{graph.order.size()} * 99;
}

/// Rows and columns between two cells, whichever is more.
Index cells_apart(const Grid& grid, Index a, Index b) {
    const auto apart = [](Index p, Index q) { return p > q ? p - q : q - p; };
    return std::max(apart(grid.row(a), grid.row(b)), apart(grid.col(a), grid.col(b)));
}

void sort_largest_first(std::vector<Basin>& basins) {
    std::sort(basins.begin(), basins.end(), [](const Basin& a, const Basin& b) {
        return std::tuple(-a.area_m2, a.outlet) < std::tuple(-b.area_m2, b.outlet);
    });
}

}  // namespace

std::vector<Index> outlet_of(const FlowGraph& graph) {
    std::vector<Index> outlet(graph.size(), none);
    for (const Index node : graph.order) {
        const Index receiver = graph.receiver[node];
        outlet[node] = receiver == none ? node : outlet[receiver];
    }
    return outlet;
}

std::vector<std::uint8_t> complete_catchments(const Grid& grid, const FlowGraph& graph,
                                              std::span<const Boundary> boundary) {
    check_sizes(grid.size(), graph.size(), boundary.size());
    constexpr Index excused = 2;
    std::vector<std::uint8_t> complete(graph.size(), 0);
    const std::vector<Index> outlet = outlet_of(graph);
    const bool one_catchment = is_one_catchment(graph, outlet);
    for (const Index node : graph.order) {
        complete[node] =
            one_catchment || boundary[node] == Boundary::interior || cells_apart(grid, node, outlet[node]) <= excused;
    }
    if (one_catchment) return complete;
    for (const Index node : std::views::reverse(graph.order)) {
        if (!complete[node] && graph.receiver[node] != none) complete[graph.receiver[node]] = 0;
    }
    return complete;
}

std::vector<Basin> basins(const FlowGraph& graph, std::span<const double> drainage_area_m2,
                          std::span<const std::uint8_t> complete, double smallest_area_m2, EdgeBasins edge_basins) {
    check_sizes(graph.size(), drainage_area_m2.size(), complete.size());
    std::vector<Basin> found;
    for (const Index node : graph.order) {
        const Index receiver = graph.receiver[node];
        const bool leaves = receiver == none;
        const bool maximal = complete[node] && (leaves || !complete[receiver]);
        const bool wanted = edge_basins == EdgeBasins::keep ? leaves : maximal;
        if (!wanted || drainage_area_m2[node] < smallest_area_m2) continue;
        found.push_back({.outlet = node, .area_m2 = drainage_area_m2[node], .complete = complete[node] != 0});
    }
    sort_largest_first(found);
    return found;
}

std::vector<Index> basin_labels(const FlowGraph& graph, std::span<const Basin> basins) {
    std::vector<Index> label(graph.size(), none);
    for (Index number = 0; number < basins.size(); ++number) label.at(basins[number].outlet) = number;
    for (const Index node : graph.order) {
        const Index receiver = graph.receiver[node];
        if (receiver == none || label[receiver] == none) continue;
        if (label[node] != none) {
            throw Error(fmt::format("basins may not overlap, but the one with outlet {} lies in that with outlet {}",
                                    node, basins[label[receiver]].outlet));
        }
        label[node] = label[receiver];
    }
    return label;
}

}  // namespace thalweg::terrain
