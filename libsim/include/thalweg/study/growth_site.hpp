// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <vector>

#include "thalweg/grow/grow.hpp"
#include "thalweg/study/domain.hpp"

namespace thalweg::study {

/// Where a network grows, on a plane in metres, and where that plane lies on the map.
struct GrowthSite {
    grow::Basin basin;
    double unit_m = 1;         ///< metres of the plane divided by this are map coordinates
    std::string crs_wkt = {};  ///< of the map; empty: nowhere in particular
    std::vector<std::string> warnings = {};
};

/// The basin that an experiment describes: its outline and trunk, or those of a DEM's largest complete catchment.
/// Throws Error where its parameters contradict each other, files do not hold what is meant, or no network can grow in
/// the basin (`grow::checked_basin`).
GrowthSite growth_site(const Experiment&, const Messages&);

/// A catchment's outline without the staircase of its cells, and its main stream as a trunk: the largest drainage area
/// at every junction is followed upstream from the outlet to where channels begin. The trunk keeps the bends that lie
/// more than C/2 off the line without them, or more if no network with these dials could grow from that. Where none
/// with bends is possible, it is straight and ends at the uppermost place of that stream that is seen from the outlet
/// with a clear distance of 1 % of the trunk's length to either side.
GrowthSite growth_site(const Catchment&, const grow::Dials&);

/// The cell with data of a terrain on this site whose centre is nearest to the outlet. Throws Error if none has data.
Index outlet_cell(const Raster&, const GrowthSite&);

/// The dials of an experiment. Throws Error where the constant of channel maintenance is missing.
grow::Dials dials_of(const Experiment&);

}  // namespace thalweg::study
