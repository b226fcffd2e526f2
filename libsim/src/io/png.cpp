// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/png.hpp"

#include <cpl_vsi.h>
#include <fmt/format.h>

#include "io/gdal_guard.hpp"
#include "thalweg/core/error.hpp"
#include "thalweg/io/picture_file.hpp"

namespace thalweg::io {
namespace {

/// A file in memory that is gone at the end; GDAL writes pictures to files only.
class MemoryFile {
  public:
    explicit MemoryFile(const void* unique) : name_(fmt::format("/vsimem/thalweg_{}.png", unique)) {}
    ~MemoryFile() { VSIUnlink(name_.c_str()); }
    MemoryFile(const MemoryFile&) = delete;
    MemoryFile& operator=(const MemoryFile&) = delete;

    const char* name() const { return name_.c_str(); }
    std::string contents() const {
        vsi_l_offset size = 0;
        const GByte* bytes = VSIGetMemFileBuffer(name_.c_str(), &size, false);
        return bytes == nullptr ? std::string() : std::string(reinterpret_cast<const char*>(bytes), size);
    }

  private:
    std::string name_;
};

/// Bands follow each other within a pixel.
std::string png_of_bands(const void* pixels, GDALDataType type, int bands, Index width, Index height) {
    GdalGuard gdal;
    GDALDriverManager& drivers = *GetGDALDriverManager();
    GDALDriver* png = drivers.GetDriverByName("PNG");
    const int cols = static_cast<int>(width), rows = static_cast<int>(height), bytes = GDALGetDataTypeSizeBytes(type);
    const DatasetPtr picture(drivers.GetDriverByName("MEM")->Create("", cols, rows, bands, type, nullptr));
    const MemoryFile file(pixels);
    if (png != nullptr && picture) {
        const CPLErr status =
            picture->RasterIO(GF_Write, 0, 0, cols, rows, const_cast<void*>(pixels), cols, rows, type, bands, nullptr,
                              GSpacing{bytes} * bands, GSpacing{bytes} * bands * cols, bytes, nullptr);
        if (status == CE_None) DatasetPtr(png->CreateCopy(file.name(), picture.get(), true, nullptr, nullptr, nullptr));
    }
    std::string contents = file.contents();
    if (contents.empty() || gdal.failed()) {
        throw Error(fmt::format("a PNG picture of {} x {} pixels cannot be made{}", width, height, because(gdal)));
    }
    return contents;
}

}  // namespace

std::string png_of(std::span<const std::uint16_t> grey, Index width, Index height) {
    return png_of_bands(grey.data(), GDT_UInt16, 1, width, height);
}

std::string png_of(std::span<const std::uint8_t> rgb, Index width, Index height) {
    const std::size_t bands = rgb.size() / (std::size_t{width} * height);
    return png_of_bands(rgb.data(), GDT_Byte, static_cast<int>(bands), width, height);
}

std::string png_picture(std::span<const std::uint8_t> rgb, Index width, Index height) {
    return png_of(rgb, width, height);
}

}  // namespace thalweg::io
