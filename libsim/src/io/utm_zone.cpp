// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/utm_zone.hpp"

#include <fmt/format.h>
#include <ogr_spatialref.h>

#include <GeographicLib/UTMUPS.hpp>
#include <algorithm>
#include <cctype>
#include <cmath>
#include <memory>

#include "io/gdal_guard.hpp"

namespace thalweg::io {

std::string system_for(const Placement& p, Index rows, Index cols) {
    const GdalGuard gdal;  // what is not known is no damage of the file
    constexpr const char* example = "EPSG:32611";
    OGRSpatialReference own;
    if (p.crs_wkt.empty() || own.SetFromUserInput(p.crs_wkt.c_str()) != OGRERR_NONE) return example;
    own.SetAxisMappingStrategy(OAMS_TRADITIONAL_GIS_ORDER);
    OGRSpatialReference degrees;
    degrees.SetWellKnownGeogCS("WGS84");
    degrees.SetAxisMappingStrategy(OAMS_TRADITIONAL_GIS_ORDER);
    const std::unique_ptr<OGRCoordinateTransformation> change(OGRCreateCoordinateTransformation(&own, &degrees));
    auto [longitude, latitude] = p.center(rows / 2, cols / 2);
    if (!change || !change->Transform(1, &longitude, &latitude) || !(std::abs(latitude) <= 90)) return example;
    const int zone = GeographicLib::UTMUPS::StandardZone(latitude, longitude);
    const int first = latitude < 0 ? 32700 : 32600;
    return fmt::format("EPSG:{}", zone == GeographicLib::UTMUPS::UPS ? first + 61 : first + zone);
}

std::string try_instead(const std::string& text, const std::string& for_the_place) {
    const bool is_number = text.size() >= 4 && text.size() <= 6 &&
                           std::ranges::all_of(text, [](unsigned char c) { return std::isdigit(c) != 0; });
    return fmt::format("try {}", is_number ? "EPSG:" + text : for_the_place);
}

}  // namespace thalweg::io
