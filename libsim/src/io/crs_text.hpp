// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <ogr_spatialref.h>

#include <string>

namespace thalweg::io {

/// As WKT; "" where GDAL cannot write it.
inline std::string wkt_of(const OGRSpatialReference& crs) {
    char* text = nullptr;
    crs.exportToWkt(&text);
    const std::string wkt = text == nullptr ? "" : text;
    CPLFree(text);
    return wkt;
}

}  // namespace thalweg::io
