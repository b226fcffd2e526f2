// SPDX-License-Identifier: GPL-3.0-or-later
#include <cpl_string.h>
#include <cpl_vsi.h>
#include <fmt/format.h>
#include <ogr_spatialref.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "io/gdal_guard.hpp"
#include "thalweg/core/error.hpp"
#include "thalweg/core/parallel.hpp"
#include "thalweg/io/raster_file.hpp"

namespace thalweg::io {
namespace {

constexpr Index tile = 256;
constexpr Index cloud_tile = 512;

[[noreturn]] void unwritten(const std::filesystem::path& path, const GdalGuard& gdal) {
    throw Error(fmt::format("{} could not be written whole{}", path.string(), because(gdal)));
}

GDALDataType gdal_type(CellType type) {
    if (type == CellType::float64) return GDT_Float64;
    return type == CellType::uint8 ? GDT_Byte : GDT_Int32;
}

bool offers_zstd(GDALDriver& driver) {
    const char* offered = driver.GetMetadataItem(GDAL_DMD_CREATIONOPTIONLIST);
    return offered != nullptr && std::string(offered).find("<Value>ZSTD</Value>") != std::string::npos;
}

CPLStringList creation_options(GDALDriver& driver, CellType type) {
    CPLStringList options;
    options.SetNameValue("TILED", "YES");
    options.SetNameValue("BLOCKXSIZE", fmt::format("{}", tile).c_str());
    options.SetNameValue("BLOCKYSIZE", fmt::format("{}", tile).c_str());
    options.SetNameValue("COMPRESS", offers_zstd(driver) ? "ZSTD" : "DEFLATE");
    // GDAL's own level, 9, takes twice as long for files 7 % smaller.
    if (offers_zstd(driver)) options.SetNameValue("ZSTD_LEVEL", "1");
    options.SetNameValue("NUM_THREADS", fmt::format("{}", thread_limit()).c_str());
    options.SetNameValue("PREDICTOR", type == CellType::float64 ? "3" : "2");
    options.SetNameValue("BIGTIFF", "IF_SAFER");
    return options;
}

CPLStringList cloud_options(GDALDriver& driver, CellType type) {
    CPLStringList options;
    options.SetNameValue("BLOCKSIZE", fmt::format("{}", cloud_tile).c_str());
    options.SetNameValue("COMPRESS", offers_zstd(driver) ? "ZSTD" : "DEFLATE");
    options.SetNameValue("PREDICTOR", "YES");
    options.SetNameValue("OVERVIEW_RESAMPLING", type == CellType::float64 ? "AVERAGE" : "NEAREST");
    options.SetNameValue("NUM_THREADS", "1");
    options.SetNameValue("BIGTIFF", "IF_SAFER");
    return options;
}

double nodata_tag(const Layer& layer) { return layer.nodata.value_or(std::numeric_limits<double>::quiet_NaN()); }

/// Hands the rows on from strip to strip, as they are written: with the tag in the place of no data.
class Strips {
  public:
    Strips(const Grid& grid, const RowSource& source, const Layer& layer)
        : grid_(grid), source_(source), tag_(nodata_tag(layer)) {}

    /// Calls use(first_row, rows, cells) until it returns false.
    template <class Use>
    void for_each(Use use) const {
        std::vector<double> cells(std::size_t{std::min(rows_at_a_time, grid_.rows)} * grid_.cols);
        for (Index row = 0; row < grid_.rows; row += rows_at_a_time) {
            const Index rows = std::min(rows_at_a_time, grid_.rows - row);
            const std::span<double> strip(cells.data(), std::size_t{rows} * grid_.cols);
            source_(row, strip);
            if (!std::isnan(tag_))
                std::ranges::replace_if(
                    strip, [](double z) { return std::isnan(z); }, tag_);
            if (!use(row, rows, strip)) return;
        }
    }

