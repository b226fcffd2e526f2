// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/raster_open.hpp"

#include <cpl_string.h>
#include <cpl_vsi.h>
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <cerrno>
#include <cstring>

#include "io/ascii_grid.hpp"
#include "thalweg/core/error.hpp"

namespace thalweg::io {
namespace {

namespace fs = std::filesystem;

std::string lower_extension(const std::string& name) {
    std::string extension = fs::path(name).extension().string();
    std::transform(extension.begin(), extension.end(), extension.begin(),
                   [](unsigned char c) { return std::tolower(c); });
    return extension;
}

DatasetPtr try_open(const std::string& name) {
    return DatasetPtr(GDALDataset::Open(name.c_str(), GDAL_OF_RASTER | GDAL_OF_READONLY | GDAL_OF_VERBOSE_ERROR));
}

bool has_place(GDALDataset& dataset) {
    std::array<double, 6> transform{};
    return dataset.GetGeoTransform(transform.data()) == CE_None;
}

/// Members that are a raster's companions although GDAL would open some of them alone.
bool is_companion(const std::string& member) {
    static constexpr std::array<const char*, 6> companions{".ovr", ".msk", ".xml", ".hdr", ".prj", ".txt"};
    const std::string extension = lower_extension(member);
    return member.ends_with('/') || member.starts_with("__MACOSX") ||
           std::find(companions.begin(), companions.end(), extension) != companions.end();
}

std::vector<std::string> zip_rasters(const fs::path& path) {
    const std::string archive = fmt::format("/vsizip/{{{}}}", fs::absolute(path).string());
    const CPLStringList members(VSIReadDirRecursive(archive.c_str()));
    std::vector<std::string> placed, unplaced;
    for (int i = 0; i < members.size(); ++i) {
        if (is_companion(members[i])) continue;
        const std::string name = archive + "/" + members[i];
        const DatasetPtr dataset = try_open(name);
        if (dataset) (has_place(*dataset) ? placed : unplaced).push_back(name);
    }
    return placed.empty() ? unplaced : placed;
}

DatasetPtr open_zip(const fs::path& path, GdalGuard& gdal) {
    std::vector<std::string> found = zip_rasters(path);
    if (found.empty()) throw Error(fmt::format("{} is no zip archive that holds a raster", path.string()));
    if (found.size() > 1) {
        for (std::string& name : found) name = name.substr(name.find('}') + 2);
        throw Error(fmt::format("{} holds several rasters ({}): extract the one to be read", path.string(),
                                fmt::join(found, ", ")));
    }
    gdal.forget();
    return try_open(found.front());
}

void check_file(const fs::path& path) {
    std::error_code failure;
    const fs::file_status status = fs::status(path, failure);
    if (status.type() == fs::file_type::not_found) throw Error(fmt::format("{} does not exist", path.string()));
    if (failure) throw Error(fmt::format("{} cannot be read: {}", path.string(), failure.message()));
    if (fs::is_directory(status)) return;
    if (!fs::is_regular_file(status)) {
        throw Error(fmt::format("{} is a device or pipe; a raster file was expected", path.string()));
    }
    if (fs::file_size(path, failure) == 0) throw Error(fmt::format("{} is empty", path.string()));
    VSILFILE* const file = VSIFOpenL(path.c_str(), "rb");
    if (file == nullptr) throw Error(fmt::format("{} cannot be opened: {}", path.string(), std::strerror(errno)));
    VSIFCloseL(file);
}

/// What GDAL said, without the name of the file, which begins the sentence already.
std::string reason_without(const std::string& name, const GdalGuard& gdal) {
    std::string reason = gdal.reason();
    for (std::size_t at = reason.find(name + ":"); at != std::string::npos; at = reason.find(name + ":")) {
        reason.erase(at, reason.find_first_not_of(": ", at + name.size()) - at);
    }
    return reason;
}

[[noreturn]] void refuse(const fs::path& path, const GdalGuard& gdal) {
    const std::string name = path.string();
    const std::string reason = reason_without(name, gdal);
    if (fs::is_directory(path)) throw Error(fmt::format("{} is a folder, not a raster file", name));
    if (reason.find("ENVI header") != std::string::npos) {
        throw Error(fmt::format("{} is only the header of a raster: give the data file beside it", name));
    }
    if (lower_extension(name) == ".hgt") {
        throw Error(
            fmt::format("{} has {} bytes; an .hgt tile has 2884802 (3 arc-seconds) or 25934402 (1 arc-second) "
                        "and a name such as N42E001.hgt",
                        name, fs::file_size(path)));
    }
    if (reason.empty() || reason.find("not recognized") != std::string::npos) {
        throw Error(fmt::format("{} is no raster that can be read (GeoTIFF, .hgt, .asc, .bil, …)", name));
    }
    throw Error(fmt::format("{} is damaged or cut off ({})", name, reason));
}

/// GDAL reads what a raw file (.bil and the like) lacks at its end as zeros, in silence.
void check_raw_size(const fs::path& path, GDALDataset& dataset) {
    GDALDataset::RawBinaryLayout layout;
    const char* compression = dataset.GetMetadataItem("file_compression", "ENVI");
    if ((compression != nullptr && EQUAL(compression, "1")) || !dataset.GetRawBinaryLayout(layout)) return;
    VSIStatBufL status;
    if (VSIStatL(layout.osRawFilename.c_str(), &status) != 0) return;
    const std::int64_t last = static_cast<std::int64_t>(layout.nImageOffset) +
                              (dataset.GetRasterYSize() - 1) * static_cast<std::int64_t>(layout.nLineOffset) +
                              (dataset.GetRasterXSize() - 1) * static_cast<std::int64_t>(layout.nPixelOffset) +
                              GDALGetDataTypeSizeBytes(layout.eDataType);
    if (static_cast<std::int64_t>(status.st_size) >= last) return;
    throw Error(fmt::format("{} is cut off: it has {} bytes, and its header speaks of {}", path.string(),
                            static_cast<std::int64_t>(status.st_size), last));
}

/// A container such as netCDF holds its rasters as subdatasets and has no band of its own.
DatasetPtr open_subdataset(const fs::path& path, GDALDataset& container) {
    const CPLStringList entries(CSLDuplicate(container.GetMetadata("SUBDATASETS")), TRUE);
    std::vector<std::string> names;
    for (int i = 0; i < entries.size(); i += 2) names.emplace_back(CPLParseNameValue(entries[i], nullptr));
    if (names.size() == 1) return try_open(names.front());
    if (names.empty()) throw Error(fmt::format("{} holds no raster band", path.string()));
    throw Error(fmt::format("{} holds several rasters ({}): extract the one to be read with gdal_translate",
                            path.string(), fmt::join(names, ", ")));
}

}  // namespace

DatasetPtr open_raster(const fs::path& path, GdalGuard& gdal) {
    const bool is_virtual = path.string().starts_with("/vsi");
    if (!is_virtual) check_file(path);
    const bool is_zip = !is_virtual && lower_extension(path.string()) == ".zip" && !fs::is_directory(path);
    DatasetPtr dataset = is_zip ? open_zip(path, gdal) : try_open(path.string());
    if (!dataset) refuse(path, gdal);
    if (dataset->GetRasterCount() == 0) dataset = open_subdataset(path, *dataset);
    if (!dataset || dataset->GetRasterCount() == 0) refuse(path, gdal);
    gdal.forget();
    check_raw_size(path, *dataset);
    check_ascii_grid(*dataset, path.string());
    return dataset;
}

}  // namespace thalweg::io
