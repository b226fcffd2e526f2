// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/utm_zone.hpp"

#include <fmt/format.h>

#include <GeographicLib/UTMUPS.hpp>
#include <algorithm>
#include <cctype>
#include <cmath>
#include <memory>

#include "io/gdal_guard.hpp"

namespace thalweg::io {

std::optional<Point> middle_in_degrees(const Placement& p, Index rows, Index cols) {
    const GdalGuard gdal;  // what is not known is no damage of the file
    OGRSpatialReference own, degrees;
    if (p.crs_wkt.empty() || own.importFromWkt(p.crs_wkt.c_str()) != OGRERR_NONE) return std::nullopt;
    own.SetAxisMappingStrategy(OAMS_TRADITIONAL_GIS_ORDER);
    degrees.SetWellKnownGeogCS("WGS84");
    degrees.SetAxisMappingStrategy(OAMS_TRADITIONAL_GIS_ORDER);
    const std::unique_ptr<OGRCoordinateTransformation> change(OGRCreateCoordinateTransformation(&own, &degrees));
    Point middle = p.center(rows / 2, cols / 2);
    if (!change || !change->Transform(1, &middle.x, &middle.y)) return std::nullopt;
    if (!std::isfinite(middle.x) || !(std::abs(middle.y) <= 90)) return std::nullopt;
    return middle;
}

std::optional<OGRSpatialReference> system_of_number(const std::string& number) {
    const GdalGuard gdal;
    const bool is_number = number.size() >= 4 && number.size() <= 6 &&
                           std::ranges::all_of(number, [](unsigned char c) { return std::isdigit(c) != 0; });
    OGRSpatialReference system;
    if (!is_number || system.importFromEPSG(std::stoi(number)) != OGRERR_NONE) return std::nullopt;
    return system;
}

std::string system_for(const Placement& p, Index rows, Index cols) {
    const std::optional<Point> middle = middle_in_degrees(p, rows, cols);
    if (!middle) return "EPSG:32611";
    const int zone = GeographicLib::UTMUPS::StandardZone(middle->y, middle->x);
    const int first = middle->y < 0 ? 32700 : 32600;
    return fmt::format("EPSG:{}", zone == GeographicLib::UTMUPS::UPS ? first + 61 : first + zone);
}

std::string try_instead(const std::string& text, const std::string& for_the_place) {
    return fmt::format("try {}", system_of_number(text) ? "EPSG:" + text : for_the_place);
}

}  // namespace thalweg::io
