// SPDX-License-Identifier: GPL-3.0-or-later
#include "thalweg/io/versions.hpp"

#include <gdal.h>

#include <GeographicLib/Config.h>

namespace thalweg::io {

std::vector<std::pair<std::string, std::string>> library_versions() {
    return {{"GDAL", GDALVersionInfo("RELEASE_NAME")}, {"GeographicLib", GEOGRAPHICLIB_VERSION_STRING}};
}

}  // namespace thalweg::io
