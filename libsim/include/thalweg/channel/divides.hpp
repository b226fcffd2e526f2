// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <span>
#include <vector>

#include "thalweg/channel/links.hpp"
#include "thalweg/channel/main_streams.hpp"
#include "thalweg/channel/network.hpp"
#include "thalweg/channel/tributaries.hpp"
#include "thalweg/core/grid.hpp"
#include "thalweg/terrain/graph.hpp"

namespace thalweg::channel {

/// One of the three divides that leave a junction, each between the valleys of two of the links that meet there.
struct JunctionDivide {
    Index below;                 ///< the link below the junction
    std::array<Index, 2> links;  ///< the two; from the first one counter-clockwise to the second one lies the divide
    double sector_rad;           ///< angle between the two
    double angle_rad;            ///< of the divide from the first one
};

/// On a raster. The valleys are the cells that drain to each link's own channel; the links' directions are taken over
/// `reach_m`, or the length of the shortest of the three if that is less, and so far around the junction cells count.
/// The divide of two links is the straight line from the junction by which the fewest cells of their valleys, within
/// the sector between the two, come to lie on the wrong side; where a range of directions does so, its middle. Of
/// junctions of exactly two inflows, in the links' order, up to three each; sectors with fewer than six such cells are
/// left out. O(cells + junctions × cells within the reach).
std::vector<JunctionDivide> junction_divides(const Grid&, const terrain::FlowGraph&, const StreamNetwork&,
                                             double reach_m);

/// Divides of one kind over all junctions.
struct DivideAngles {
    UniformDraw share;        ///< of the way from the one link to the other
    double mean_rad, sd_rad;  ///< from the one link; NaN where there is none (sd: fewer than two)
    double sector_mean_rad;   ///< between the two
};

/// The kinds by the links that they part. Abrahams (1980) finds that they follow from the slopes of links and valley
/// sides.
struct DividesByPlace {
    DivideAngles across;  ///< from the link below to the upstream link of the stream, on the side without tributary
    DivideAngles below;   ///< from the link below to the tributary
    DivideAngles above;   ///< from the tributary to the upstream link of the stream
};

/// Which inflow is the tributary is for `streams` to say. Linear.
DividesByPlace divide_angles(std::span<const JunctionDivide>, const MainStreams& streams);

}  // namespace thalweg::channel
