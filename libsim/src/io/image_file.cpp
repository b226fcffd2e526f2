// SPDX-License-Identifier: GPL-3.0-or-later
#include "thalweg/io/image_file.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <new>

#include "io/ascii_image.hpp"
#include "io/gdal_guard.hpp"
#include "io/raster_open.hpp"
#include "thalweg/core/error.hpp"

namespace thalweg::io {
namespace {

constexpr double no_value = std::numeric_limits<double>::quiet_NaN();

/// Reads the bands of one dataset, and says whose they are when they cannot be read.
class BandReader {
  public:
    BandReader(GDALDataset& dataset, std::string name, const GdalGuard& gdal)
        : dataset_(dataset), name_(std::move(name)), gdal_(gdal) {}

    std::vector<double> read(GDALRasterBand& band) const {
        const int rows = dataset_.GetRasterYSize(), cols = dataset_.GetRasterXSize();
        std::vector<double> values(static_cast<std::size_t>(rows) * static_cast<std::size_t>(cols));
        const CPLErr status =
            band.RasterIO(GF_Read, 0, 0, cols, rows, values.data(), cols, rows, GDT_Float64, 0, 0, nullptr);
        if (status == CE_None && !gdal_.failed()) return values;
        throw Error(fmt::format("{} is damaged or cut off ({})", name_, gdal_.reason()));
    }

    /// Mean of the colours of a palette, by its entries.
    std::vector<double> read_palette(GDALRasterBand& band, const GDALColorTable& table) const {
        std::vector<double> values = read(band);
        for (double& value : values) {
            const GDALColorEntry* colour = table.GetColorEntry(static_cast<int>(value));
            value = colour == nullptr || colour->c4 == 0 ? no_value : (colour->c1 + colour->c2 + colour->c3) / 3.0;
        }
        return values;
    }

    std::vector<double> read_colours() const {
        std::vector<double> values = read(*dataset_.GetRasterBand(1));
        for (const int number : {2, 3}) {
            const std::vector<double> colour = read(*dataset_.GetRasterBand(number));
            for (std::size_t i = 0; i < values.size(); ++i) values[i] += colour[i];
        }
        for (double& value : values) value /= 3;
        return values;
    }

    std::vector<double> read_scaled(GDALRasterBand& band) const {
        std::vector<double> values = read(band);
        const double scale = band.GetScale(), offset = band.GetOffset();
        if (scale == 1 && offset == 0) return values;
        for (double& value : values) value = value * scale + offset;
        return values;
    }

    void blank_masked(GDALRasterBand& mask, std::vector<double>& values) const {
        const std::vector<double> valid = read(mask);
        for (std::size_t i = 0; i < values.size(); ++i) {
            if (valid[i] == 0) values[i] = no_value;
        }
    }