  private:
    static constexpr Index rows_at_a_time = cloud_tile;  // whole tiles of either size
    const Grid& grid_;
    const RowSource& source_;
    double tag_;
};

/// Throws Error unless these are whole numbers of the type's range; GDAL would clamp and round in silence.
void check_values(std::span<const double> cells, const Layer& layer, const std::filesystem::path& path) {
    if (layer.type == CellType::float64) return;
    const bool bytes = layer.type == CellType::uint8;
    const double lowest = bytes ? 0 : std::numeric_limits<std::int32_t>::min();
    const double highest = bytes ? 255 : std::numeric_limits<std::int32_t>::max();
    for (const double value : cells) {
        if (value >= lowest && value <= highest && value == std::floor(value)) continue;
        throw Error(fmt::format("{} cannot hold {}: its cells are whole numbers from {} to {}", path.string(), value,
                                lowest, highest));
    }
}

void place(GDALDataset& dataset, const Placement& placement) {
    std::array<double, 6> transform{placement.west,        placement.cell_width, 0, placement.north, 0,
                                    -placement.cell_height};
    dataset.SetGeoTransform(transform.data());
    dataset.SetMetadataItem(GDALMD_AREA_OR_POINT, GDALMD_AOP_AREA);
    if (placement.crs_wkt.empty()) return;
    OGRSpatialReference crs;
    if (crs.importFromWkt(placement.crs_wkt.c_str()) != OGRERR_NONE) {
        throw Error("the coordinate system to be written cannot be understood");
    }
    crs.SetAxisMappingStrategy(OAMS_TRADITIONAL_GIS_ORDER);
    dataset.SetSpatialRef(&crs);
}

void describe(GDALRasterBand& band, const Layer& layer) {
    if (layer.type == CellType::float64 || layer.nodata) band.SetNoDataValue(nodata_tag(layer));
    if (!layer.description.empty()) band.SetDescription(layer.description.c_str());
    if (layer.colors.empty()) return;
    GDALColorTable table;
    const GDALColorEntry white{255, 255, 255, 255};
    for (int value = 0; value < 256; ++value) table.SetColorEntry(value, &white);
    for (const CellColor& color : layer.colors) {
        const GDALColorEntry entry{color.red, color.green, color.blue, 255};
        table.SetColorEntry(color.value, &entry);
    }
    band.SetColorTable(&table);
}

/// Of the cells with data.
struct CellStatistics {
    double origin = 0;  // without it the squares of high land lose their digits
    double least = std::numeric_limits<double>::infinity(), most = -least, sum = 0, squares = 0;
    std::size_t count = 0;

