// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "thalweg/core/raster.hpp"

namespace thalweg::io {

/// A rectangle in a raster's own coordinates.
struct Window {
    double west, south, east, north;
};

struct ReadOptions {
    std::optional<double> nodata = {};       ///< value to be taken as no data besides what the file declares
    std::string crs = {};                    ///< e.g. "EPSG:32611": replaces what the file says; empty: the file's own
    int band = 1;                            ///< that holds the heights
    std::optional<Window> window = {};       ///< only the cells whose middle lies in it, in the file's coordinates
    std::optional<double> sea_level_m = {};  ///< cells at or below are no data
    std::string reproject = {};              ///< coordinate system to warp to, after all of the above
    std::optional<double> cell_m = {};       ///< size of the cells to warp to
};

/// A raster with what the reader noticed, one sentence each, for the user to see (a missing CRS taken as WGS 84, a
/// border of zeros that is no declared nodata, …).
struct ReadResult {
    Raster raster;
    std::vector<std::string> warnings;
    std::string crs_name;        ///< "EPSG:32611" where known, else the name in the WKT, else ""
    double vertical_unit_m = 1;  ///< heights were multiplied by this
    Index void_cells = 0;        ///< without data inside the terrain, where no way through voids leads to the edge
};

/// Elevations from the first band of any raster that GDAL reads, in metres, with the grid's measures: metres on the
/// projected plane (from the CRS's unit), or ellipsoidal for degrees. No data (tag, mask band, NaN, infinity) becomes
/// NaN; scale and offset are applied; south-up rasters are turned over; a zip that holds one raster is opened.
/// Throws Error, one sentence, for what cannot be measured: no raster, no geotransform, rotated, all no data, one row
/// or column, too many cells, a CRS that is neither geographic nor projected, truncated data.
ReadResult read_raster(const std::filesystem::path&, const ReadOptions& = {});

/// The raster on cells about `times` (from 1 on) as wide and as high: as many whole ones as come nearest to that, at least
/// two each way, over the very same ground. Heights are means of the cells beneath, or bilinear below 1.9 times, by
/// GDAL's warper without any change of coordinates; no data where less than half of a cell's ground has any. The grid's
/// measures are those of the new cells, on degrees ellipsoidal. Throws Error where nothing has data then.
Raster on_larger_cells(const Raster&, double times);

/// Cells of those holes of no data inside the terrain that touch a part of it (1 in `part`, by cell) at a side or a
/// corner; holes as `void_cells` of a ReadResult counts them. Linear.
Index void_cells_beside(const Raster&, std::span<const std::uint8_t> part);

enum class CellType { float64, uint8, int32 };

enum class Layout {
    tiled,           ///< tiles of 256² cells
    cloud_optimized  ///< tiles of 512², overviews, headers first (GDAL's COG driver): read in parts over a network
};

/// Colour of the cells with a certain value.
struct CellColor {
    std::uint8_t value;
    std::uint8_t red, green, blue;
};

/// What a written raster holds.
struct Layer {
    CellType type = CellType::float64;
    std::optional<double> nodata = {};  ///< tag to write; NaN in memory becomes this
    std::string description = {};       ///< of the band, with its unit
    Layout layout = Layout::tiled;
    std::vector<CellColor> colors = {};  ///< of uint8; the other values are white. None: no colour table
};

/// Writes a GeoTIFF with the statistics of its values, by which viewers stretch their colours (ZSTD with predictor
/// where GDAL has it, else DEFLATE), bytes a function of the values alone. Throws Error when it cannot be written whole
/// (permissions, full disk).
void write_raster(const std::filesystem::path&, const Grid&, const Placement&, std::span<const double> values,
                  const Layer&);

/// Puts the values of whole rows, from `first_row` on, into `cells`.
using RowSource = std::function<void(Index first_row, std::span<double> cells)>;

/// The same of values that are made as they are needed, which may be twice.
void write_raster(const std::filesystem::path&, const Grid&, const Placement&, const RowSource&, const Layer&);

}  // namespace thalweg::io
