// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "thalweg/study/measure.hpp"

namespace thalweg::study {

/// A DEM made to drain as the user asked.
struct Conditioned {
    std::vector<double> surface_m;  ///< from which the directions were taken; cuts through obstacles are not in it
    FlowDirections directions;
    Index flat_cells = 0;  ///< that needed a direction by the flat rule
};
/// `filled_m`: the raster filled, where that is asked for and known already.
Conditioned conditioned(const Raster&, const std::vector<Boundary>&, const MeasureOptions&,
                        std::vector<double> filled_m = {});

/// Where water may leave: the edge of the data, or the one outlet of a catchment; and the lowest cells of the
/// depressions that keep theirs, which are added to `kept`. Throws Error where a cell of the options lies in no
/// depression.
std::vector<Boundary> boundary_of(const Raster&, const MeasureOptions&, Index& kept);

}  // namespace thalweg::study
