// SPDX-License-Identifier: GPL-3.0-or-later
#include "thalweg/io/raster_file.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <new>

#include "io/gdal_guard.hpp"
#include "io/raster_open.hpp"
#include "io/raster_place.hpp"
#include "io/raster_survey.hpp"
#include "io/raster_window.hpp"
#include "thalweg/core/error.hpp"

namespace thalweg::io {
namespace {

constexpr double no_value = std::numeric_limits<double>::quiet_NaN();

void check_size(GDALDataset& dataset, const std::string& name) {
    const auto rows = static_cast<std::uint64_t>(dataset.GetRasterYSize());
    const auto cols = static_cast<std::uint64_t>(dataset.GetRasterXSize());
    if (rows < 2 || cols < 2) {
        throw Error(
            fmt::format("{} has {} x {} cells (rows x columns); a terrain needs at least 2 x 2", name, rows, cols));
    }
    if (rows * cols >= none) {
        throw Error(
            fmt::format("{} has {} x {} cells, more than 32-bit numbers can count: read a part of it "
                        "(--crop), or coarsen it with gdalwarp first",
                        name, rows, cols));
    }
    const auto memory = static_cast<std::uint64_t>(CPLGetUsablePhysicalRAM());
    if (memory > 0 && rows * cols > memory / sizeof(double)) {
        throw Error(
            fmt::format("the {} x {} cells of {} do not fit the memory of this machine: read a part of it "
                        "(--crop), or coarsen it with gdalwarp first",
                        rows, cols, name));
    }
}

void check_band(GDALDataset& dataset, const std::string& name, const ReadOptions& options, ReadResult& result) {
    GDALRasterBand& band = *dataset.GetRasterBand(1);
    if (GDALDataTypeIsComplex(band.GetRasterDataType())) {
        throw Error(fmt::format("the first band of {} holds complex numbers, not heights", name));
    }
    if (band.GetColorTable() != nullptr || band.GetColorInterpretation() == GCI_RedBand) {
        result.warnings.push_back(
            fmt::format("the first band of {} is coloured like a picture: its values are taken as "
                        "heights",
                        name));
    } else if (options.band == 1 && dataset.GetRasterCount() > 1 &&
               dataset.GetRasterBand(2)->GetColorInterpretation() != GCI_AlphaBand) {
        result.warnings.push_back(
            fmt::format("{} has {} bands: the first one is taken as heights", name, dataset.GetRasterCount()));
    }
}

/// A value as the band would store it, so that a tag written with other digits still meets the cells it means.
double as_stored(double value, GDALDataType type) {
    if (type != GDT_Float32 || !std::isfinite(value)) return value;
    const double largest = std::numeric_limits<float>::max();
    return static_cast<float>(std::clamp(value, -largest, largest));
}

std::vector<double> nodata_values(GDALRasterBand& band, const ReadOptions& options) {
    std::vector<double> values;
    int given = 0;
    const double tag = band.GetNoDataValue(&given);
    if (given && !std::isnan(tag)) values.push_back(as_stored(tag, band.GetRasterDataType()));
    if (options.nodata) values.push_back(as_stored(*options.nodata, band.GetRasterDataType()));
    return values;
}

[[noreturn]] void broken(const std::string& name, const GdalGuard& gdal) {
    throw Error(fmt::format("{} is damaged or cut off ({})", name, gdal.reason()));
}

using Strip = std::span<double>;

void blank_masked(GDALRasterBand& mask, Index first_row, Index rows, Index cols, Strip strip, const std::string& name,
                  const GdalGuard& gdal) {
    std::vector<std::uint8_t> valid(strip.size());
    if (mask.RasterIO(GF_Read, 0, static_cast<int>(first_row), static_cast<int>(cols), static_cast<int>(rows),
                      valid.data(), static_cast<int>(cols), static_cast<int>(rows), GDT_Byte, 0, 0,
                      nullptr) != CE_None) {
        broken(name, gdal);
    }
    for (std::size_t i = 0; i < strip.size(); ++i) {
        if (valid[i] == 0) strip[i] = no_value;
    }
}

/// No file of heights means more than this; it is how some programs write "nothing" without saying so.
constexpr double absurd_height = 1e30;

void blank_nodata(Strip strip, const std::vector<double>& nodata) {
    for (double& value : strip) {
        if (!std::isfinite(value) || std::find(nodata.begin(), nodata.end(), value) != nodata.end()) value = no_value;
    }
}

std::size_t blank_absurd(Strip strip) {
    std::size_t absurd = 0;
    for (double& value : strip) {
        if (std::isnan(value) || std::abs(value) < absurd_height) continue;
        value = no_value;
        ++absurd;
    }
    return absurd;
}

/// Returns how many values are no heights then: the scale, too, may be wrong.
std::size_t to_metres(GDALRasterBand& band, double unit_m, std::vector<double>& values) {
    const double scale = band.GetScale() * unit_m;
    const double offset = band.GetOffset() * unit_m;
    if (scale == 1 && offset == 0) return 0;
    for (double& value : values) value = value * scale + offset;
    return blank_absurd(values);
}

/// The band that tells which cells are valid; null if only nodata values do. GDAL takes alpha for a mask in bands of
/// 8 and 16 bits only, yet its warper adds alpha to heights of any type.
GDALRasterBand* mask_of(GDALDataset& dataset) {
    GDALRasterBand& band = *dataset.GetRasterBand(1);
    if ((band.GetMaskFlags() & (GMF_ALL_VALID | GMF_NODATA)) == 0) return band.GetMaskBand();
    GDALRasterBand* last = dataset.GetRasterBand(dataset.GetRasterCount());
    return last->GetColorInterpretation() == GCI_AlphaBand ? last : nullptr;
}

void read_strip(GDALRasterBand& band, GDALRasterBand* mask, Index first_row, Index rows, Index cols, Strip strip,
                const std::string& name, const GdalGuard& gdal) {
    const CPLErr status =
        band.RasterIO(GF_Read, 0, static_cast<int>(first_row), static_cast<int>(cols), static_cast<int>(rows),
                      strip.data(), static_cast<int>(cols), static_cast<int>(rows), GDT_Float64, 0, 0, nullptr);
    if (status != CE_None || gdal.failed()) broken(name, gdal);
    if (mask != nullptr) blank_masked(*mask, first_row, rows, cols, strip, name, gdal);
}

void read_values(GDALDataset& dataset, const ReadOptions& options, const std::string& name, const GdalGuard& gdal,
                 ReadResult& result) {
    constexpr Index strip_rows = 256;
    GDALRasterBand& band = *dataset.GetRasterBand(1);
    GDALRasterBand* const mask = mask_of(dataset);
    const Grid& grid = result.raster.grid;
    const std::vector<double> nodata = nodata_values(band, options);
    std::vector<double>& values = result.raster.values;
    values.resize(grid.size());
    std::size_t absurd = 0;
    for (Index row = 0; row < grid.rows; row += strip_rows) {
        const Index rows = std::min(strip_rows, grid.rows - row);
        const Strip strip(values.data() + std::size_t{row} * grid.cols, std::size_t{rows} * grid.cols);
        read_strip(band, mask, row, rows, grid.cols, strip, name, gdal);
        blank_nodata(strip, nodata);
        absurd += blank_absurd(strip);
    }
    absurd += to_metres(band, result.vertical_unit_m, values);
    if (absurd > 0) {
        result.warnings.push_back(
            fmt::format("{} cells of {} hold values beyond 1e30, which are no heights: taken as no "
                        "data",
                        absurd, name));
    }
}

void turn_over(Raster& raster) {
    const std::ptrdiff_t cols = raster.grid.cols;
    for (std::ptrdiff_t top = 0, bottom = raster.grid.rows - 1; top < bottom; ++top, --bottom) {
        const auto first = raster.values.begin() + top * cols;
        std::swap_ranges(first, first + cols, raster.values.begin() + bottom * cols);
    }
}

void check_any_data(const ReadResult& result, const std::string& name) {
    const std::vector<double>& values = result.raster.values;
    if (std::all_of(values.begin(), values.end(), [](double value) { return std::isnan(value); })) {
        throw Error(fmt::format("{} holds no data: all of its cells are void", name));
    }
}

void blank_sea(const ReadOptions& options, std::vector<double>& values) {
    if (!options.sea_level_m) return;
    for (double& value : values) value = value <= *options.sea_level_m ? no_value : value;
}

ReadResult read_dataset(GDALDataset& dataset, const std::string& name, const ReadOptions& options,
                        const GdalGuard& gdal) {
    ReadResult result;
    check_size(dataset, name);
    check_band(dataset, name, options, result);
    const RowOrder order = place_raster(dataset, name, options.crs, result);
    read_values(dataset, options, name, gdal, result);
    if (order == RowOrder::south_to_north) turn_over(result.raster);
    blank_sea(options, result.raster.values);
    check_any_data(result, name);
    const HeightsNoticed noticed = notice_heights(result.raster, name);
    result.void_cells = noticed.void_cells;
    result.warnings.insert(result.warnings.end(), noticed.warnings.begin(), noticed.warnings.end());
    return result;
}

/// On other cells; what was noticed of the file's own comes first.
ReadResult read_warped(const ReadResult& read, const std::string& name, const ReadOptions& options,
                       const GdalGuard& gdal) {
    const DatasetPtr dataset = warped(read.raster, name, options);
    ReadResult result = read_dataset(*dataset, name, {}, gdal);
    result.vertical_unit_m = read.vertical_unit_m;
    std::vector<std::string> warnings = read.warnings;
    for (std::string& warning : result.warnings) {
        if (std::ranges::find(warnings, warning) == warnings.end()) warnings.push_back(std::move(warning));
    }
    result.warnings = std::move(warnings);
    return result;
}

}  // namespace

ReadResult read_raster(const std::filesystem::path& path, const ReadOptions& options) {
    GdalGuard gdal;
    const DatasetPtr dataset = open_raster(path, gdal);
    const std::string name = path.string();
    try {
        const DatasetPtr part = window_of(*dataset, name, options);
        ReadResult result = read_dataset(part ? *part : *dataset, name, options, gdal);
        if (options.reproject.empty() && !options.cell_m) return result;
        return read_warped(result, name, options, gdal);
    } catch (const std::bad_alloc&) {
        throw Error(fmt::format(
            "{} does not fit the memory of this machine: read a part of it (--crop), or coarsen it with gdalwarp first",
            name));
    }
}

Raster on_larger_cells(const Raster& raster, double times) {
    const GdalGuard gdal;
    const auto fewer = [times](Index count) {
        return std::clamp<Index>(static_cast<Index>(std::lround(count / times)), std::min<Index>(2, count), count);
    };
    const Index rows = fewer(raster.grid.rows), cols = fewer(raster.grid.cols);
    const std::string name = "the terrain on larger cells";
    const auto read = [&](const Raster& fine) { return read_dataset(*on_cells(fine, rows, cols), name, {}, gdal); };
    Raster share = raster;
    for (double& value : share.values) value = std::isnan(value) ? 0 : 1;
    const std::vector<double> with_data = read(share).raster.values;
    ReadResult large = read(raster);
    for (std::size_t cell = 0; cell < with_data.size(); ++cell) {
        if (with_data[cell] < 0.5) large.raster.values[cell] = no_value;
    }
    check_any_data(large, name);
    return std::move(large.raster);
}

}  // namespace thalweg::io
