// SPDX-License-Identifier: GPL-3.0-or-later
#include "thalweg/channel/links.hpp"

#include <cmath>
#include <limits>
#include <numbers>
#include <numeric>
#include <utility>

#include "channel/directions.hpp"
#include "thalweg/channel/laws.hpp"
#include "thalweg/core/statistics.hpp"

namespace thalweg::channel {

namespace {

LengthStatistics statistics(const std::vector<double>& lengths_m) {
    return {static_cast<Index>(lengths_m.size()), mean(lengths_m), standard_deviation(lengths_m)};
}

/// Slope below the junction over the slope of an inflow, by Flint's law.
double slope_ratio(const StreamNetwork& network, Index below, Index inflow, double flint_exponent) {
    return std::pow((2.0 * network.shreve[below] - 1) / (2.0 * network.shreve[inflow] - 1), flint_exponent);
}

/// Whether the smaller of two inflows comes from the left, looking downstream.
bool from_the_left(const StreamNetwork& network, const OffsetOf& offset, double reach_m, const JunctionInflows& in,
                   Index below) {
    const auto [main, tributary] = main_and_tributary(network, in);
    return is_left_of(network, offset, reach_m, {.below = below, .main = main, .tributary = tributary});
}

}  // namespace

CisTrans cis_trans_links(const StreamNetwork& network, const OffsetOf& offset, double reach_m) {
    const auto inflows_of = junction_inflows(network);
    std::vector<double> cis, trans;
    for (Index link = 0; link < network.size(); ++link) {
        const Index below = network.downstream[link];
        if (below == none || inflows_of[link].count != 2 || inflows_of[below].count != 2) continue;
        if (main_and_tributary(network, inflows_of[below])[0] != link) continue;
        const bool left_above = from_the_left(network, offset, reach_m, inflows_of[link], link);
        const bool left_below = from_the_left(network, offset, reach_m, inflows_of[below], below);
        (left_above == left_below ? cis : trans).push_back(network.length_m[link]);
    }
    const auto all = static_cast<double>(cis.size() + trans.size());
    return {.cis = statistics(cis),
            .trans = statistics(trans),
            .cis_share = all > 0 ? static_cast<double>(cis.size()) / all : std::numeric_limits<double>::quiet_NaN()};
}

LinkLengths link_lengths(const StreamNetwork& network) {
    std::vector<double> exterior, interior;
    for (Index link = 0; link < network.size(); ++link) {
        (network.shreve[link] == 1 ? exterior : interior).push_back(network.length_m[link]);
    }
    const LengthStatistics outer = statistics(exterior), inner = statistics(interior);
    return {.exterior = outer, .interior = inner, .exterior_interior_ratio = outer.mean_m / inner.mean_m};
}

OffsetOf offsets(const Grid& grid) {
    std::vector<double> south(grid.rows, 0);  // of row 0, along the meridian
    for (Index row = 1; row < grid.rows; ++row) south[row] = south[row - 1] + grid.north_south[row - 1];
    return [south = std::move(south), width = grid.east_west, cols = grid.cols](Index from, Index to) {
        const Index from_row = from / cols, to_row = to / cols;
        const double columns = static_cast<double>(to % cols) - static_cast<double>(from % cols);
        return Point{columns * (width[from_row] + width[to_row]) / 2, south[from_row] - south[to_row]};
    };
}

OffsetOf offsets(const Mesh& mesh) {
    return [&mesh](Index from, Index to) { return Point{mesh.x[to] - mesh.x[from], mesh.y[to] - mesh.y[from]}; };
}

JunctionAngles junction_angles(const StreamNetwork& network, const OffsetOf& offset, double reach_m,
                               double flint_exponent) {
    std::vector<double> measured, predicted;
    const auto inflows_of = junction_inflows(network);
    for (Index below = 0; below < network.size(); ++below) {
        if (inflows_of[below].count != 2) continue;
        const auto [first, second] = inflows_of[below].link;
        measured.push_back(angle_between(upstream_direction(network.nodes_of(first), offset, reach_m),
                                         upstream_direction(network.nodes_of(second), offset, reach_m)));
        predicted.push_back(howard_angle(slope_ratio(network, below, first, flint_exponent),
                                         slope_ratio(network, below, second, flint_exponent)));
    }
    return {.count = static_cast<Index>(measured.size()),
            .mean_rad = mean(measured),
            .sd_rad = standard_deviation(measured),
            .predicted_rad = mean(predicted)};
}

double junction_reach(const StreamNetwork& network) {
    const double steps = static_cast<double>(network.nodes.size()) - network.size();
    return 10 * std::accumulate(network.length_m.begin(), network.length_m.end(), 0.0) / steps;
}

}  // namespace thalweg::channel
