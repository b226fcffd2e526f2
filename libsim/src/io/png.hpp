// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <span>
#include <string>

#include "thalweg/core/index.hpp"

namespace thalweg::io {

/// Contents of a PNG file: one grey value of 16 bits per pixel, row by row. Throws Error if GDAL cannot make it.
std::string png_of(std::span<const std::uint16_t> grey, Index width, Index height);

}  // namespace thalweg::io
