// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "thalweg/core/point.hpp"

namespace thalweg::io {

/// A line of a vector file in the file's own coordinates, with its drainage area where it has one.
struct DrainageLine {
    std::vector<Point> points;
    double area_m2;  ///< of the field of that name; NaN where there is none
};

/// The lines of a vector file that GDAL reads: of the layer `links` where it has one (as network.gpkg does), else of
/// its first layer. Lines of several parts become several. Throws Error if it cannot be read or holds no line.
std::vector<DrainageLine> read_drainage_lines(const std::filesystem::path&);

}  // namespace thalweg::io
