// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <optional>
#include <span>

#include "thalweg/core/raster.hpp"
#include "thalweg/study/measure.hpp"

namespace thalweg::study {

/// Where somebody wants a catchment to end: a gauge, a bridge, a mouth.
struct OutletRequest {
    Point at;                           ///< in the DEM's coordinates
    std::optional<double> snap_m = {};  ///< how far it may be moved to a river; default: five cells
};

/// What became of it.
struct OutletReport {
    Point given, snapped;  ///< in the DEM's coordinates; the latter is the middle of a cell
    double snap_m;         ///< how far it might have been moved
    double moved_m;        ///< between the two, along the ground
    double area_m2;        ///< that drains to it
    bool complete;         ///< no part of that is cut off by the edge of the data
};

/// The cell to which a point in `cell` is moved: of the cells with data whose middle lies within `radius_m` and to
/// which at least half as much drains as to any of them, the nearest (ties: the larger area, then the lower number). So
/// it finds the river, and does not slide down along it. Distances are the grid's, from the point itself.
Index snapped_outlet(const Raster&, Point, double radius_m, std::span<const double> drainage_area_m2);

/// Channel heads moved to rivers by the same rule, as the conditioning of the options lets water run. Distances are
/// from the middles of their cells. Heads that come to lie in one cell are merged. Throws Error unless the radius is
/// positive.
ChannelHeads snapped_heads(const Raster&, const ChannelHeads&, double radius_m, const MeasureOptions&);

/// A DEM cut down to what drains to an outlet, NaN elsewhere.
struct OutletCatchment {
    Raster raster;
    Index outlet;  ///< cell of `raster`
    OutletReport report;
    Index void_cells;  ///< of the holes in the terrain that the catchment touches
};

/// Snaps the outlet and cuts its catchment out, as the conditioning of the options lets water run. Throws Error for a
/// point beside the raster or on no data, and for an outlet to which no other cell drains.
OutletCatchment catchment_above(const Raster&, const OutletRequest&, const MeasureOptions&);

}  // namespace thalweg::study
