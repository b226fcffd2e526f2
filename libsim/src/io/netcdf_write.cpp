// SPDX-License-Identifier: GPL-3.0-or-later
#include <cpl_string.h>
#include <fmt/format.h>
#include <ogr_spatialref.h>

#include <array>
#include <bit>
#include <cmath>
#include <limits>

#include "io/gdal_guard.hpp"
#include "thalweg/core/error.hpp"
#include "thalweg/io/raster_series.hpp"

namespace thalweg::io {
namespace {

using ArrayPtr = std::shared_ptr<GDALMDArray>;
using DimensionPtr = std::shared_ptr<GDALDimension>;

/// What the elements of a netCDF are called where the plane is, or is not, somewhere on the earth.
struct Axes {
    std::string x_name = "x", y_name = "y";
    std::string x_standard, y_standard, unit;
};

Axes axes_of(const Placement& place, const OGRSpatialReference& crs) {
    if (place.geographic) return {"lon", "lat", "longitude", "latitude", ""};
    if (place.crs_wkt.empty()) return {"x", "y", "", "", "m"};
    const double unit = crs.GetLinearUnits();
    std::string name = "m";
    if (std::abs(unit - 0.3048) < 1e-9) name = "foot";
    if (std::abs(unit - 1200.0 / 3937) < 1e-9) name = "US_survey_foot";
    if (unit != 1 && name == "m") name = fmt::format("{} m", unit);
    return {"x", "y", "projection_x_coordinate", "projection_y_coordinate", name};
}

[[noreturn]] void unwritten(const std::filesystem::path& path, const GdalGuard& gdal) {
    throw Error(fmt::format("{} could not be written whole{}", path.string(), because(gdal)));
}

void attribute(GDALMDArray& array, const char* name, const std::string& text) {
    if (text.empty()) return;
    const auto made = array.CreateAttribute(name, {}, GDALExtendedDataType::CreateString());
    if (made) made->Write(text.c_str());
}

void attribute(GDALGroup& group, const char* name, const std::string& text) {
    const auto made = group.CreateAttribute(name, {}, GDALExtendedDataType::CreateString());
    if (made) made->Write(text.c_str());
}

ArrayPtr coordinate(GDALGroup& root, const DimensionPtr& dimension, const std::vector<double>& values) {
    const auto type = GDALExtendedDataType::Create(GDT_Float64);
    ArrayPtr array = root.CreateMDArray(dimension->GetName(), {dimension}, type, nullptr);
    if (!array) return nullptr;
    const GUInt64 start = 0;
    const size_t count = values.size();
    array->Write(&start, &count, nullptr, nullptr, type, values.data());
    return array;
}

std::vector<double> centers(double first, double step, Index count) {
    std::vector<double> values;
    for (Index i = 0; i < count; ++i) values.push_back(first + (i + 0.5) * step);
    return values;
}

/// Bytes of the values, mixed (FNV-1a on words), to compare what was written with what is read.
std::uint64_t mixed(const std::vector<double>& values) {
    std::uint64_t hash = 14695981039346656037u;
    for (const double value : values) {
        hash = (hash ^ (std::isnan(value) ? 1 : std::bit_cast<std::uint64_t>(value))) * 1099511628211u;
    }
    return hash;
}

/// The file with its dimensions and coordinates, and the array to be filled.
class Series {
  public:
    Series(const std::filesystem::path& path, const RasterSeries& series, const Raster& first) {
        GDALDriver* driver = GetGDALDriverManager()->GetDriverByName("netCDF");
        if (driver == nullptr) throw Error("this GDAL was built without netCDF, so no snapshots can be written");
        const Placement& place = first.placement;
        OGRSpatialReference crs;
        crs.SetAxisMappingStrategy(OAMS_TRADITIONAL_GIS_ORDER);
        if (!place.crs_wkt.empty()) crs.importFromWkt(place.crs_wkt.c_str());
        const Axes axes = axes_of(place, crs);
        // Not netCDF-4: deflate saves a fifth on elevations, and HDF5 ends the program badly once a disk was full.
        CPLStringList options;
        options.SetNameValue("FORMAT", "NC2");
        dataset_.reset(driver->CreateMultiDimensional(path.c_str(), nullptr, options.List()));
        if (!dataset_) return;
        const auto root = dataset_->GetRootGroup();
        describe(*root, series);
        CPLStringList record;  // so that only one raster, and not all of them, must stay under 4 GiB
        record.SetNameValue("UNLIMITED", "YES");
        const auto time =
            root->CreateDimension("time", GDAL_DIM_TYPE_TEMPORAL, "", series.time_yr.size(), record.List());
        const auto y = root->CreateDimension(axes.y_name, GDAL_DIM_TYPE_HORIZONTAL_Y, "NORTH", first.grid.rows);
        const auto x = root->CreateDimension(axes.x_name, GDAL_DIM_TYPE_HORIZONTAL_X, "EAST", first.grid.cols);
        if (!time || !y || !x) return;
        place_in_time(*root, time, series);
        place_on_earth(*root, y, centers(place.north, -place.cell_height, first.grid.rows), axes.y_standard,
                       axes.unit.empty() ? "degrees_north" : axes.unit, "Y");
        place_on_earth(*root, x, centers(place.west, place.cell_width, first.grid.cols), axes.x_standard,
                       axes.unit.empty() ? "degrees_east" : axes.unit, "X");
        make_elevation(*root, {time, y, x}, place.crs_wkt.empty() ? nullptr : &crs);
    }

