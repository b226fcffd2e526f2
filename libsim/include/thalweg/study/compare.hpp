// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <string>

#include "thalweg/study/analyze.hpp"

namespace thalweg::study {

/// On which cells two rasters are measured whose cells differ in size.
enum class CompareCells {
    common,  ///< the finer one is brought to the size of the coarser one's
    own      ///< each on those it has
};

struct CompareOptions {
    io::ReadOptions read;
    MeasureOptions measure;
    CompareCells cells = CompareCells::common;
    Index realisations = 0;  ///< of each side that is a model, with other seeds; 0: none, and no difference is judged
    std::optional<std::filesystem::path> model_of_b{};  ///< simulate or grow folder behind b, an analyze folder that
                                                        ///< was measured by `measure`
};

/// Compares two terrains, each a DEM or the folder of an analyze, simulate or grow run (of the last two elevation.tif
/// is measured like any DEM), with the same channel threshold and on cells of one size on both sides, and writes
/// comparison.json, both sides' curves in it, into an existing folder. Cells are of one size where the square roots of
/// their mean areas differ by at most 5 %. What an analyze folder measured cannot be brought to other cells: a warning
/// tells. With realisations each aspect's distance is judged by those between any two of the model's realisations (of
/// two models, the one that scatters more): `scale` is their median. Throws Error where neither side is a model.
/// Returns the text of comparison.json.
std::string compare(const std::filesystem::path& a, const std::filesystem::path& b, const CompareOptions&,
                    const std::filesystem::path& folder, const Messages&);

}  // namespace thalweg::study
