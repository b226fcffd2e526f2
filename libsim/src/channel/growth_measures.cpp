// SPDX-License-Identifier: GPL-3.0-or-later
#include "thalweg/channel/growth_measures.hpp"

#include <limits>

namespace thalweg::channel {

GrowthMeasures growth_measures(const NetworkInValleys& n) {
    const MainStreams streams = straightest_streams(n.network, n.offset_m, n.reach_m);
    const auto joining = tributaries(n.network, streams, n.offset_m, n.reach_m);
    const PowerLawFit flint = flint_law(n.network);
    constexpr double nan = std::numeric_limits<double>::quiet_NaN();
    const Estimate reach =
        n.sidewall_reach_m ? Estimate{*n.sidewall_reach_m, nan, {nan, nan}} : sidewall_reach(n.ridges);
    return {.channel_maintenance_m = channel_maintenance(n.network),
            .junction_places = junction_places(joining),
            .headward_reach = headward_reach(n.network, streams, n.beyond_source_m),
            .sidewall_angle_deg = sidewall_angles(valley_sides(n.ridges, reach.value)),
            .sidewall_reach_m = reach,
            .farthest_ridges_m = ridge_distance(n.ridges, 0.99),
            .side_choices = side_choices(joining),
            .links = link_lengths(n.network),
            .flint = flint,
            .junctions = junction_angles(n.network, n.offset_m, n.reach_m, flint.exponent.value),
            .divides = divide_angles(n.divides, streams)};
}

}  // namespace thalweg::channel
