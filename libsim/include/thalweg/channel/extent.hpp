// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <span>
#include <vector>

#include "thalweg/channel/network.hpp"
#include "thalweg/core/statistics.hpp"

namespace thalweg::channel {

/// Number of links at each distance along the flow from a river's mouth (Shreve 1969).
struct WidthFunction {
    std::vector<double> distance_m;  ///< middles of 50 equal classes up to the farthest source
    std::vector<double> links;       ///< mean number over the class: length of channel in it over its width
};

/// Of the river whose mouth has the largest area (ties: the first). Empty without links. The classes' widths times the
/// numbers add up to the river's whole length. Linear.
WidthFunction width_function(const StreamNetwork&);

/// Law of the exceedance of drainage areas, P(A ≥ a) ∝ a^(−β), as a power law of exponent −β: the share, counted by
/// nodes, that has at least a drainage area a, at ten values of a per decade from `smallest_m2` to `largest_m2`,
/// by regression of the logarithms. Successive shares hold each other, so the stated errors are too small.
PowerLawFit area_exceedance(std::span<const double> drainage_area_m2, std::span<const std::uint8_t> used,
                            double smallest_m2, double largest_m2);

}  // namespace thalweg::channel
