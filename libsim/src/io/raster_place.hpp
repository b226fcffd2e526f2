// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <vector>

#include "io/gdal_guard.hpp"
#include "thalweg/io/raster_file.hpp"

namespace thalweg::io {

/// How the rows of the file run.
enum class RowOrder { north_to_south, south_to_north };

/// Fills result's placement, grid, CRS name and vertical unit, and says what had to be assumed. `name` begins every
/// Error's sentence.
RowOrder place_raster(GDALDataset&, const std::string& name, const std::string& crs_override, ReadResult&);

}  // namespace thalweg::io
