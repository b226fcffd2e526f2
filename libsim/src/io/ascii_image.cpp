// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/ascii_image.hpp"

#include <fmt/format.h>

#include <array>
#include <charconv>
#include <fstream>
#include <optional>
#include <string_view>

#include "io/text_file.hpp"
#include "thalweg/core/error.hpp"

namespace thalweg::io {
namespace {

bool is_space(char c) { return c == ' ' || (c >= '\t' && c <= '\r'); }

/// The words of the file one after the other, comments left out.
class Words {
  public:
    explicit Words(std::string_view text) : rest_(text) {}

    /// Empty at the end.
    std::string_view next() {
        for (;;) {
            while (!rest_.empty() && is_space(rest_.front())) rest_.remove_prefix(1);
            if (rest_.empty() || rest_.front() != '#') break;
            const std::size_t end = rest_.find_first_of("\r\n");
            rest_.remove_prefix(end == std::string_view::npos ? rest_.size() : end);
        }
        std::size_t length = 0;
        while (length < rest_.size() && !is_space(rest_[length]) && rest_[length] != '#') ++length;
        const std::string_view word = rest_.substr(0, length);
        rest_.remove_prefix(length);
        return word;
    }

    std::optional<std::uint32_t> next_number() {
        const std::string_view word = next();
        std::uint32_t number = 0;
        const auto [end, failure] = std::from_chars(word.data(), word.data() + word.size(), number);
        if (word.empty() || failure != std::errc() || end != word.data() + word.size()) return std::nullopt;
        return number;
    }

  private:
    std::string_view rest_;
};

}  // namespace

bool is_ascii_image(const std::filesystem::path& path) {
    std::array<char, 3> magic{};
    std::ifstream(path, std::ios::binary).read(magic.data(), magic.size());
    const bool next = is_space(magic[2]) || magic[2] == '#';
    return magic[0] == 'P' && (magic[1] == '2' || magic[1] == '3') && next;
}

Image read_ascii_image(const std::filesystem::path& path) {
    const std::string text = read_text(path);
    Words words(text);
    const std::uint64_t colours = words.next() == "P3" ? 3 : 1;
    const auto cols = words.next_number();
    const auto rows = words.next_number();
    const auto largest = words.next_number();
    if (!cols || !rows || !largest || *cols == 0 || *rows == 0 || *largest == 0 || *largest > 65535) {
        throw Error(
            fmt::format("{} is damaged: P{} must be followed by width, height and a largest value of 1 to 65535",
                        path.string(), colours == 3 ? 3 : 2));
    }
    const std::uint64_t cells = std::uint64_t{*cols} * *rows;
    const std::uint64_t wanted = cells * colours;
    // A value takes two characters, so a header that asks for too much is found out before memory is.
    std::uint64_t found = 0;
    Image image{.rows = *rows, .cols = *cols, .values = {}};
    if (cells < none && wanted <= text.size() / 2 + 1) image.values.assign(cells, 0.0);
    for (std::string_view word = words.next(); !word.empty(); word = words.next(), ++found) {
        std::uint32_t value = 0;
        const auto [end, failure] = std::from_chars(word.data(), word.data() + word.size(), value);
        if (failure != std::errc() || end != word.data() + word.size() || value > *largest) {
            throw Error(fmt::format("{} is damaged: its value number {} is '{}', not a whole number from 0 to {}",
                                    path.string(), found + 1, word.substr(0, 20), *largest));
        }
        if (found / colours < image.values.size()) image.values[found / colours] += value;
    }
    if (found != wanted) {
        throw Error(fmt::format("{} is damaged: it holds {} values, not the {} of {} x {} cells", path.string(), found,
                                wanted, *rows, *cols));
    }
    for (double& value : image.values) value /= static_cast<double>(colours);
    return image;
}

}  // namespace thalweg::io
