// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "thalweg/core/raster.hpp"

namespace thalweg::surface {

/// Light that a surface throws back from a sun in the north-west, 45° high: the cosine of the angle between its normal
/// and the sun, 0 … 1 (0 in its own shadow). The gradient is Horn's (1981) mean over the 3 × 3 cells around; a cell
/// without data, or beyond the edge, counts like the cell in the middle. NaN at no data. Linear in the cells.
std::vector<double> hillshade(const Raster& elevation_m);

}  // namespace thalweg::surface
