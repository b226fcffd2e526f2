// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "thalweg/infer/slope_area_fit.hpp"
#include "thalweg/study/analyze.hpp"

namespace thalweg::study {

/// Which slopes of a simulation are fitted.
enum class FitFrom {
    nodes,  ///< of the mesh, exact
    raster  ///< of its elevation.tif, measured like any DEM
};

struct FitOptions {
    infer::SlopeAreaFitOptions fit;
    FitFrom from = FitFrom::nodes;
    io::ReadOptions read;
    MeasureOptions measure;
    std::optional<OutletRequest> outlet = {};  ///< of a DEM only what drains to it is fitted
};

/// Fits k and m to the slope–area curve of a DEM, an analyze folder or a simulate folder, and writes fit.json and
/// fit.csv into an existing folder. Returns the text of fit.json. What a simulation was made with is never looked at.
struct FitOutcome {
    infer::SlopeAreaFit fit;
    std::string json;
};
FitOutcome fit(const std::filesystem::path& target, const FitOptions&, const std::filesystem::path& folder,
               const Messages&);

}  // namespace thalweg::study