    void add(double value) {
        if (count == 0) origin = value;
        least = std::min(least, value);
        most = std::max(most, value);
        sum += value - origin;
        squares += (value - origin) * (value - origin);
        ++count;
    }
};

/// Least, largest, mean and standard deviation, which GDAL would else have to look for.
void tell_statistics(GDALRasterBand& band, const Strips& strips, const Layer& layer) {
    CellStatistics s;
    strips.for_each([&](Index, Index, std::span<const double> cells) {
        for (const double value : cells) {
            if (!std::isnan(value) && !(layer.nodata && value == *layer.nodata)) s.add(value);
        }
        return true;
    });
    if (s.count == 0) return;
    const double mean = s.sum / static_cast<double>(s.count);
    const double variance = s.squares / static_cast<double>(s.count) - mean * mean;
    band.SetStatistics(s.least, s.most, s.origin + mean, std::sqrt(std::max(variance, 0.0)));
}

/// GDAL's close cannot fail, so a full disk can leave a file that looks complete: every tile must lie inside it.
bool tiles_lie_inside(const std::filesystem::path& path, const Grid& grid, Layout layout) {
    const DatasetPtr dataset(GDALDataset::Open(path.c_str(), GDAL_OF_RASTER));
    if (!dataset) return false;
    const std::uintmax_t size = std::filesystem::file_size(path);
    GDALRasterBand& band = *dataset->GetRasterBand(1);
    const Index size_of_tile = layout == Layout::tiled ? tile : cloud_tile;
    for (Index y = 0; y * size_of_tile < grid.rows; ++y) {
        for (Index x = 0; x * size_of_tile < grid.cols; ++x) {
            const char* offset = band.GetMetadataItem(fmt::format("BLOCK_OFFSET_{}_{}", x, y).c_str(), "TIFF");
            const char* bytes = band.GetMetadataItem(fmt::format("BLOCK_SIZE_{}_{}", x, y).c_str(), "TIFF");
            if (offset == nullptr || bytes == nullptr) return false;
            if (std::stoull(offset) + std::stoull(bytes) > size) return false;
        }
    }
    return true;
}

CPLErr fill(GDALDataset& dataset, const std::filesystem::path& path, const Placement& placement, const Strips& strips,
            const Layer& layer) {
    place(dataset, placement);
    GDALRasterBand& band = *dataset.GetRasterBand(1);
    describe(band, layer);
    if (layer.colors.empty()) tell_statistics(band, strips, layer);
    CPLErr status = CE_None;
    strips.for_each([&](Index first_row, Index rows, std::span<double> cells) {
        check_values(cells, layer, path);
        const int cols = band.GetXSize(), height = static_cast<int>(rows);
        status = band.RasterIO(GF_Write, 0, static_cast<int>(first_row), cols, height, cells.data(), cols, height,
                               GDT_Float64, 0, 0, nullptr);
        return status == CE_None;
    });
    return status;
}

/// The driver for cloud-optimized files copies only, so those are made in memory first.
CPLErr write_cells(const std::filesystem::path& path, const Grid& grid, const Placement& placement,
                   const Strips& strips, const Layer& layer, GdalGuard& gdal) {
    const bool tiled = layer.layout == Layout::tiled;
    GDALDriver* driver = GetGDALDriverManager()->GetDriverByName(tiled ? "GTiff" : "MEM");
    const CPLStringList options = tiled ? creation_options(*driver, layer.type) : CPLStringList();
    DatasetPtr dataset(driver->Create(tiled ? path.c_str() : "", static_cast<int>(grid.cols),
                                      static_cast<int>(grid.rows), 1, gdal_type(layer.type), options.List()));
    if (!dataset) throw Error(fmt::format("{} cannot be created{}", path.string(), because(gdal)));
    const CPLErr status = fill(*dataset, path, placement, strips, layer);
    if (tiled) {
        dataset->FlushCache(false);
        return status;
    }
    GDALDriver* cloud = GetGDALDriverManager()->GetDriverByName("COG");
    if (cloud == nullptr) throw Error("this GDAL cannot write cloud-optimized GeoTIFFs: use GDAL 3.1 or newer");
    const DatasetPtr copy(cloud->CreateCopy(path.c_str(), dataset.get(), true, cloud_options(*cloud, layer.type).List(),
                                            nullptr, nullptr));
    return copy ? status : CE_Failure;
}

void write_file(const std::filesystem::path& path, const Grid& grid, const Placement& placement, const Strips& strips,
                const Layer& layer, GdalGuard& gdal) {
    const CPLErr status = write_cells(path, grid, placement, strips, layer, gdal);
    if (status != CE_None || gdal.failed() || !tiles_lie_inside(path, grid, layer.layout)) unwritten(path, gdal);
}

}  // namespace

void write_raster(const std::filesystem::path& path, const Grid& grid, const Placement& placement,
                  const RowSource& source, const Layer& layer) {
    GdalGuard gdal;
    try {
        write_file(path, grid, placement, Strips(grid, source, layer), layer, gdal);
    } catch (const Error&) {
        std::error_code ignored;
        if (std::filesystem::is_regular_file(path, ignored)) std::filesystem::remove(path, ignored);
        throw;
    }
}

void write_raster(const std::filesystem::path& path, const Grid& grid, const Placement& placement,
                  std::span<const double> values, const Layer& layer) {
    if (values.size() != grid.size()) {
        throw Error(fmt::format("{} would need {} values, not {}", path.string(), grid.size(), values.size()));
    }
    const RowSource rows = [&](Index first_row, std::span<double> cells) {
        std::ranges::copy(values.subspan(std::size_t{first_row} * grid.cols, cells.size()), cells.begin());
    };
    write_raster(path, grid, placement, rows, layer);
}

}  // namespace thalweg::io
