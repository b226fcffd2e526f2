// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <span>
#include <vector>

#include "thalweg/core/point.hpp"

namespace thalweg::evolve {

/// Shape of the uplift (or rainfall) over the domain, relative to its maximum.
enum class Pattern {
    constant,  ///< 1 everywhere
    radial     ///< 1 in the middle of the domain's bounding box, falling linearly to 0 at half its shorter side
};

/// Pattern times `maximum`, at every position.
std::vector<double> pattern_values(Pattern, std::span<const Point> positions, double maximum);

}  // namespace thalweg::evolve
