// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <filesystem>
#include <string>
#include <vector>

namespace thalweg::study {

/// Becomes the fetcher, a Python program over GDAL beside this one, with these words of the command line. Throws Error
/// if it is not there or does not start.
[[noreturn]] void become_fetcher(const std::vector<std::string>& words);

/// Fetches the DEM of a box (west, south, east, north in degrees) from a source of the fetcher's catalogue into
/// `folder`, under the source's name, with its provenance beside it. Returns the path. Throws Error where the user can
/// mend it, RemoteError where a server failed.
std::filesystem::path fetch_dem(const std::string& source, const std::array<double, 4>& box_deg,
                                const std::filesystem::path& folder);

}  // namespace thalweg::study