    bool write(std::size_t number, const Raster& raster) {
        if (!elevation_) return false;
        const std::array<GUInt64, 3> start{number, 0, 0};
        const std::array<size_t, 3> count{1, raster.grid.rows, raster.grid.cols};
        return elevation_->Write(start.data(), count.data(), nullptr, nullptr,
                                 GDALExtendedDataType::Create(GDT_Float64), raster.values.data());
    }

    void close() {
        elevation_.reset();
        dataset_.reset();
    }

  private:
    static void describe(GDALGroup& root, const RasterSeries& series) {
        attribute(root, "Conventions", "CF-1.8");
        attribute(root, "title", series.title);
        attribute(root, "source", series.source);
    }

    static void place_in_time(GDALGroup& root, const DimensionPtr& dimension, const RasterSeries& series) {
        const ArrayPtr time = coordinate(root, dimension, series.time_yr);
        if (!time) return;
        time->SetUnit("year");
        attribute(*time, "long_name", "time since the start of the simulation");
        attribute(*time, "axis", "T");
    }

    static void place_on_earth(GDALGroup& root, const DimensionPtr& dimension, const std::vector<double>& values,
                               const std::string& standard_name, const std::string& unit, const char* axis) {
        const ArrayPtr array = coordinate(root, dimension, values);
        if (!array) return;
        array->SetUnit(unit);
        attribute(*array, "standard_name", standard_name);
        attribute(*array, "long_name", fmt::format("{} of the cell's centre", dimension->GetName()));
        attribute(*array, "axis", axis);
    }

    void make_elevation(GDALGroup& root, const std::vector<DimensionPtr>& dimensions, const OGRSpatialReference* crs) {
        elevation_ = root.CreateMDArray("elevation", dimensions, GDALExtendedDataType::Create(GDT_Float64), nullptr);
        if (!elevation_) return;
        elevation_->SetUnit("m");
        elevation_->SetNoDataValue(std::numeric_limits<double>::quiet_NaN());
        attribute(*elevation_, "standard_name", "surface_altitude");
        attribute(*elevation_, "long_name", "elevation of the simulated surface");
        if (crs != nullptr) elevation_->SetSpatialRef(crs);
    }

    DatasetPtr dataset_;
    ArrayPtr elevation_;
};

/// GDAL's close cannot fail, so a full disk can leave a file that looks complete.
bool reads_back(const std::filesystem::path& path, const std::vector<std::uint64_t>& written, const Grid& grid) {
    const DatasetPtr dataset(GDALDataset::Open(path.c_str(), GDAL_OF_MULTIDIM_RASTER));
    const auto root = dataset ? dataset->GetRootGroup() : nullptr;
    const ArrayPtr elevation = root ? root->OpenMDArray("elevation") : nullptr;
    if (!elevation) return false;
    std::vector<double> values(grid.size());
    for (std::size_t number = 0; number < written.size(); ++number) {
        const std::array<GUInt64, 3> start{number, 0, 0};
        const std::array<size_t, 3> count{1, grid.rows, grid.cols};
        const bool read = elevation->Read(start.data(), count.data(), nullptr, nullptr,
                                          GDALExtendedDataType::Create(GDT_Float64), values.data());
        if (!read || mixed(values) != written[number]) return false;
    }
    return true;
}

void write_file(const std::filesystem::path& path, const RasterSeries& series, GdalGuard& gdal) {
    Raster raster = series.elevation_m(0);
    const Grid grid = raster.grid;
    Series file(path, series, raster);
    std::vector<std::uint64_t> written;
    bool whole = true;
    for (std::size_t number = 0; number < series.time_yr.size(); ++number) {
        if (number > 0) raster = series.elevation_m(number);
        whole = whole && file.write(number, raster);
        written.push_back(mixed(raster.values));
    }
    file.close();
    if (!whole || gdal.failed() || !reads_back(path, written, grid)) unwritten(path, gdal);
}

}  // namespace

void write_netcdf(const std::filesystem::path& path, const RasterSeries& series) {
    if (series.time_yr.empty()) throw Error(fmt::format("{} would hold no raster", path.string()));
    GdalGuard gdal;
    try {
        write_file(path, series, gdal);
    } catch (const Error&) {
        std::error_code ignored;
        std::filesystem::remove(path, ignored);
        throw;
    }
}

}  // namespace thalweg::io
