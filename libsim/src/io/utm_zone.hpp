// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <ogr_spatialref.h>

#include <optional>
#include <string>

#include "thalweg/core/point.hpp"
#include "thalweg/core/raster.hpp"

namespace thalweg::io {

/// Longitude and latitude (WGS 84, degrees from Greenwich) of the raster's middle; nothing where its own system, WKT in
/// the placement, does not tell.
std::optional<Point> middle_in_degrees(const Placement&, Index rows, Index cols);

/// What the registry of the EPSG has under a number of four to six digits; nothing if there is none. Looks nowhere
/// else: GDAL would take other texts for the names of files and addresses.
std::optional<OGRSpatialReference> system_of_number(const std::string& number);

/// The UTM or UPS coordinate system (WGS 84) made for the raster's middle, as "EPSG:32617"; the one of an example where
/// its own system, WKT in the placement, does not tell where that is.
std::string system_for(const Placement&, Index rows, Index cols);

/// What to say after a text that is no coordinate system: "try EPSG:32611" with its own number where that is a
/// system's.
std::string try_instead(const std::string& text, const std::string& for_the_place);

}  // namespace thalweg::io
