// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cmath>

#include "thalweg/channel/slope_area.hpp"

namespace thalweg::channel {

namespace {

using terrain::FlowGraph;

/// What the segments are cut from: every node that enters stands for the step to its receiver, with its own area.
struct Profile {
    const FlowGraph& graph;
    std::span<const double> area;
    std::span<const double> elevation;
    std::vector<std::uint8_t> enters;

    double drop(Index node) const { return elevation[node] - elevation[graph.receiver[node]]; }
};

std::vector<std::uint8_t> entering(const FlowGraph& graph, std::span<const double> area,
                                   std::span<const std::uint8_t> used, double smallest_area) {
    std::vector<std::uint8_t> enters(graph.size());
    for (Index node = 0; node < graph.size(); ++node) {
        enters[node] = graph.receiver[node] != none && (used.empty() || used[node]) && area[node] > 0 &&
                       area[node] >= smallest_area;
    }
    return enters;
}

/// The donor of largest area (ties: lower index) by which a river goes on upstream, `none` at its head.
std::vector<Index> main_donors(const Profile& profile) {
    std::vector<Index> donor(profile.graph.size(), none);
    for (Index node = 0; node < profile.graph.size(); ++node) {
        if (!profile.enters[node]) continue;
        Index& best = donor[profile.graph.receiver[node]];
        if (best == none || profile.area[node] > profile.area[best]) best = node;
    }
    return donor;
}

/// Cuts one reach (steps between two jumps of the area) into pieces that fall `drop_m` or more, or keeps it whole if it
/// falls less; what is left over at the end goes to the last piece. So every step of a reach is in a piece, steep
/// or not, and as pieces count by their length, no kind of stretch is preferred. (Cutting at the node nearest to whole
/// multiples of the drop was tried: with vertical noise its shorter pieces made k·A0^m about four times worse.)
void cut_reach(const Profile& profile, std::span<const Index> reach, const SegmentOptions& options,
               std::vector<SlopeAreaPoint>& points) {
    double total = 0;
    for (const Index node : reach) total += profile.drop(node);
    if (!(total > 0) || total < options.smallest_drop_m) return;
    const double enough = options.drop_m * (1 - 1e-9);  // a piece is not missed by rounding
    double fallen = 0, start = 0, length = 0, log_area = 0;
    Index lowest = reach.front();
    for (std::size_t i = 0; i < reach.size(); ++i) {
        const double step = profile.graph.length[reach[i]];
        fallen += profile.drop(reach[i]);
        length += step;
        log_area += step * std::log(profile.area[reach[i]]);
        const bool last = i + 1 == reach.size();
        if (!last && (fallen - start < enough || total - fallen < enough)) continue;
        points.push_back({std::exp(log_area / length), (fallen - start) / length, length, lowest});
        if (!last) lowest = reach[i + 1];
        start = fallen;
        length = log_area = 0;
    }
}

/// Walks one river upstream and hands over its reaches.
void cut_river(const Profile& profile, const std::vector<Index>& main_donor, Index mouth, const SegmentOptions& options,
               std::vector<SlopeAreaPoint>& points) {
    std::vector<Index> reach;
    for (Index node = mouth; node != none; node = main_donor[node]) {
        if (!reach.empty() && profile.area[reach.back()] > options.largest_area_ratio * profile.area[node]) {
            cut_reach(profile, reach, options, points);
            reach.clear();
        }
        reach.push_back(node);
    }
    cut_reach(profile, reach, options, points);
}

}  // namespace

std::vector<SlopeAreaPoint> fixed_drop_segments(const FlowGraph& graph, std::span<const double> drainage_area_m2,
                                                std::span<const double> carved_elevation_m,
                                                std::span<const std::uint8_t> used, const SegmentOptions& options) {
    const Profile profile{graph, drainage_area_m2, carved_elevation_m,
                          entering(graph, drainage_area_m2, used, options.smallest_area_m2)};
    const auto main_donor = main_donors(profile);
    std::vector<SlopeAreaPoint> points;
    for (const Index node : graph.order) {
        if (!profile.enters[node]) continue;
        const Index receiver = graph.receiver[node];
        const bool river_begins = !profile.enters[receiver] || main_donor[receiver] != node;
        if (river_begins) cut_river(profile, main_donor, node, options, points);
    }
    return points;
}

}  // namespace thalweg::channel
