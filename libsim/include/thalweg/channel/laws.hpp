// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <span>
#include <vector>

#include "thalweg/channel/network.hpp"
#include "thalweg/core/statistics.hpp"

namespace thalweg::channel {

/// Length along the flow from each node up to the farthest divide (m); 0 where nothing flows in. Linear.
std::vector<double> longest_upstream_lengths(const terrain::FlowGraph&);

/// The same on links alone: from each link's lower end up to the farthest source (m), as a tree without a terrain has
/// it.
std::vector<double> longest_upstream_lengths(const StreamNetwork&);

/// Hack's law L = c·A^h (Hack 1957): coefficient c in m^(1−2h), exponent h. One point per link: the last node above its
/// end, where it has met no other river yet, with its drainage area and its longest upstream length; all links count
/// alike. Basins nested in each other share their rivers, so the stated errors are too small.
PowerLawFit hack_law(const StreamNetwork&, std::span<const double> drainage_area_m2,
                     std::span<const double> longest_upstream_m);

/// Flint's law S = p·(2u − 1)^q (Flint 1974): coefficient p, the gradient of exterior links, and exponent q, negative
/// where slopes fall downstream; u is the link's magnitude. Links are put into classes of magnitude, 2u − 1 doubling
/// from one to the next (u = 1, 2, 3–4, 5–8, …); a class has the slope Σ drop/Σ length, so that links without any fall
/// (filled lakes, whole metres) count, and weighs by its number of links. Classes without fall are left out. The law
/// is thus one of mean slopes: log-normal scatter of standard deviation s raises p by s²/2 in ln p over the median's.
PowerLawFit flint_law(const StreamNetwork&);

/// Angle between two rivers at their junction (rad) when each keeps to its own steepest way down into the slope below
/// (Howard 1971): E1 + E2 with cos E = slope below over slope above, 0 where the slope below is the steeper. The two
/// arguments are these ratios.
double howard_angle(double below_over_first, double below_over_second);

}  // namespace thalweg::channel
