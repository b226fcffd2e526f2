// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "thalweg/core/raster.hpp"

namespace thalweg::io {

/// Elevations on one raster at several times.
struct RasterSeries {
    std::vector<double> time_yr;
    std::function<Raster(std::size_t)> elevation_m;  ///< at the time of that number; all on the same raster
    std::string title;
    std::string source;  ///< the program that made it
};

/// Writes them as a netCDF-3 file (64-bit offsets) after the CF conventions 1.8: the variable `elevation`(time, y, x) in metres with its
/// grid mapping, and the coordinates `time` (years since the start of the simulation), `y` and `x` of the
/// cells' centres (latitude and longitude in degrees). One raster at a time is in memory. The bytes are a function of
/// the values alone. Throws Error when it cannot be written whole: what was written is read back and compared.
void write_netcdf(const std::filesystem::path&, const RasterSeries&);

/// Writes a picture of red, green, blue and opacity per pixel, row by row from the north, as PNG. Throws Error when it
/// cannot be written whole.
void write_png(const std::filesystem::path&, Index rows, Index cols, std::span<const std::uint8_t> rgba);

}  // namespace thalweg::io
