// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>

#include "thalweg/io/image_file.hpp"

namespace thalweg::io {

/// Whether the file begins like an ASCII PGM (P2) or PPM (P3).
bool is_ascii_image(const std::filesystem::path&);

/// Reads one. Throws Error where it does not hold exactly the values that its header speaks of.
Image read_ascii_image(const std::filesystem::path&);

}  // namespace thalweg::io
