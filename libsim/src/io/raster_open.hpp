// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>

#include "io/gdal_guard.hpp"

namespace thalweg::io {

/// Opens the one raster that a file, folder or zip archive holds. Throws Error.
DatasetPtr open_raster(const std::filesystem::path&, GdalGuard&);

}  // namespace thalweg::io
