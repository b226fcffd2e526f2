// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "thalweg/study/analyze.hpp"

namespace thalweg::study {

/// Channel heads on a raster: each point, in the raster's coordinates, is moved to the centre of the cell that holds it
/// (`cell_at`). Points beside the raster or on no data are counted and left out.
ChannelHeads channel_heads_on(const Raster&, std::span<const Point>);

/// The points of a vector file as cells, transformed to the raster's coordinate system: of the first of the layers that
/// it has, or else of all. A warning tells how many lie off the data, and where the first of them do. Throws Error where
/// the file holds no points, or none on the data.
ChannelHeads read_cells(const std::filesystem::path&, const std::vector<std::string>& layers, const Raster&,
                        const Messages&);

/// The same of channel heads: layer `sources`, as `grow` writes it, before others.
ChannelHeads read_channel_heads(const std::filesystem::path&, const Raster&, const Messages&);

}  // namespace thalweg::study
