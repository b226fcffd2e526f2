// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "thalweg/core/raster.hpp"

namespace thalweg::io {

/// Difference of the highest and the lowest of the 3 × 3 cells (Wilson et al. 2007), m, by GDAL's `gdaldem roughness`. It
/// works in single precision; heights are handed to it over their middle, so that it is right to 1e-7 of the relief.
/// NaN on the rim and where one of the nine has no data.
std::vector<double> roughness(const Raster& elevation_m);

}  // namespace thalweg::io
