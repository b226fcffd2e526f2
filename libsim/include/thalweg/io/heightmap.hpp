// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>

#include "thalweg/core/raster.hpp"

namespace thalweg::io {

/// How the 16-bit numbers (counts) of a heightmap become metres again: offset_m + count · metres_per_count.
struct HeightmapScale {
    double metres_per_count;
    double offset_m;
};

/// Writes the values (m) as a grey PNG of 16 bits, row 0 in the north, the form that terrain renderers and games
/// import, with a world file (.wld) beside it. The lowest value becomes 1, the highest 65535 (all equal: 1), rounded to
/// the nearest count, so that heights are off by half a count at most; no data is 0. Bytes a function of the values
/// alone. Throws Error if all is no data, or when a file cannot be written whole.
HeightmapScale write_heightmap(const std::filesystem::path&, const Raster&);

}  // namespace thalweg::io
