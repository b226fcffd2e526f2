// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "thalweg/io/raster_file.hpp"
#include "thalweg/study/measure.hpp"
#include "thalweg/study/outlet.hpp"

namespace thalweg::study {

/// Where a command says what it is doing and what the user should know.
struct Messages {
    std::function<void(const std::string&)> progress = [](const std::string&) {};
    std::function<void(const std::string&)> warning = [](const std::string&) {};
    std::function<void(const std::string&)> report = [](const std::string&) {};  ///< what was found, in a line
};

/// Where a DEM comes from, as the provenance that `thalweg fetch` writes beside it says.
struct Origin {
    std::string title, licence, citation, vertical, obtained_from;
};

/// What FILE.json beside a DEM says of it. Nothing where there is no such file or it is no provenance; nothing and a
/// warning where it is about a file with another checksum.
std::optional<Origin> origin_of(const std::filesystem::path& dem, const std::string& sha256,
                                std::vector<std::string>& warnings);

/// A DEM as it was read, with what the manifest and the summary say of it.
struct NamedRaster {
    Raster raster;
    std::string file;
    std::string sha256;
    std::string crs_name;
    std::vector<std::string> warnings;
    std::optional<Origin> origin;
    double vertical_unit_m = 1;               ///< heights were multiplied by this
    Index void_cells = 0;                     ///< without data inside the terrain (cut down: in holes it touches)
    std::optional<OutletReport> outlet = {};  ///< of the catchment that it was cut down to
};

/// Reads a DEM and its checksum; warnings go to `messages`.
NamedRaster read_dem(const std::filesystem::path&, const io::ReadOptions&, const Messages&);

/// Cuts a DEM down to the catchment above an outlet, and sets the options to measure it whole: it leaves there, its rim
/// is a divide, and where nothing else is asked for channels begin at `catchment_channel_area`. A warning tells where
/// the edge of the data cuts it.
NamedRaster cut_to_outlet(const NamedRaster&, const OutletRequest&, MeasureOptions&, const Messages&);

/// Measures a DEM and writes summary.json, the GeoTIFFs, network.gpkg and the CSVs into an existing folder.
/// Returns the text of summary.json.
std::string analyze(const NamedRaster&, const MeasureOptions&, const std::filesystem::path& folder, const Messages&);

}  // namespace thalweg::study
