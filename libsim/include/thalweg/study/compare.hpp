// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <string>

#include "thalweg/study/analyze.hpp"

namespace thalweg::study {

struct CompareOptions {
    io::ReadOptions read;
    MeasureOptions measure;
};

/// Compares two terrains, each a DEM or the folder of an analyze or simulate run (whose elevation.tif is measured like
/// any DEM), with the same channel threshold on both sides, and writes comparison.json, both sides' curves in it, into
/// an existing folder. Returns the text of comparison.json.
std::string compare(const std::filesystem::path& a, const std::filesystem::path& b, const CompareOptions&,
                    const std::filesystem::path& folder, const Messages&);

}  // namespace thalweg::study
