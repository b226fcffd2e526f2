// SPDX-License-Identifier: GPL-3.0-or-later
#include "thalweg/terrain/basins.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <ranges>
#include <tuple>

#include "terrain/check_sizes.hpp"
#include "terrain/sweeps.hpp"
#include "thalweg/core/error.hpp"
#include "thalweg/core/parallel.hpp"

namespace thalweg::terrain {
namespace {

/// The only outlet that more than half of the nodes with data can reach (majority vote of Boyer and Moore).
Index most_likely_outlet(std::span<const Index> outlet) {
    Index candidate = none;
    std::size_t lead = 0;
    for (const Index reached : outlet) {
        if (reached == none) continue;
        if (lead == 0) candidate = reached;
        reached == candidate ? ++lead : --lead;
    }
    return candidate;
}

/// True if at least 99 % of the nodes with data reach the same outlet.
bool is_one_catchment(const FlowGraph& graph, std::span<const Index> outlet) {
    if (graph.order.empty()) return true;
    const auto most = static_cast<std::uint64_t>(std::ranges::count(outlet, most_likely_outlet(outlet)));
    return most * 100 >= std::uint64_t{graph.order.size()} * 99;
}

/// Rows and columns between two cells, whichever is more.
Index cells_apart(const Grid& grid, Index a, Index b) {
    const auto apart = [](Index p, Index q) { return p > q ? p - q : q - p; };
    return std::max(apart(grid.row(a), grid.row(b)), apart(grid.col(a), grid.col(b)));
}

/// From the middle of a row of cells to the next one south (of the last row: to the one before).
double row_height(const Grid& grid, Index row) {
    if (grid.north_south.empty()) return grid.cell_area[row] / grid.east_west[row];
    return grid.north_south[std::min<std::size_t>(row, grid.north_south.size() - 1)];
}

/// What a crossing of each of the four ways to a neighbour (slots 0 to 3) counts in a length: half the distance of
/// parallel lines, times the angle between the middles to the next directions.
std::array<double, 4> crossing_lengths(double east_west_m, double north_south_m) {
    const double steep = std::atan2(north_south_m, east_west_m);  // of the diagonals, from the east
    const double flat = std::numbers::pi / 2 - steep;
    const double diagonal = std::numbers::pi / 4;  // half of what lies between its two neighbours, a right angle
    const double between = east_west_m * north_south_m / std::hypot(east_west_m, north_south_m);
    return {steep * north_south_m / 2, diagonal * between / 2, flat * east_west_m / 2, diagonal * between / 2};
}

void sort_largest_first(std::vector<Basin>& basins) {
    std::sort(basins.begin(), basins.end(), [](const Basin& a, const Basin& b) {
        return std::tuple(-a.area_m2, a.outlet) < std::tuple(-b.area_m2, b.outlet);
    });
}

}  // namespace

std::vector<Index> outlet_of(const FlowGraph& graph) {
    std::vector<Index> outlet(graph.size(), none);
    from_outlets_up(graph, [&](Index node) {
        const Index receiver = graph.receiver[node];
        outlet[node] = receiver == none ? node : outlet[receiver];
    });
    return outlet;
}

std::vector<std::uint8_t> complete_catchments(const Grid& grid, const FlowGraph& graph,
                                              std::span<const Boundary> boundary) {
    check_sizes(grid.size(), graph.size(), boundary.size());
    constexpr Index excused = 2;
    const std::vector<Index> outlet = outlet_of(graph);
    const bool one_catchment = is_one_catchment(graph, outlet);
    const auto is_whole = [&](Index node) {
        return one_catchment || boundary[node] == Boundary::interior ||
               cells_apart(grid, node, outlet[node]) <= excused;
    };
    std::vector<std::uint8_t> complete(graph.size());
    parallel_for(0, graph.size(), [&](Index first, Index last) {
        for (Index node = first; node < last; ++node) complete[node] = outlet[node] != none && is_whole(node);
    });
    // What an incomplete node flows to is incomplete too, down to one that is: from there on that one's own turn does
    // it.
    for (Index node = 0; node < graph.size(); ++node) {
        if (complete[node]) continue;
        for (Index below = graph.receiver[node]; below != none && complete[below]; below = graph.receiver[below]) {
            complete[below] = 0;
        }
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
    from_outlets_up(graph, [&](Index node) {
        const Index receiver = graph.receiver[node];
        if (receiver == none || label[receiver] == none) return;
        if (label[node] != none) {
            throw Error(fmt::format("basins may not overlap, but the one with outlet {} lies in that with outlet {}",
                                    node, basins[label[receiver]].outlet));
        }
        label[node] = label[receiver];
    });
    return label;
}

BasinNodes nodes_of_basins(std::span<const Index> label, Index basins) {
    BasinNodes rows{std::vector<Index>(basins + 1, 0), {}};
    for (const Index basin : label) {
        if (basin != none) ++rows.offset[basin + 1];
    }
    for (Index basin = 0; basin < basins; ++basin) rows.offset[basin + 1] += rows.offset[basin];
    rows.node.resize(rows.offset.back());
    std::vector<Index> next(rows.offset.begin(), rows.offset.end() - 1);
    for (Index node = 0; node < label.size(); ++node) {
        if (label[node] != none) rows.node[next[label[node]]++] = node;
    }
    return rows;
}

std::vector<double> basin_perimeters(const Grid& grid, std::span<const Index> label, Index basins) {
    check_sizes(grid.size(), label.size(), label.size());
    std::vector<double> length(basins, 0);
    const auto crossed = [&](Index a, Index b, double counts) {
        if (a == b) return;
        if (a != none) length[a] += counts;
        if (b != none) length[b] += counts;
    };
    // The lines go on beyond the grid: it is bordered by a row and a column of no basin on every side.
    const std::vector<Index> outside(grid.cols, none);
    const auto row_of = [&](std::int64_t row) {
        const bool inside = row >= 0 && row < grid.rows;
        return inside ? label.subspan(static_cast<std::size_t>(row) * grid.cols, grid.cols) : std::span(outside);
    };
    for (std::int64_t row = -1; row < grid.rows; ++row) {
        const auto own = static_cast<Index>(std::max<std::int64_t>(row, 0));
        const auto counts = crossing_lengths(grid.east_west[own], row_height(grid, own));
        const auto upper = row_of(row), lower = row_of(row + 1);
        Index here = none, south = none;
        for (Index col = 0; col <= grid.cols; ++col) {
            const Index east = col < grid.cols ? upper[col] : none, beyond = col < grid.cols ? lower[col] : none;
            if (here != east || here != south || here != beyond) {
                crossed(here, east, counts[0]);
                crossed(here, beyond, counts[1]);
                crossed(here, south, counts[2]);
                crossed(east, south, counts[3]);
            }
            here = east;
            south = beyond;
        }
    }
    return length;
}

}  // namespace thalweg::terrain
