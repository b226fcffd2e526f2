// SPDX-License-Identifier: GPL-3.0-or-later
// Private: what the folders of earlier commands hold.
#pragma once

#include <filesystem>
#include <vector>

#include "thalweg/core/table.hpp"
#include "thalweg/io/raster_file.hpp"
#include "thalweg/study/measure.hpp"

namespace thalweg::study {

enum class ResultKind { file, analyzed, simulated, grown };

/// What a path names: a file (a DEM), or the folder of an analyze, simulate or grow run.
/// Throws Error for anything else.
ResultKind kind_of(const std::filesystem::path&);

/// The cell of a grown terrain's elevation.tif, on its own or on larger cells, at which its water leaves, as the folder's
/// summary says: the rim is a divide, not a cut. Throws Error where the folder does not say it.
Index grown_outlet(const std::filesystem::path& folder, const Raster&);

/// Throws Error if anything is asked for that only holds while a DEM is read and measured: the folder was measured
/// before.
void refuse_dem_options(const std::filesystem::path& folder, const io::ReadOptions&, const MeasureOptions&);

/// A column of numbers. Throws Error where the table has none of that name.
const std::vector<double>& numbers_of(const Table&, const std::string& column);

}  // namespace thalweg::study
