// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <span>

#include "thalweg/study/analyze.hpp"

namespace thalweg::study {

/// Channel heads on a raster: each point, in the raster's coordinates, is moved to the centre of the cell that holds it
/// (`cell_at`). Points beside the raster or on no data are counted and left out.
ChannelHeads channel_heads_on(const Raster&, std::span<const Point>);

/// The points of a vector file as channel heads, transformed to the raster's coordinate system; a warning tells how
/// many lie off the data, and where the first of them do. Throws Error where the file holds no points, or none on the
/// data.
ChannelHeads read_channel_heads(const std::filesystem::path&, const Raster&, const Messages&);

}  // namespace thalweg::study
