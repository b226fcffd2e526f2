// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>

#include "study/report_json.hpp"

namespace thalweg::study {

/// Writes slope, aspect, curvatures, hillshade, roughness and local relief of the heights as rasters; returns what the
/// summary says of them.
Json write_derivatives(const Raster& elevation_m, const DerivativeOptions&, const std::filesystem::path& folder);

/// Radius of local relief where none is asked for: ten cells, rounded to 1, 2 or 5 times a power of ten.
double default_relief_radius(const Grid&);

}  // namespace thalweg::study
