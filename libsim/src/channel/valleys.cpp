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

constexpr Index jackknife_groups = 20;
constexpr double share_known = 0.99;  // of the ridges; farther out a few odd ones would decide

Index side_number(const RidgePiece& piece) { return 2 * piece.link + static_cast<Index>(piece.bank); }

/// Of pieces in the order of their distance.
double distance_of_share(std::span<const RidgePiece> sorted, double share) {
    double whole = 0, sum = 0;
    for (const RidgePiece& piece : sorted) whole += piece.length_m;
    for (const RidgePiece& piece : sorted) {
        sum += piece.length_m;
        if (sum >= share * whole) return piece.run_m;
    }
    return nan;
}

/// What `sidewall_reach` is, of pieces in the order of their distance. With s at its best for an R the sum of squares
/// is less by (Σ w·x·h)²/Σ w·x², x = min(run, R); between the distances of two neighbouring pieces that is
/// (near_xh + R·far_h)²/(near_xx + R²·far_w), largest at R = far_h·near_xx/(near_xh·far_w).
double best_reach(std::span<const RidgePiece> sorted) {
    const double known = distance_of_share(sorted, share_known);
    double near_xh = 0, near_xx = 0, far_h = 0, far_w = 0;
    for (const RidgePiece& p : sorted) {
        far_h += p.length_m * p.rise_m;
        far_w += p.length_m;
    }
    double best = nan, most = 0;
    const auto look_at = [&](double reach) {
        const double xh = near_xh + reach * far_h;
        const double gain = xh > 0 ? xh * xh / (near_xx + reach * reach * far_w) : 0;
        if (gain > most) {
            most = gain;
            best = reach;
        }
    };
    double last = 0;
    for (const RidgePiece& p : sorted) {
        const double next = std::min(p.run_m, known);
        const double between = far_h * near_xx / (near_xh * far_w);
        if (between > last && between < next) look_at(between);
        if (next > 0) look_at(next);
        if (p.run_m >= known) break;
        last = next;
        near_xh += p.length_m * p.run_m * p.rise_m;
        near_xx += p.length_m * p.run_m * p.run_m;
        far_h -= p.length_m * p.rise_m;
        far_w -= p.length_m;
    }
    return best;
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

std::vector<RidgePiece> ridge_pieces(const Grid& grid, const terrain::FlowGraph& graph,
                                     std::span<const double> elevation_m, const StreamNetwork& network) {
    const auto link_of = link_of_nodes(network, graph.size());
    const auto offset = offsets(grid);
    const Valleys v = valleys(graph, offset, link_of);
    const auto valley = [&](Index node) { return v.foot[node] == none ? none : link_of[v.foot[node]]; };
    std::vector<RidgePiece> pieces;
    for (const Index node : graph.order) {
        if (v.foot[node] == none || v.foot[node] == node) continue;
        bool is_ridge = false;
        grid.neighbors(node, [&](Index other, double, Slot) { is_ridge = is_ridge || valley(other) != valley(node); });
        if (!is_ridge) continue;
        const Point away = offset(v.foot[node], node);
        pieces.push_back({.link = valley(node),
                          .bank = v.bank[node],
                          .length_m = std::sqrt(grid.area(node)),
                          .rise_m = elevation_m[node] - elevation_m[v.foot[node]],
                          .run_m = std::hypot(away.x, away.y)});
    }
    return pieces;
}

double ridge_distance(std::span<const RidgePiece> pieces, double share) {
    std::vector<RidgePiece> sorted(pieces.begin(), pieces.end());
    std::ranges::stable_sort(sorted, {}, &RidgePiece::run_m);
    return distance_of_share(sorted, share);
}

Estimate sidewall_reach(std::span<const RidgePiece> pieces) {
    std::vector<RidgePiece> sorted(pieces.begin(), pieces.end());
    std::ranges::stable_sort(sorted, {}, &RidgePiece::run_m);
    const double reach = best_reach(sorted);
    std::vector<double> without;
    for (Index group = 0; group < jackknife_groups; ++group) {
        std::vector<RidgePiece> others = sorted;
        std::erase_if(others, [&](const RidgePiece& p) { return side_number(p) % jackknife_groups == group; });
        if (others.size() < sorted.size()) without.push_back(best_reach(others));
    }
    const auto groups = static_cast<double>(without.size());
    const double error = standard_deviation(without) * (groups - 1) / std::sqrt(groups);
    return {reach, error, {reach - 1.96 * error, reach + 1.96 * error}};
}

std::vector<ValleySide> valley_sides(std::span<const RidgePiece> pieces, double reach_m) {
    Index links = 0;
    for (const RidgePiece& piece : pieces) links = std::max(links, piece.link + 1);
    std::vector<ValleySide> sides;
    for (Index link = 0; link < links; ++link) {
        sides.push_back({.link = link, .bank = Bank::left});
        sides.push_back({.link = link, .bank = Bank::right});
    }
    for (const RidgePiece& piece : pieces) {
        ValleySide& side = sides[side_number(piece)];
        side.ridge_m += piece.length_m;
        side.rise_m += piece.length_m * piece.rise_m;
        side.run_m += piece.length_m * std::min(piece.run_m, reach_m);
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
