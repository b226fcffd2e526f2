// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "thalweg/core/index.hpp"

namespace thalweg::grow {

/// Flint's (1974) law: the gradient of a link of Shreve magnitude u is p·(2u − 1)^q. p is the mean gradient of exterior
/// links (Kelley et al. 1988 call it their length, which has the wrong dimension), q is negative.
struct Flint {
    double p = 0.1;   ///< m/m
    double q = -0.6;  ///< −0.37 … −0.84 in nature
};

/// Gradient (m/m) of a link of this magnitude, at least 1.
double gradient(const Flint&, Index magnitude);

/// Howard's (1971) angle between an inflow and the prolongation of the downstream link: the angle whose cosine is
/// downstream gradient over inflow gradient, 0 where that ratio exceeds 1. Radians.
double junction_angle(double downstream_gradient, double inflow_gradient);

/// Which end of a link a junction is.
enum class JunctionAt {
    upper_end,  ///< the link leads water away
    lower_end   ///< the link brings water
};

/// One side of a valley, as seen from the junction it ends at.
struct ValleySide {
    double direction_rad;   ///< in which its link leaves the junction, counter-clockwise from the x-axis
    JunctionAt junction;    ///< of the link
    double gradient;        ///< of the link, m/m
    double sidewall_slope;  ///< steepest slope of the valley side, m/m
};

/// Direction (radians) of the divide between two valley sides that meet at a junction; `second` lies counter-clockwise
/// of `first`, by up to half a turn.
///
/// Abrahams (1980) relates it to link and sidewall slopes; this construction is our own. Each side is the plane through
/// its link that is `sidewall_slope` steep: its gradient is S·d + √(tan²β − S²)·n, with d the link's upstream direction
/// and n the horizontal normal into the interfluve. Both planes hold the junction, so they meet in a straight line; the
/// divide is its half that lies between the links, kept a tenth of their angle away from both, for a divide along a
/// link would leave that side nothing. Where no half lies between them, it bisects their angle.
///
/// A link steeper than its valley side (S > tan β) lies in no plane that is as flat: the root is taken as 0, the side
/// then falls along its link alone, with the link's gradient, and water on it runs beside the link and not to it.
double divide_direction(const ValleySide& first, const ValleySide& second);

}  // namespace thalweg::grow
