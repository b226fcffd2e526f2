// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <span>
#include <vector>

#include "thalweg/study/measure.hpp"

namespace thalweg::study {

/// The terrain along which slopes are measured: never filled, cut through where pits were. Of its nodes only those are
/// kept on which channels may run, and the ones that these flow to: about a hundredth of a DEM, which is what lets the
/// rest of the measuring do without a second whole terrain in memory.
struct CarvedRivers {
    RoutedTerrain terrain;         ///< its nodes are places in `node`
    std::vector<Index> node;       ///< of the raster, ascending
    std::vector<double> filled_m;  ///< where the raster is to be filled: its surface then, found with the same lakes
};

/// Adds pits and flats to the report.
CarvedRivers carved_rivers(const Raster&, std::span<const Boundary>, const MeasureOptions&, ConditioningReport&);

/// The options with their channel heads, if there are any, as places in `rivers.node`.
MeasureOptions on_rivers(const CarvedRivers& rivers, const MeasureOptions&);

/// Slope–area points and long profiles name nodes of the raster again.
void name_raster_nodes(const CarvedRivers& rivers, std::vector<channel::SlopeAreaPoint>&, ChiStatistics&);

}  // namespace thalweg::study
