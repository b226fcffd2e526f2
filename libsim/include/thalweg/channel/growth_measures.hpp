// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "thalweg/channel/divides.hpp"
#include "thalweg/channel/laws.hpp"
#include "thalweg/channel/links.hpp"
#include "thalweg/channel/tributaries.hpp"
#include "thalweg/channel/valleys.hpp"

namespace thalweg::channel {

/// A network and the ground around it, of a raster or of a grown tree.
struct NetworkInValleys {
    const StreamNetwork& network;
    OffsetOf offset_m;
    double reach_m;  ///< over which directions are taken
    std::vector<double> beyond_source_m;
    std::vector<RidgePiece> ridges;
    std::vector<JunctionDivide> divides;
    std::optional<double> sidewall_reach_m = {};  ///< of a grown network, where it is known; none: it is found
};

/// What tells of the dials with which a network could have grown (Kelley, Malin & Nielson 1988). Measured by the same
/// functions on a DEM and on a grown tree; not the dials themselves, for what grew later hides how it grew.
struct GrowthMeasures {
    Estimate channel_maintenance_m;
    UniformDraw junction_places;  ///< 0 at the lower end
    UniformDraw headward_reach;   ///< 1 to the divide
    UniformDraw sidewall_angle_deg;
    Estimate sidewall_reach_m;
    double farthest_ridges_m;  ///< distance from their channel below which 99 % of the ridges lie
    SideChoices side_choices;
    LinkLengths links;
    PowerLawFit flint;
    JunctionAngles junctions;
    DividesByPlace divides;
};

/// Streams are told by direction (`straightest_streams`), for a growing network's streams are straight.
GrowthMeasures growth_measures(const NetworkInValleys&);

}  // namespace thalweg::channel
