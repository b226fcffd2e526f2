// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <string>

namespace thalweg::io {

/// Writes the whole text, or throws Error and leaves no file.
void write_text(const std::filesystem::path&, const std::string&);

/// Reads the whole file. Throws Error.
std::string read_text(const std::filesystem::path&);

}  // namespace thalweg::io
