// SPDX-License-Identifier: GPL-3.0-or-later
#include "thalweg/study/channel_heads.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>

#include "thalweg/core/error.hpp"
#include "thalweg/io/vector_file.hpp"

namespace thalweg::study {
namespace {

bool has_data(const Raster& raster, Index cell) { return cell != none && !std::isnan(raster.values[cell]); }

/// The first few points off the data, for the user to find them.
std::string places_outside(const Raster& raster, std::span<const Point> points) {
    constexpr std::size_t most = 3;
    std::vector<std::string> places;
    for (const Point& p : points) {
        if (!has_data(raster, cell_at(raster, p))) places.push_back(fmt::format("({:.10g}, {:.10g})", p.x, p.y));
    }
    const bool more = places.size() > most;
    places.resize(std::min(places.size(), most));
    return fmt::format("{}{}", fmt::join(places, ", "), more ? ", …" : "");
}

}  // namespace

ChannelHeads channel_heads_on(const Raster& raster, std::span<const Point> points) {
    ChannelHeads heads;
    heads.given = static_cast<Index>(points.size());
    for (const Point& p : points) {
        const Index cell = cell_at(raster, p);
        if (has_data(raster, cell)) heads.cells.push_back(cell);
    }
    heads.outside = heads.given - static_cast<Index>(heads.cells.size());
    std::ranges::sort(heads.cells);
    const auto repeated = std::ranges::unique(heads.cells);
    heads.merged = static_cast<Index>(repeated.size());
    heads.cells.erase(repeated.begin(), repeated.end());
    return heads;
}

ChannelHeads read_cells(const std::filesystem::path& path, const std::vector<std::string>& layers, const Raster& raster,
                        const Messages& messages) {
    const std::vector<Point> points =
        io::read_vectors(path, {.layers = layers, .crs_wkt = raster.placement.crs_wkt}).points;
    if (points.empty()) throw Error(fmt::format("{} holds no points", path.string()));
    const ChannelHeads heads = channel_heads_on(raster, points);
    if (heads.cells.empty()) {
        throw Error(
            fmt::format("none of the {} points of {} lies on the data of the DEM; in its coordinates they are at "
                        "{}",
                        heads.given, path.string(), places_outside(raster, points)));
    }
    if (heads.outside > 0) {
        messages.warning(fmt::format("{} of the {} points of {} lie off the data of the DEM and are left out: {}",
                                     heads.outside, heads.given, path.string(), places_outside(raster, points)));
    }
    return heads;
}

ChannelHeads read_channel_heads(const std::filesystem::path& path, const Raster& raster, const Messages& messages) {
    return read_cells(path, {"sources"}, raster, messages);
}

}  // namespace thalweg::study
