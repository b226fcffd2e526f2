// SPDX-License-Identifier: GPL-3.0-or-later
#include "thalweg/grow/elevations.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "grow/valley_side.hpp"

namespace thalweg::grow {
namespace {

/// Elevations of the channels' vertices, NaN elsewhere.
std::vector<double> channel_elevations(const Network& network, const Flint& flint, double base_level_m) {
    std::vector<double> elevation(network.vertices.size(), std::numeric_limits<double>::quiet_NaN());
    elevation[network.lower[0]] = base_level_m;
    for (Index link = 0; link < network.size(); ++link) {
        const double rise = gradient(flint, network.magnitude[link]) * network.length_m[link];
        elevation[network.upper[link]] = elevation[network.lower[link]] + rise;
    }
    return elevation;
}

void bound_by_side(const Network& network, const std::vector<double>& channel, Index link, Side side,
                   std::vector<HeightRange>& ranges) {
    for (const Index vertex : network.polygon(link, side)) {
        const HeightRange range = range_on_side(network, link, side, channel[network.lower[link]],
                                                channel[network.upper[link]], network.vertices[vertex]);
        HeightRange& of_vertex = ranges[vertex];
        of_vertex.allowed = std::min(of_vertex.allowed, range.allowed);
        of_vertex.least = std::max(of_vertex.least, range.least);
    }
}

}  // namespace

std::vector<HeightRange> height_ranges(const Network& network, const Flint& flint, double base_level_m) {
    constexpr double infinity = std::numeric_limits<double>::infinity();
    const std::vector<double> channel = channel_elevations(network, flint, base_level_m);
    std::vector<HeightRange> ranges(network.vertices.size(), {.least = -infinity, .allowed = infinity});
    for (Index link = 0; link < network.size(); ++link) {
        for (const Side side : {Side::left, Side::right}) bound_by_side(network, channel, link, side, ranges);
    }
    for (std::size_t vertex = 0; vertex < channel.size(); ++vertex) {
        if (!std::isnan(channel[vertex])) ranges[vertex] = {channel[vertex], channel[vertex]};
    }
    return ranges;
}

std::vector<double> elevations(const Network& network, const Flint& flint, double base_level_m) {
    std::vector<double> elevation;
    for (const HeightRange& range : height_ranges(network, flint, base_level_m)) {
        elevation.push_back(std::max(range.allowed, range.least));
    }
    return elevation;
}

}  // namespace thalweg::grow
