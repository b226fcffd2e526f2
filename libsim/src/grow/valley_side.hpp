// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <cstddef>

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
