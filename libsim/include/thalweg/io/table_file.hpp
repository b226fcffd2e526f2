// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

#include "thalweg/core/table.hpp"

namespace thalweg::io {

/// Writes a header line and one line per row; numbers with the fewest digits that read back to the same double (through
/// GDAL's CSV driver no such promise exists, so this writes the text itself with std::to_chars).
void write_csv(const std::filesystem::path&, const Table&);

/// Reads what write_csv wrote: every column as numbers where all its fields are numbers or empty (NaN), else as text.
Table read_csv(const std::filesystem::path&);

/// The same; `lines` receives the line (from 1) in which each row begins, for messages about what it holds.
Table read_csv(const std::filesystem::path&, std::vector<std::size_t>& lines);

/// A layer of more rows has no spatial index: entering them one by one takes SQLite four fifths of the time of writing
/// a layer (9 of 11 µs per row, measured on a grown network of 2.2e5 links) and makes a quarter of the file.
constexpr std::size_t most_indexed_rows = 500000;

/// Writes tables as layers of a GeoPackage, bytes a function of the contents alone (fixed date).
/// `crs_wkt` empty: an undefined Cartesian system. Styles go into the table `layer_styles`, each as its layer's
/// default, where QGIS looks for them. Layers of up to `most_indexed_rows` have a spatial index.
void write_geopackage(const std::filesystem::path&, const std::vector<Table>& layers, const std::string& crs_wkt);

}  // namespace thalweg::io
