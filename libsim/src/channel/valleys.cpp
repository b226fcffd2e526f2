// SPDX-License-Identifier: GPL-3.0-or-later
#include "thalweg/channel/valleys.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "channel/directions.hpp"
#include "channel/valley_map.hpp"

namespace thalweg::channel {

namespace {

constexpr double nan = std::numeric_limits<double>::quiet_NaN();

/// Area that drains to each link but not by way of the links above.
std::vector<double> own_areas(const StreamNetwork& network) {
    std::vector<double> own = network.area_m2;
    for (Index link = 0; link < network.size(); ++link) {
        if (network.downstream[link] != none) own[network.downstream[link]] -= network.area_m2[link];
    }
    return own;
}

/// How far a straight line from the centre of a cell runs through cells that are inside, in steps of half a cell.
template <class IsInside>
double length_within(const Grid& grid, Index from, const Point& direction, IsInside is_inside) {
    const Index row = grid.row(from);
    const double width = grid.east_west[row];
    const double height = grid.north_south.empty() ? width : grid.north_south[std::min(row, grid.rows - 2)];
    const double norm = std::hypot(direction.x, direction.y);
    if (!(norm > 0)) return 0;
    const double step = std::min(width, height) / 2;
    double reached = 0;
    for (double along = step;; along += step) {
        const double col = grid.col(from) + 0.5 + along * direction.x / (norm * width);
        const double down = row + 0.5 - along * direction.y / (norm * height);
        if (!(col >= 0 && col < grid.cols && down >= 0 && down < grid.rows)) return reached;
        if (!is_inside(static_cast<Index>(down) * grid.cols + static_cast<Index>(col))) return reached;
        reached = along;
    }
}

}  // namespace

Estimate channel_maintenance(const StreamNetwork& network) {
    const auto own = own_areas(network);
    double area = 0, length = 0, squares = 0;
    for (Index link = 0; link < network.size(); ++link) {
        area += own[link];
        length += network.length_m[link];
    }
    const double c = area / length, count = network.size();
    for (Index link = 0; link < network.size(); ++link) {
        squares += std::pow(own[link] - c * network.length_m[link], 2);
    }
    if (network.size() < 2) return {c, nan, {nan, nan}};
    const double error = std::sqrt(squares * count / (count - 1)) / length;
    const double half = student_t95(count - 1) * error;
    return {c, error, {c - half, c + half}};
}

UniformDraw headward_reach(const StreamNetwork& network, const MainStreams& streams,
                           std::span<const double> beyond_source_m) {
    std::vector<Index> links(streams.parent.size(), 0);
    for (const Index stream : streams.stream) ++links[stream];
    std::vector<double> shares;
    for (Index link = 0; link < network.size(); ++link) {
        const Index stream = streams.stream[link];
        if (links[stream] != 1 || streams.parent[stream] == none) continue;
        const double way = network.length_m[link] + beyond_source_m[link];
        if (way > 0) shares.push_back(network.length_m[link] / way);
    }
    return uniform_draw(shares);
}

std::vector<double> beyond_sources(const Grid& grid, const terrain::FlowGraph& graph, const StreamNetwork& network,
                                   double reach_m) {
    const auto link_of = link_of_nodes(network, graph.size());
    const auto offset = offsets(grid);
    const Valleys v = valleys(graph, offset, link_of);
    std::vector<double> beyond(network.size(), 0);
    for (Index link = 0; link < network.size(); ++link) {
        if (network.shreve[link] != 1) continue;
        const auto nodes = network.nodes_of(link);
        const Point down = downstream_direction(nodes, offset, reach_m);
        beyond[link] = length_within(grid, nodes.front(), {-down.x, -down.y},
                                     [&](Index node) { return v.foot[node] != none && link_of[v.foot[node]] == link; });
    }
    return beyond;
}

std::vector<ValleySide> valley_sides(const Grid& grid, const terrain::FlowGraph& graph,
                                     std::span<const double> elevation_m, const StreamNetwork& network) {
    const auto link_of = link_of_nodes(network, graph.size());
    const auto offset = offsets(grid);
    const Valleys v = valleys(graph, offset, link_of);
    const auto valley = [&](Index node) { return v.foot[node] == none ? none : link_of[v.foot[node]]; };
    std::vector<ValleySide> sides;
    for (Index link = 0; link < network.size(); ++link) {
        sides.push_back({.link = link, .bank = Bank::left});
        sides.push_back({.link = link, .bank = Bank::right});
    }
    for (const Index node : graph.order) {
        if (v.foot[node] == none || v.foot[node] == node) continue;
        bool is_ridge = false;
        grid.neighbors(node, [&](Index other, double, Slot) { is_ridge = is_ridge || valley(other) != valley(node); });
        if (!is_ridge) continue;
        const Point away = offset(v.foot[node], node);
        const double cell = std::sqrt(grid.area(node));
        ValleySide& side = sides[2 * valley(node) + static_cast<Index>(v.bank[node])];
        side.ridge_m += cell;
        side.rise_m += cell * (elevation_m[node] - elevation_m[v.foot[node]]);
        side.run_m += cell * std::hypot(away.x, away.y);
    }
    std::erase_if(sides, [](const ValleySide& side) { return side.ridge_m == 0; });
    for (ValleySide& side : sides) {
        side.rise_m /= side.ridge_m;
        side.run_m /= side.ridge_m;
    }
    return sides;
}

UniformDraw sidewall_angles(std::span<const ValleySide> sides) {
    std::vector<double> angles, weights;
    for (const ValleySide& side : sides) {
        angles.push_back(std::atan2(side.rise_m, side.run_m) * 180 / std::numbers::pi);
        weights.push_back(side.ridge_m);
    }
    return uniform_draw(angles, weights);
}

}  // namespace thalweg::channel
