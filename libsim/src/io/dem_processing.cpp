// SPDX-License-Identifier: GPL-3.0-or-later
#include "thalweg/io/dem_processing.hpp"

#include <cpl_string.h>
#include <fmt/format.h>
#include <gdal_utils.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "io/gdal_guard.hpp"
#include "io/raster_window.hpp"
#include "thalweg/core/error.hpp"

namespace thalweg::io {
namespace {

constexpr double nan = std::numeric_limits<double>::quiet_NaN();

/// The middle between the lowest and the highest value; 0 without data.
double middle_of(const std::vector<double>& values) {
    double lowest = std::numeric_limits<double>::infinity(), highest = -lowest;
    for (const double value : values) {
        lowest = value < lowest ? value : lowest;
        highest = value > highest ? value : highest;
    }
    return lowest <= highest ? 0.5 * (lowest + highest) : 0;
}

Raster over_middle(const Raster& raster) {
    Raster shifted = raster;
    const double middle = middle_of(raster.values);
    for (double& value : shifted.values) value -= middle;
    return shifted;
}

std::vector<double> values_of(GDALDataset& dataset, const Grid& grid) {
    std::vector<double> values(grid.size());
    GDALRasterBand& band = *dataset.GetRasterBand(1);
    const int cols = static_cast<int>(grid.cols), rows = static_cast<int>(grid.rows);
    if (band.RasterIO(GF_Read, 0, 0, cols, rows, values.data(), cols, rows, GDT_Float64, 0, 0, nullptr) != CE_None) {
        throw std::bad_alloc();
    }
    const double nodata = band.GetNoDataValue();
    std::ranges::replace(values, nodata, nan);
    return values;
}

}  // namespace

std::vector<double> roughness(const Raster& elevation_m) {
    const Grid& grid = elevation_m.grid;
    if (grid.rows < 3 || grid.cols < 3) return std::vector<double>(grid.size(), nan);
    const GdalGuard gdal;
    const DatasetPtr source = dataset_over(over_middle(elevation_m));
    CPLStringList arguments;
    for (const char* word : {"-of", "MEM"}) arguments.AddString(word);
    const std::unique_ptr<GDALDEMProcessingOptions, decltype(&GDALDEMProcessingOptionsFree)> parsed(
        GDALDEMProcessingOptionsNew(arguments.List(), nullptr), GDALDEMProcessingOptionsFree);
    const DatasetPtr result(
        GDALDataset::FromHandle(GDALDEMProcessing("", source.get(), "roughness", nullptr, parsed.get(), nullptr)));
    if (!result) throw Error(fmt::format("GDAL cannot take the roughness of these heights{}", because(gdal)));
    return values_of(*result, grid);
}

}  // namespace thalweg::io
