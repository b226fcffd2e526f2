// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <functional>
#include <vector>

#include "thalweg/channel/network.hpp"
#include "thalweg/core/grid.hpp"
#include "thalweg/core/mesh.hpp"

namespace thalweg::channel {

struct LengthStatistics {
    Index count;
    double mean_m;  ///< NaN where there is none
    double sd_m;    ///< of the sample (n − 1); NaN for fewer than two
};

/// Links from a source (exterior) and links between junctions or a junction and a mouth (interior; Shreve 1967).
struct LinkLengths {
    LengthStatistics exterior, interior;
    double exterior_interior_ratio;  ///< of the mean lengths
};

LinkLengths link_lengths(const StreamNetwork&);

/// Displacement in metres, x to the east and y to the north, from one node to another not far away.
using OffsetOf = std::function<Point(Index from, Index to)>;

/// On a grid from its own measures: rows apart by the sum of the lengths between, columns apart by the mean width of
/// the two rows. So a geographic grid is measured on the plane that touches it there; the error is that plane's
/// (relative: distance over the earth's radius, times the tangent of the latitude).
OffsetOf offsets(const Grid&);
/// On a mesh; the mesh must outlive the function.
OffsetOf offsets(const Mesh&);

/// Angles at which two rivers meet, over the junctions with exactly two inflows.
struct JunctionAngles {
    Index count;
    double mean_rad, sd_rad;  ///< measured; NaN where there is none (sd: fewer than two)
    double predicted_rad;     ///< mean over the same junctions of Howard's angle; NaN without Flint's exponent
};

/// Each inflow's direction is that from the junction to its first node at least `reach_m` upstream along the link, or
/// to the link's upper end if that comes first: neighbouring cells have but eight directions, and only over some ten
/// cells is the river's direction known to a few degrees. The prediction takes slopes from Flint's law, S ∝ (2u − 1)^q
/// with the links' magnitudes u: of single links' slopes the lower is often the steeper one. Linear.
JunctionAngles junction_angles(const StreamNetwork&, const OffsetOf&, double reach_m, double flint_exponent);

/// Interior links of a stream by the sides from which the tributaries at their two ends come (James & Krumbein 1969):
/// cis from the same side, trans from opposite sides.
struct CisTrans {
    LengthStatistics cis, trans;
    double cis_share;  ///< of both; NaN where there is none
};

/// Of the links that have exactly two inflows at their upper end, flow on as the main inflow (the larger area) of a
/// junction of exactly two at their lower end, and leave it by a link. A tributary is the inflow with the smaller area
/// (ties: the later one); it comes from the left if it lies left of the way from the main inflow to the link below,
/// looking downstream. Directions are taken over `reach_m` as for the angles. Linear.
CisTrans cis_trans_links(const StreamNetwork&, const OffsetOf&, double reach_m);

/// Ten mean distances between neighbouring nodes of the network (m).
double junction_reach(const StreamNetwork&);

}  // namespace thalweg::channel
