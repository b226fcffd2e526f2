// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <span>
#include <string>

#include "thalweg/core/index.hpp"

namespace thalweg::io {

/// Contents of a PNG file of red, green and blue bytes per pixel, row by row from the upper left. Throws Error if it
/// cannot be made.
std::string png_picture(std::span<const std::uint8_t> rgb, Index width, Index height);

}  // namespace thalweg::io
