// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/raster_window.hpp"

#include <cpl_string.h>
#include <fmt/format.h>
#include <gdal_utils.h>
#include <ogr_spatialref.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <memory>
#include <vector>

#include "thalweg/core/error.hpp"

namespace thalweg::io {
namespace {

/// First cell and number of cells.
struct Span {
    int first, count;
};

/// Cells along one axis whose middles lie between two places; `step` from cell to cell may be negative.
Span cells_between(double low, double high, double origin, double step, int cells) {
    const double a = (low - origin) / step, b = (high - origin) / step;
    const double first = std::ceil(std::clamp(std::min(a, b), -1.0, cells + 1.0) - 0.5);
    const double last = std::floor(std::clamp(std::max(a, b), -1.0, cells + 1.0) - 0.5);
    const int from = std::max(0, static_cast<int>(first));
    return {from, std::min(cells - 1, static_cast<int>(last)) - from + 1};
}

std::array<double, 6> transform_of(GDALDataset& dataset, const std::string& name) {
    std::array<double, 6> transform{};
    const bool placed = dataset.GetGeoTransform(transform.data()) == CE_None;
    if (placed && transform[2] == 0 && transform[4] == 0) return transform;
    throw Error(fmt::format("{} has no upright place on the earth, so no window of it can be told", name));
}

void add_window(CPLStringList& arguments, GDALDataset& dataset, const std::string& name, const Window& window) {
    const auto t = transform_of(dataset, name);
    const Span cols = cells_between(window.west, window.east, t[0], t[1], dataset.GetRasterXSize());
    const Span rows = cells_between(window.south, window.north, t[3], t[5], dataset.GetRasterYSize());
    if (cols.count < 2 || rows.count < 2) {
        const double x = t[0] + t[1] * dataset.GetRasterXSize(), y = t[3] + t[5] * dataset.GetRasterYSize();
        throw Error(
            fmt::format("the window holds fewer than 2 x 2 cells of {}, which reaches from {:.10g} to {:.10g} and "
                        "from {:.10g} to {:.10g}; a window is west, south, east, north in the DEM's coordinates",
                        name, std::min(t[0], x), std::max(t[0], x), std::min(t[3], y), std::max(t[3], y)));
    }
    arguments.AddString("-srcwin");
    for (const int number : {cols.first, rows.first, cols.count, rows.count}) {
        arguments.AddString(fmt::format("{}", number).c_str());
    }
}

/// The band of the heights, and the alpha band that hides some of them.
void add_bands(CPLStringList& arguments, GDALDataset& dataset, int heights) {
    const int last = dataset.GetRasterCount();
    const bool has_alpha = dataset.GetRasterBand(last)->GetColorInterpretation() == GCI_AlphaBand && last != heights;
    for (const int band : has_alpha ? std::vector{heights, last} : std::vector{heights}) {
        arguments.AddString("-b");
        arguments.AddString(fmt::format("{}", band).c_str());
    }
}

OGRSpatialReference system_of(const std::string& text) {
    OGRSpatialReference system;
    if (system.SetFromUserInput(text.c_str()) != OGRERR_NONE) {
        throw Error(fmt::format("'{}' is no coordinate system that GDAL knows: try EPSG:32611 or the like", text));
    }
    return system;
}

double mean_step(const std::vector<double>& steps) {
    double sum = 0;
    for (const double step : steps) sum += step;
    return steps.empty() ? 0 : sum / static_cast<double>(steps.size());
}

/// How the warper interpolates onto cells so many times as wide.
const char* resampling(double times) { return times > 1.9 ? "average" : "bilinear"; }

CPLStringList warp_arguments(const Raster& raster, const std::string& name, const ReadOptions& options) {
    CPLStringList arguments;
    const auto add = [&](std::initializer_list<std::string> words) {
        for (const std::string& word : words) arguments.AddString(word.c_str());
    };
    const std::string target = options.reproject.empty() ? raster.placement.crs_wkt : options.reproject;
    if (target.empty()) {
        throw Error(fmt::format("{} has no coordinate system to start from: give it with --crs", name));
    }
    const OGRSpatialReference system = system_of(target);
    add({"-of", "MEM", "-t_srs", target});
    const double wide = std::max(mean_step(raster.grid.east_west), mean_step(raster.grid.north_south));
    if (options.cell_m) {
        if (!system.IsProjected()) {
            throw Error(
                "cells in metres need a projected coordinate system: give one to reproject to, e.g. EPSG:32611");
        }
        const std::string step = fmt::format("{:.17g}", *options.cell_m / system.GetLinearUnits());
        add({"-tr", step, step});
    }
    add({"-r", resampling(options.cell_m ? *options.cell_m / wide : 1), "-et", "0"});
    return arguments;
}

}  // namespace

DatasetPtr dataset_over(const Raster& raster) {
    GDALDriver* memory = GetGDALDriverManager()->GetDriverByName("MEM");
    const int cols = static_cast<int>(raster.grid.cols), rows = static_cast<int>(raster.grid.rows);
    DatasetPtr dataset(memory->Create("", cols, rows, 1, GDT_Float64, nullptr));
    if (!dataset) throw std::bad_alloc();
    const Placement& p = raster.placement;
    std::array<double, 6> transform{p.west, p.cell_width, 0, p.north, 0, -p.cell_height};
    dataset->SetGeoTransform(transform.data());
    dataset->SetProjection(p.crs_wkt.c_str());
    GDALRasterBand& band = *dataset->GetRasterBand(1);
    band.SetNoDataValue(std::numeric_limits<double>::quiet_NaN());
    band.SetUnitType("m");
    void* const read_only = const_cast<double*>(raster.values.data());  // one function reads and writes
    if (band.RasterIO(GF_Write, 0, 0, cols, rows, read_only, cols, rows, GDT_Float64, 0, 0, nullptr) != CE_None) {
        throw std::bad_alloc();
    }
    return dataset;
}

DatasetPtr window_of(GDALDataset& dataset, const std::string& name, const ReadOptions& options) {
    if (options.band < 1 || options.band > dataset.GetRasterCount()) {
        throw Error(fmt::format("{} has no band {}: it has {}", name, options.band, dataset.GetRasterCount()));
    }
    if (options.band == 1 && !options.window) return nullptr;
    CPLStringList arguments;
    for (const char* word : {"-of", "VRT"}) arguments.AddString(word);
    if (options.band != 1) add_bands(arguments, dataset, options.band);
    if (options.window) add_window(arguments, dataset, name, *options.window);
    const std::unique_ptr<GDALTranslateOptions, decltype(&GDALTranslateOptionsFree)> parsed(
        GDALTranslateOptionsNew(arguments.List(), nullptr), GDALTranslateOptionsFree);
    DatasetPtr view(GDALDataset::FromHandle(GDALTranslate("", &dataset, parsed.get(), nullptr)));
    if (!view) throw Error(fmt::format("no part of {} can be read: {}", name, CPLGetLastErrorMsg()));
    return view;
}

namespace {

DatasetPtr warp(const Raster& raster, const std::string& name, CPLStringList& arguments) {
    const DatasetPtr source = dataset_over(raster);
    const std::unique_ptr<GDALWarpAppOptions, decltype(&GDALWarpAppOptionsFree)> parsed(
        GDALWarpAppOptionsNew(arguments.List(), nullptr), GDALWarpAppOptionsFree);
    GDALDatasetH from = source.get();
    DatasetPtr result(GDALDataset::FromHandle(GDALWarp("", nullptr, 1, &from, parsed.get(), nullptr)));
    if (!result) throw Error(fmt::format("{} cannot be put on other cells: {}", name, CPLGetLastErrorMsg()));
    result->GetRasterBand(1)->SetUnitType("m");
    return result;
}

}  // namespace

DatasetPtr warped(const Raster& raster, const std::string& name, const ReadOptions& options) {
    CPLStringList arguments = warp_arguments(raster, name, options);
    return warp(raster, name, arguments);
}

DatasetPtr on_cells(const Raster& raster, Index rows, Index cols) {
    const Placement& p = raster.placement;
    const double east = p.west + raster.grid.cols * p.cell_width, south = p.north - raster.grid.rows * p.cell_height;
    CPLStringList arguments;
    const auto add = [&](std::initializer_list<std::string> words) {
        for (const std::string& word : words) arguments.AddString(word.c_str());
    };
    const auto text = [](double number) { return fmt::format("{:.17g}", number); };
    add({"-of", "MEM", "-te", text(p.west), text(south), text(east), text(p.north)});
    add({"-ts", fmt::format("{}", cols), fmt::format("{}", rows)});
    add({"-r", resampling(double(raster.grid.cols) / cols), "-et", "0"});
    return warp(raster, "the terrain", arguments);
}

}  // namespace thalweg::io
