// SPDX-License-Identifier: GPL-3.0-or-later
#include "thalweg/grow/elevations.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "grow/plane.hpp"

namespace thalweg::grow {
namespace {

constexpr double least_share_of_rise = 0.1;

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

/// What the valley sides around a ridge vertex say of its height.
struct Bounds {
    double allowed = std::numeric_limits<double>::infinity();  ///< the lowest that a sidewall reaches
    double least = -std::numeric_limits<double>::infinity();   ///< above all its channels
};

void bound_by_side(const Network& network, const std::vector<double>& channel, Index link, Side side,
                   std::vector<Bounds>& bounds) {
    const Point& lower = network.vertices[network.lower[link]];
    const Point along = network.vertices[network.upper[link]] - lower;
    const double foot_elevation = channel[network.lower[link]];
    const double rise = channel[network.upper[link]] - foot_elevation;
    for (const Index vertex : network.polygon(link, side)) {
        const Point offset = network.vertices[vertex] - lower;
        const double share = std::clamp(dot(offset, along) / dot(along, along), 0.0, 1.0);
        const double distance = norm(offset - share * along);
        const double side_rise = network.sidewall_slope[link][static_cast<std::size_t>(side)] * distance;
        const double foot = foot_elevation + share * rise;
        Bounds& of_vertex = bounds[vertex];
        of_vertex.allowed = std::min(of_vertex.allowed, foot + side_rise);
        of_vertex.least = std::max(of_vertex.least, foot + least_share_of_rise * side_rise);
    }
}

}  // namespace

std::vector<double> elevations(const Network& network, const Flint& flint, double base_level_m) {
    std::vector<double> elevation = channel_elevations(network, flint, base_level_m);
    std::vector<Bounds> bounds(network.vertices.size());
    for (Index link = 0; link < network.size(); ++link) {
        for (const Side side : {Side::left, Side::right}) bound_by_side(network, elevation, link, side, bounds);
    }
    for (std::size_t vertex = 0; vertex < elevation.size(); ++vertex) {
        if (std::isnan(elevation[vertex])) elevation[vertex] = std::max(bounds[vertex].allowed, bounds[vertex].least);
    }
    return elevation;
}

}  // namespace thalweg::grow
