// SPDX-License-Identifier: GPL-3.0-or-later
#include "thalweg/io/heightmap.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <span>
#include <vector>

#include "io/png.hpp"
#include "io/text_file.hpp"
#include "thalweg/core/error.hpp"

namespace thalweg::io {
namespace {

constexpr double highest_count = 65535;

HeightmapScale scale_of(std::span<const double> values, const std::filesystem::path& path) {
    double lowest = std::numeric_limits<double>::infinity(), highest = -lowest;
    for (const double value : values) {
        if (std::isnan(value)) continue;
        lowest = std::min(lowest, value);
        highest = std::max(highest, value);
    }
    if (!(lowest <= highest)) throw Error(fmt::format("{} would hold no data", path.string()));
    const double step = highest > lowest ? (highest - lowest) / (highest_count - 1) : 1;
    return {.metres_per_count = step, .offset_m = lowest - step};
}

std::vector<std::uint16_t> counts_of(std::span<const double> values, const HeightmapScale& scale) {
    std::vector<std::uint16_t> counts(values.size(), 0);
    for (std::size_t i = 0; i < values.size(); ++i) {
        if (std::isnan(values[i])) continue;
        const double count = std::round((values[i] - scale.offset_m) / scale.metres_per_count);
        counts[i] = static_cast<std::uint16_t>(std::clamp(count, 1.0, highest_count));
    }
    return counts;
}

/// Cell size and centre of the north-western cell, one number a line.
std::string world_file(const Placement& place) {
    const Point first = place.center(0, 0);
    return fmt::format("{}\n0\n0\n{}\n{}\n{}\n", place.cell_width, -place.cell_height, first.x, first.y);
}

}  // namespace

HeightmapScale write_heightmap(const std::filesystem::path& path, const Raster& raster) {
    const HeightmapScale scale = scale_of(raster.values, path);
    const std::vector<std::uint16_t> counts = counts_of(raster.values, scale);
    std::filesystem::path world = path;
    world.replace_extension(".wld");
    try {
        write_text(path, png_of(counts, raster.grid.cols, raster.grid.rows));
        write_text(world, world_file(raster.placement));
    } catch (const Error&) {
        std::error_code ignored;
        std::filesystem::remove(path, ignored);
        std::filesystem::remove(world, ignored);
        throw;
    }
    return scale;
}

}  // namespace thalweg::io
