// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include "io/png.hpp"
#include "io/text_file.hpp"
#include "thalweg/core/error.hpp"
#include "thalweg/io/raster_series.hpp"

namespace thalweg::io {

void write_png(const std::filesystem::path& path, Index rows, Index cols, std::span<const std::uint8_t> rgba) {
    const std::size_t needed = std::size_t{4} * rows * cols;
    if (rgba.size() != needed) {
        throw Error(fmt::format("{} would need {} bytes, not {}", path.string(), needed, rgba.size()));
    }
    write_text(path, png_of(rgba, cols, rows));
}

}  // namespace thalweg::io
