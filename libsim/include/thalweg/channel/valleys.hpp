// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <limits>
#include <span>
#include <vector>

#include "thalweg/channel/links.hpp"
#include "thalweg/channel/network.hpp"
#include "thalweg/channel/tributaries.hpp"
#include "thalweg/core/grid.hpp"
#include "thalweg/core/statistics.hpp"
#include "thalweg/terrain/graph.hpp"

namespace thalweg::channel {

/// Constant of channel maintenance (Schumm 1956): drainage area over length of channel (m), of all rivers together. Its
/// error is that of a ratio whose links, with the area that each drains by itself, are the sample. NaN without links.
Estimate channel_maintenance(const StreamNetwork&);

/// How far rivers reach towards the divide: for each stream that joins another one and has no tributary itself, its
/// length over the way on to the divide, `beyond_source_m` (per link) more. 1 would be to the divide.
UniformDraw headward_reach(const StreamNetwork&, const MainStreams&, std::span<const double> beyond_source_m);

/// From the source of each exterior link straight on, in the direction that the link has over `reach_m` below it, to
/// the divide of its valley (m): the cells that drain to the link. 0 for the other links. Linear.
std::vector<double> beyond_sources(const Grid&, const terrain::FlowGraph&, const StreamNetwork&, double reach_m);

/// A piece of the ridge of a valley side, which is the divide towards the valleys of other links.
struct RidgePiece {
    Index link;
    Bank bank;
    double length_m;  ///< its weight
    double rise_m;    ///< height above the channel
    double run_m;     ///< distance from the channel
};

/// One side of the valley of a link, by its ridge.
struct ValleySide {
    Index link;
    Bank bank;
    double ridge_m = 0;  ///< length of the ridge: its weight
    double rise_m = 0;   ///< mean height of the ridge above the channel
    double run_m = 0;    ///< mean distance of the ridge from the channel
};

/// On a raster. A valley is the cells that drain to one link's channel; its ridge those of them that lie beside other
/// valleys, or beside what does not drain to the network. A ridge cell is compared with the channel cell where its
/// water arrives, as the crow flies. The bank is that from which the water comes; cells straight behind a source count
/// to the left. `elevation_m` falls along the flow. Linear.
std::vector<RidgePiece> ridge_pieces(const Grid&, const terrain::FlowGraph&, std::span<const double> elevation_m,
                                     const StreamNetwork&);

/// Distance from the channel (m) below which the given share of all ridges lies, by length; NaN for no ridges.
double ridge_distance(std::span<const RidgePiece>, double share);

/// How far from their channel valley sides rise (m): R of the law rise = s·min(run, R) that leaves the least squares
/// over all ridges, weighted by length; exact, by one pass over the ridges in the order of their distance. Beyond the
/// distance of 99 % of the ridges nothing is known: where they rise all the way, R is that. The error is a jackknife's
/// over twenty groups of valley sides. NaN where no ridge lies above its channel. Cost: a sort.
Estimate sidewall_reach(std::span<const RidgePiece>);

/// The sides that these pieces make up; distances beyond `reach_m`, where nothing rises any more, count as that. Links
/// in order, left before right; those without ridge are left out.
std::vector<ValleySide> valley_sides(std::span<const RidgePiece>,
                                     double reach_m = std::numeric_limits<double>::infinity());

/// Angles (degrees) of the valley sides' mean slopes, rise over run, weighted by the length of ridge.
UniformDraw sidewall_angles(std::span<const ValleySide>);

}  // namespace thalweg::channel
