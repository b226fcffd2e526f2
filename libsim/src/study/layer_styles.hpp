// SPDX-License-Identifier: GPL-3.0-or-later
// Private: how QGIS draws what is written: styles of layers (QML) and colours of rasters.
#pragma once

#include <string>
#include <vector>

#include "thalweg/core/index.hpp"
#include "thalweg/io/raster_file.hpp"

namespace thalweg::study {

/// Links as lines that widen and darken with their Strahler order, one class per order.
std::string links_style(Index highest_order);

/// Sources hollow, junctions full, outlets as squares.
std::string junctions_style();

/// Outlines without a filling.
std::string basins_style();

/// Triangles on their tips.
std::string knickpoints_style();

/// Colours of Strahler orders, the links' own; 0 (no channel) is white.
std::vector<io::CellColor> order_colors();

/// Directions go round the circle of hues from the east clockwise; 0 (water leaves) is black.
std::vector<io::CellColor> direction_colors();

}  // namespace thalweg::study
