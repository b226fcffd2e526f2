// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "thalweg/io/raster_file.hpp"
#include "thalweg/study/measure.hpp"

namespace thalweg::study {

/// Where a command says what it is doing and what the user should know.
struct Messages {
    std::function<void(const std::string&)> progress = [](const std::string&) {};
    std::function<void(const std::string&)> warning = [](const std::string&) {};
};

/// A DEM as it was read, with what the manifest and the summary say of it.
struct NamedRaster {
    Raster raster;
    std::string file;
    std::string sha256;
    std::string crs_name;
    std::vector<std::string> warnings;
};

/// Reads a DEM and its checksum; warnings go to `messages`.
NamedRaster read_dem(const std::filesystem::path&, const io::ReadOptions&, const Messages&);

/// Measures a DEM and writes summary.json, the GeoTIFFs, network.gpkg and the CSVs into an existing folder.
/// Returns the text of summary.json.
std::string analyze(const NamedRaster&, const MeasureOptions&, const std::filesystem::path& folder, const Messages&);

}  // namespace thalweg::study
