// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>

#include "thalweg/core/raster.hpp"

namespace thalweg::io {

/// The UTM or UPS coordinate system (WGS 84) made for the raster's middle, as "EPSG:32617"; the one of an example where
/// its own system, WKT in the placement, does not tell where that is.
std::string system_for(const Placement&, Index rows, Index cols);

/// What to say after a text that is no coordinate system: "try EPSG:32611" with its own number where it is one.
std::string try_instead(const std::string& text, const std::string& for_the_place);

}  // namespace thalweg::io
