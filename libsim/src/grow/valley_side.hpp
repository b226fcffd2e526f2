// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <cstddef>
#include <span>

#include "grow/plane.hpp"
#include "thalweg/grow/elevations.hpp"

namespace thalweg::grow {

/// A place seen from the nearest point of a link.
struct FromLink {
    double share;  ///< of that point along the link, from its lower end
    double distance_m;
};

inline FromLink from_link(const Network& network, Index link, const Point& place) {
    const Point& lower = network.vertices[network.lower[link]];
    const Point along = network.vertices[network.upper[link]] - lower;
    const Point offset = place - lower;
    const double share = std::clamp(dot(offset, along) / dot(along, along), 0.0, 1.0);
    return {share, norm(offset - share * along)};
}

/// Whether a place lies in a polygon of the network, by the even–odd rule.
inline bool is_inside(const Network& network, std::span<const Index> polygon, const Point& p) {
    bool inside = false;
    for (std::size_t i = 0; i < polygon.size(); ++i) {
        const Point& a = network.vertices[polygon[i]];
        const Point& b = network.vertices[polygon[(i + 1) % polygon.size()]];
        if ((a.y > p.y) == (b.y > p.y)) continue;
        if (p.x < a.x + (p.y - a.y) / (b.y - a.y) * (b.x - a.x)) inside = !inside;
    }
    return inside;
}

/// What one valley side says of the height of a place on it; `lower_m` and `upper_m` are the heights of its link's
/// ends.
inline HeightRange range_on_side(const Network& network, Index link, Side side, double lower_m, double upper_m,
                                 const Point& place) {
    constexpr double least_share_of_rise = 0.1;
    const FromLink at = from_link(network, link, place);
    const double slope = network.sidewall_slope[link][static_cast<std::size_t>(side)];
    const double rise = slope * std::min(at.distance_m, network.sidewall_reach_m);
    const double foot = lower_m + at.share * (upper_m - lower_m);
    return {.least = foot + least_share_of_rise * rise, .allowed = foot + rise};
}

}  // namespace thalweg::grow