  private:
    GDALDataset& dataset_;
    std::string name_;
    const GdalGuard& gdal_;
};

bool is_coloured(GDALDataset& dataset) {
    if (dataset.GetRasterCount() < 3) return false;
    for (int number = 1; number <= 3; ++number) {
        const GDALColorInterp meaning = dataset.GetRasterBand(number)->GetColorInterpretation();
        if (meaning != GCI_RedBand && meaning != GCI_GreenBand && meaning != GCI_BlueBand) return false;
    }
    return true;
}

void read_values(GDALDataset& dataset, const std::string& name, const GdalGuard& gdal, Image& image) {
    const BandReader reader(dataset, name, gdal);
    GDALRasterBand& band = *dataset.GetRasterBand(1);
    if (GDALDataTypeIsComplex(band.GetRasterDataType())) {
        throw Error(fmt::format("the first band of {} holds complex numbers", name));
    }
    const GDALColorTable* palette = band.GetColorTable();
    image.values = is_coloured(dataset) ? reader.read_colours()
                   : palette != nullptr ? reader.read_palette(band, *palette)
                                        : reader.read_scaled(band);
    GDALRasterBand& last = *dataset.GetRasterBand(dataset.GetRasterCount());
    if ((band.GetMaskFlags() & GMF_ALL_VALID) == 0) reader.blank_masked(*band.GetMaskBand(), image.values);
    if (last.GetColorInterpretation() == GCI_AlphaBand) reader.blank_masked(last, image.values);
    for (double& value : image.values) {
        if (!std::isfinite(value)) value = no_value;
    }
}

void turn_over(Image& image) {
    const std::ptrdiff_t cols = image.cols;
    for (std::ptrdiff_t top = 0, bottom = image.rows - 1; top < bottom; ++top, --bottom) {
        const auto first = image.values.begin() + top * cols;
        std::swap_ranges(first, first + cols, image.values.begin() + bottom * cols);
    }
}

void place(GDALDataset& dataset, const std::string& name, Image& image) {
    std::array<double, 6> t{};
    const bool given = dataset.GetGeoTransform(t.data()) == CE_None;
    const bool identity = t[0] == 0 && t[1] == 1 && t[2] == 0 && t[3] == 0 && t[4] == 0 && std::abs(t[5]) == 1;
    if (!given || identity) return;
    const double drift = std::max(std::abs(t[2] * image.rows / t[1]), std::abs(t[4] * image.cols / t[5]));
    if (!(drift < 0.01) || !(t[1] > 0) || !std::isfinite(t[0] + t[3])) {
        throw Error(fmt::format("{} is rotated or mirrored: turn it north-up with gdalwarp first", name));
    }
    image.placed = true;
    Placement& p = image.placement;
    p = {.west = t[0],
         .north = t[5] > 0 ? t[3] + image.rows * t[5] : t[3],
         .cell_width = t[1],
         .cell_height = std::abs(t[5]),
         .crs_wkt = "",
         .geographic = false};
    if (t[5] > 0) turn_over(image);
    const OGRSpatialReference* stated = dataset.GetSpatialRef();
    if (stated == nullptr || stated->IsEmpty() || stated->IsLocal()) return;
    OGRSpatialReference crs(*stated);
    if (crs.IsCompound()) crs.StripVertical();
    char* text = nullptr;
    crs.exportToWkt(&text);
    p.crs_wkt = text == nullptr ? "" : text;
    CPLFree(text);
    p.geographic = crs.IsGeographic();
}

Image read_with_gdal(const std::filesystem::path& path) {
    GdalGuard gdal;
    const DatasetPtr dataset = open_raster(path, gdal);
    const std::string name = path.string();
    const auto rows = static_cast<std::uint64_t>(dataset->GetRasterYSize());
    const auto cols = static_cast<std::uint64_t>(dataset->GetRasterXSize());
    const auto memory = static_cast<std::uint64_t>(CPLGetUsablePhysicalRAM());
    if (rows * cols >= none || (memory > 0 && rows * cols > memory / sizeof(double) / 2)) {
        throw Error(fmt::format("the {} x {} cells of {} are too many: coarsen it with gdal_translate -outsize", rows,
                                cols, name));
    }
    Image image{.rows = static_cast<Index>(rows), .cols = static_cast<Index>(cols), .values = {}};
    read_values(*dataset, name, gdal, image);
    place(*dataset, name, image);
    return image;
}

}  // namespace

double Image::largest() const {
    double found = no_value;
    for (const double value : values) {
        if (!(value <= found) && !std::isnan(value)) found = value;
    }
    return found;
}

Image read_image(const std::filesystem::path& path) {
    try {
        std::error_code failure;
        const bool plain = std::filesystem::is_regular_file(path, failure);
        return plain && is_ascii_image(path) ? read_ascii_image(path) : read_with_gdal(path);
    } catch (const std::bad_alloc&) {
        throw Error(fmt::format("{} does not fit the memory of this machine: coarsen it with gdal_translate -outsize",
                                path.string()));
    }
}

double bilinear(const Image& image, double column, double row) {
    const double hair = 1e-6;  // of a cell: rounding of coordinates
    if (!(column >= -hair && column <= image.cols + hair && row >= -hair && row <= image.rows + hair)) return no_value;
    const auto value = [&](double r, double c) {
        return image.values[static_cast<std::size_t>(r) * image.cols + static_cast<std::size_t>(c)];
    };
    const double last_col = image.cols - 1.0, last_row = image.rows - 1.0;
    const double own = value(std::clamp(std::floor(row), 0.0, last_row), std::clamp(std::floor(column), 0.0, last_col));
    if (std::isnan(own)) return no_value;
    const double x = std::clamp(column - 0.5, 0.0, last_col), y = std::clamp(row - 0.5, 0.0, last_row);
    const double left = std::min(std::floor(x), std::max(0.0, last_col - 1));
    const double top = std::min(std::floor(y), std::max(0.0, last_row - 1));
    double sum = 0, weights = 0;
    for (const double r : {top, std::min(top + 1, last_row)}) {
        for (const double c : {left, std::min(left + 1, last_col)}) {
            const double weight = std::max(0.0, 1 - std::abs(x - c)) * std::max(0.0, 1 - std::abs(y - r));
            if (weight == 0 || std::isnan(value(r, c))) continue;
            sum += weight * value(r, c);
            weights += weight;
        }
    }
    return weights > 0 ? sum / weights : own;
}

}  // namespace thalweg::io
