// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <span>
#include <vector>

#include "thalweg/channel/profile.hpp"

namespace thalweg::channel {

/// A convex place of a long profile: gentle above, steep below.
struct Knickpoint {
    Index row;                    ///< of the profile
    double prominence_m;          ///< height above the steepest concave profile that fits below its stream
    double ksn_above, ksn_below;  ///< mean steepness up to the next knickpoint (or end) of the stream and down to it
};

/// Knickpoints of every main stream (by prominence). A stream in equilibrium is straight in χ, one that only
/// steepens upstream is concave; so each stream, from the row it joins to its source, is compared with the lower convex
/// hull of its points in χ–elevation. The point that stands highest above the hull is a knickpoint if it does so by at
/// least `tolerance_m` (> 0); it divides the stream, and both parts are looked at again (the idea of a profile that is
/// relaxed where it must bulge is Schwanghart & Scherler's, 2017, who fit elevations over distance). In the order of
/// the rows. Cost: nodes times the knickpoints of their stream at worst, no recursion.
std::vector<Knickpoint> knickpoints(const Profile&, std::span<const double> chi_m, double theta,
                                    double reference_area_m2, double tolerance_m);

}  // namespace thalweg::channel
