// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <limits>
#include <span>
#include <vector>

#include "thalweg/core/grid.hpp"

namespace thalweg::terrain {

/// How much a breach may cut. What would need more is left as it is.
struct BreachLimits {
    double depth_m = std::numeric_limits<double>::infinity();   ///< below the ground, anywhere along the way
    double length_m = std::numeric_limits<double>::infinity();  ///< of the cheapest way
};

/// The surface with every pit led out by a cut, where the limits allow it (after Lindsay & Dhun 2015, Lindsay 2016).
/// From the pit, at height z, the way is sought to the next node below z, or to one where water leaves the domain, that
/// costs least: Σ length · (height − z) over its nodes (m², the cut's section along the way), and of equal costs the
/// shorter; its nodes are lowered to z. Pits are taken from the lowest up, so that the cut of one serves others. Ties:
/// lower index.
///
/// Without limits nothing is left to be filled, but for pieces of the domain without any outlet. NaN stays NaN. Cost:
/// one search per pit, over the nodes that can be reached for no more than its way out costs; depressions within
/// depressions are searched once for each level. One thread.
std::vector<double> breach(const Grid&, std::span<const double> elevation_m, std::span<const Boundary>,
                           const BreachLimits& = {});

}  // namespace thalweg::terrain
