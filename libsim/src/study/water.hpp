// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <optional>
#include <vector>

#include "thalweg/core/raster.hpp"

namespace thalweg::study {

/// Share of each cell that is painted as water, 0–1: discs along the channels, their radius growing with the logarithm
/// of the drainage area. `threshold_m2` is where channels begin.
std::vector<double> water_of_flow(const Raster&, std::optional<double> threshold_m2);

/// The same along the lines of a vector file in the raster's coordinates. Throws Error if it cannot be read, or if no
/// line crosses the raster.
std::vector<double> water_of_lines(const Raster&, const std::filesystem::path& lines);

}  // namespace thalweg::study
