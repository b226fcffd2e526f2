// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/raster_window.hpp"

#include "io/utm_zone.hpp"

#include <cpl_string.h>
#include <cpl_vsi.h>
#include <fmt/format.h>
#include <gdal_alg.h>
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

/// `for_the_place` is named where the text cannot be understood.
OGRSpatialReference system_of(const std::string& text, const std::string& for_the_place) {
    OGRSpatialReference system;
    const char* const options[] = {"ALLOW_NETWORK_ACCESS=NO", "ALLOW_FILE_ACCESS=NO", nullptr};
    if (system.SetFromUserInput(text.c_str(), options) != OGRERR_NONE) {
        throw Error(fmt::format("'{}' is no coordinate system that GDAL knows: {} or the like", text,
                                try_instead(text, for_the_place)));
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

/// Cells of the raster in another system, and how far they reach there, as GDAL would choose them.
struct Reach {
    double cols, rows;
    double width, height;  ///< in the system's units
};

Reach reach_in(GDALDataset& source, const OGRSpatialReference& system, const std::string& name) {
    char* text = nullptr;
    system.exportToWkt(&text);
    CPLStringList options(CSLSetNameValue(nullptr, "DST_SRS", text), TRUE);
    CPLFree(text);
    const std::unique_ptr<void, decltype(&GDALDestroyGenImgProjTransformer)> change(
        GDALCreateGenImgProjTransformer2(&source, nullptr, options.List()), GDALDestroyGenImgProjTransformer);
    std::array<double, 6> transform{};
    std::array<double, 4> edges{};  // west, south, east, north
    int cols = 0, rows = 0;
    if (!change || GDALSuggestedWarpOutput2(&source, GDALGenImgProjTransform, change.get(), transform.data(), &cols,
                                            &rows, edges.data(), 0) != CE_None) {
        throw Error(fmt::format("{} cannot be put into {}, which does not reach there: give another --reproject", name,
                                system.GetName()));
    }
    return {static_cast<double>(cols), static_cast<double>(rows), edges[2] - edges[0], edges[3] - edges[1]};
}

/// Before GDAL is asked for cells that it cannot make, or that are no terrain.
void check_cell(GDALDataset& source, const OGRSpatialReference& system, const std::string& name, double cell_m) {
    const Reach reach = reach_in(source, system, name);
    const double unit_m = system.GetLinearUnits(), width_m = reach.width * unit_m, height_m = reach.height * unit_m;
    const auto along = [&](double length_m) { return std::max(1.0, std::floor(length_m / cell_m + 0.5)); };  // as GDAL
    const double rows = along(height_m), cols = along(width_m);
    if (rows < 2 || cols < 2) {
        throw Error(
            fmt::format("cells of {:g} m would leave {:.0f} x {:.0f} of {} (rows x columns), which is {:.4g} m "
                        "high and {:.4g} m wide: give a --cell-m of at most {:.2g}",
                        cell_m, rows, cols, name, height_m, width_m, std::min(width_m, height_m) / 2.5));
    }
    constexpr double copies = 2;  // GDAL's and ours
    const auto memory = static_cast<double>(CPLGetUsablePhysicalRAM());
    const double fit = memory > 0 ? std::min(memory / (copies * sizeof(double)), double{none}) : double{none};
    if (rows * cols < fit) return;
    throw Error(fmt::format(
        "cells of {:g} m would be {:.3g} x {:.3g} of {} (rows x columns), more than {}: it has cells "
        "of about {:.3g} m, so give a --cell-m of at least {:.2g}",
        cell_m, rows, cols, name, fit < none ? "the memory of this machine holds" : "32-bit numbers can count",
        std::sqrt(width_m * height_m / (reach.rows * reach.cols)), 1.1 * std::sqrt(width_m * height_m / fit)));
}

CPLStringList warp_arguments(const Raster& raster, GDALDataset& source, const std::string& name,
                             const ReadOptions& options) {
    CPLStringList arguments;
    const auto add = [&](std::initializer_list<std::string> words) {
        for (const std::string& word : words) arguments.AddString(word.c_str());
    };
    const std::string target = options.reproject.empty() ? raster.placement.crs_wkt : options.reproject;
    if (target.empty()) {
        throw Error(fmt::format("{} has no coordinate system to start from: give it with --crs", name));
    }
    const std::string for_the_place = system_for(raster.placement, raster.grid.rows, raster.grid.cols);
    const OGRSpatialReference system = system_of(target, for_the_place);
    add({"-of", "MEM", "-t_srs", target});
    const double wide = std::max(mean_step(raster.grid.east_west), mean_step(raster.grid.north_south));
    if (options.cell_m) {
        if (!system.IsProjected()) {
            throw Error(fmt::format(
                "cells in metres need a projected coordinate system: give one to reproject to, e.g. --reproject {}",
                for_the_place));
        }
        check_cell(source, system, name, *options.cell_m);
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

DatasetPtr warp(GDALDataset& source, const std::string& name, CPLStringList& arguments) {
    const std::unique_ptr<GDALWarpAppOptions, decltype(&GDALWarpAppOptionsFree)> parsed(
        GDALWarpAppOptionsNew(arguments.List(), nullptr), GDALWarpAppOptionsFree);
    GDALDatasetH from = &source;
    DatasetPtr result(GDALDataset::FromHandle(GDALWarp("", nullptr, 1, &from, parsed.get(), nullptr)));
    if (!result) throw Error(fmt::format("{} cannot be put on other cells: {}", name, CPLGetLastErrorMsg()));
    result->GetRasterBand(1)->SetUnitType("m");
    return result;
}

}  // namespace

DatasetPtr warped(const Raster& raster, const std::string& name, const ReadOptions& options) {
    const DatasetPtr source = dataset_over(raster);
    CPLStringList arguments = warp_arguments(raster, *source, name, options);
    return warp(*source, name, arguments);
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
    return warp(*dataset_over(raster), "the terrain", arguments);
}

}  // namespace thalweg::io
