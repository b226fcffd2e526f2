// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/text_file.hpp"

#include <fmt/format.h>

#include <array>
#include <cerrno>
#include <cstdio>
#include <cstring>

#include "thalweg/core/error.hpp"

namespace thalweg::io {
namespace fs = std::filesystem;

void write_text(const fs::path& path, const std::string& text) {
    std::FILE* file = std::fopen(path.c_str(), "wb");
    if (file == nullptr) throw Error(fmt::format("{} cannot be created: {}", path.string(), std::strerror(errno)));
    errno = 0;
    bool whole = std::fwrite(text.data(), 1, text.size(), file) == text.size();
    whole = std::fflush(file) == 0 && whole;
    const std::string reason = std::strerror(errno);
    whole = std::fclose(file) == 0 && whole;
    if (whole) return;
    std::error_code ignored;
    if (fs::is_regular_file(path, ignored)) fs::remove(path, ignored);
    throw Error(fmt::format("{} could not be written whole: {}", path.string(), reason));
}

std::string read_text(const fs::path& path) {
    if (fs::is_directory(path)) throw Error(fmt::format("{} is a folder, not a file", path.string()));
    std::FILE* file = std::fopen(path.c_str(), "rb");
    if (file == nullptr) throw Error(fmt::format("{} cannot be opened: {}", path.string(), std::strerror(errno)));
    std::string text;
    std::array<char, 1 << 16> piece;
    while (const std::size_t count = std::fread(piece.data(), 1, piece.size(), file)) text.append(piece.data(), count);
    const bool whole = std::ferror(file) == 0;
    std::fclose(file);
    if (!whole) throw Error(fmt::format("{} could not be read to its end", path.string()));
    return text;
}

}  // namespace thalweg::io
