// SPDX-License-Identifier: GPL-3.0-or-later
#include "thalweg/channel/profile.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "thalweg/channel/network.hpp"
#include "thalweg/core/statistics.hpp"

namespace thalweg::channel {

namespace {

constexpr double nan = std::numeric_limits<double>::quiet_NaN();

/// The first place downstream that lies lower; on a level reach not each of its nodes is looked at again and again.
/// (Where water climbs, "lower" is lower than some node of the climb; no place in between can be the sought one.)
std::vector<Index> next_lower(const Profile& profile) {
    std::vector<Index> lower(profile.size(), none);
    for (Index i = 0; i < profile.size(); ++i) {
        const Index below = profile.below[i];
        const bool falls = below != none && profile.elevation_m[below] < profile.elevation_m[i];
        lower[i] = falls || below == none ? below : lower[below];
    }
    return lower;
}

}  // namespace

Profile channel_profile(const terrain::FlowGraph& graph, std::span<const std::uint8_t> channel,
                        std::span<const double> drainage_area_m2, std::span<const double> elevation_m) {
    Profile profile;
    std::vector<Index> place(graph.size(), none);
    Index rivers = 0;
    for (const Index node : channel_order(graph, channel)) {
        const Index receiver = graph.receiver[node];
        const Index below = receiver == none ? none : place[receiver];
        place[node] = profile.size();
        profile.node.push_back(node);
        profile.below.push_back(below);
        profile.river.push_back(below == none ? rivers++ : profile.river[below]);
        profile.length_m.push_back(below == none ? 0 : graph.length[node]);
        profile.area_m2.push_back(drainage_area_m2[node]);
        profile.elevation_m.push_back(elevation_m[node]);
    }
    return profile;
}

std::vector<double> chi(const Profile& profile, double theta, double reference_area_m2) {
    std::vector<double> result(profile.size(), 0);
    for (Index i = 0; i < profile.size(); ++i) {
        if (profile.below[i] == none) continue;
        const double step = profile.length_m[i] * std::pow(reference_area_m2 / profile.area_m2[i], theta);
        result[i] = result[profile.below[i]] + step;
    }
    return result;
}

std::vector<double> steepness(const Profile& profile, std::span<const double> chi_m, double theta,
                              double reference_area_m2, double smallest_drop_m) {
    const double scale = std::pow(reference_area_m2, theta);
    const double enough = smallest_drop_m * (1 - 1e-9);  // a whole drop is not missed by rounding
    const std::vector<Index> lower = next_lower(profile);
    std::vector<double> result(profile.size(), nan);
    for (Index i = 0; i < profile.size(); ++i) {
        Index at = profile.below[i];
        while (at != none && profile.elevation_m[i] - profile.elevation_m[at] < enough) at = lower[at];
        if (at == none) continue;
        result[i] = scale * (profile.elevation_m[i] - profile.elevation_m[at]) / (chi_m[i] - chi_m[at]);
    }
    return result;
}

std::vector<double> link_steepness(const StreamNetwork& network, const Profile& profile, std::span<const double> chi_m,
                                   double theta, double reference_area_m2) {
    const Index highest = network.nodes.empty() ? 0 : *std::ranges::max_element(network.nodes) + 1;
    std::vector<Index> row_of(highest, none);
    for (Index row = 0; row < profile.size(); ++row) {
        if (profile.node[row] < highest) row_of[profile.node[row]] = row;
    }
    std::vector<double> result, x, z;
    for (Index link = 0; link < network.size(); ++link) {
        x.clear();
        z.clear();
        for (const Index node : network.nodes_of(link)) {
            if (row_of[node] == none) continue;
            x.push_back(chi_m[row_of[node]]);
            z.push_back(profile.elevation_m[row_of[node]]);
        }
        result.push_back(fit_line(x, z).slope.value * std::pow(reference_area_m2, theta));
    }
    return result;
}

}  // namespace thalweg::channel
