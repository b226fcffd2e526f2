// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/ascii_grid.hpp"

#include <cpl_string.h>
#include <cpl_vsi.h>
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <cstdint>
#include <string_view>
#include <vector>

#include "thalweg/core/error.hpp"

namespace thalweg::io {
namespace {

bool is_digit(char c) { return c >= '0' && c <= '9'; }
bool is_blank(char c) { return c == ' ' || (c >= '\t' && c <= '\r'); }

/// The words of a file, one after the other.
class Words {
  public:
    explicit Words(const char* path) : file_(VSIFOpenL(path, "rb")), chunk_(std::size_t{1} << 20) {}
    ~Words() {
        if (file_ != nullptr) VSIFCloseL(file_);
    }
    Words(const Words&) = delete;
    Words& operator=(const Words&) = delete;

    /// False at the end of the file. The word lives until the next one.
    bool next(std::string_view& word) {
        while (at_ == end_ || is_blank(chunk_[at_])) {
            if (at_ == end_ && !refill()) return false;
            if (is_blank(chunk_[at_])) ++at_;
        }
        const std::size_t begin = at_;
        while (at_ < end_ && !is_blank(chunk_[at_])) ++at_;
        if (at_ < end_) {
            word = {chunk_.data() + begin, at_ - begin};
            return true;
        }
        broken_.assign(chunk_.data() + begin, at_ - begin);  // the rest stands in the next chunk
        while (at_ < end_ || refill()) {
            if (is_blank(chunk_[at_])) break;
            broken_ += chunk_[at_++];
        }
        word = broken_;
        return true;
    }

  private:
    bool refill() {
        at_ = 0;
        end_ = file_ == nullptr ? 0 : VSIFReadL(chunk_.data(), 1, chunk_.size(), file_);
        return end_ > 0;
    }

    VSILFILE* file_;
    std::vector<char> chunk_;
    std::size_t at_ = 0, end_ = 0;
    std::string broken_;
};

/// Digits with a sign, a decimal point or comma, and an exponent, as GDAL takes them.
bool is_plain_number(std::string_view word) {
    std::size_t at = 0, digits = 0;
    const auto sign = [&] { at += at < word.size() && (word[at] == '-' || word[at] == '+'); };
    const auto skip_digits = [&] {
        const std::size_t from = at;
        while (at < word.size() && is_digit(word[at])) ++at;
        return at - from;
    };
    sign();
    digits += skip_digits();
    if (at < word.size() && (word[at] == '.' || word[at] == ',')) {
        ++at;
        digits += skip_digits();
    }
    if (digits == 0) return false;
    if (at < word.size() && (word[at] == 'e' || word[at] == 'E')) {
        ++at;
        sign();
        if (skip_digits() == 0) return false;
    }
    return at == word.size();
}

/// How C libraries write what is not finite.
bool is_not_finite(std::string_view word) {
    static constexpr std::array<std::string_view, 8> forms{"nan",    "inf",     "infinity", "1.#inf",
                                                           "1.#ind", "1.#qnan", "1.#snan",  "1.#nan"};
    if (!word.empty() && (word.front() == '-' || word.front() == '+')) word.remove_prefix(1);
    return std::ranges::any_of(forms, [&](std::string_view form) {
        return std::ranges::equal(word, form, {}, [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
    });
}

bool is_number(std::string_view word) { return is_plain_number(word) || is_not_finite(word); }

bool is_ascii_grid(GDALDataset& dataset) {
    GDALDriver* const driver = dataset.GetDriver();
    return driver != nullptr &&
           (EQUAL(driver->GetDescription(), "AAIGrid") || EQUAL(driver->GetDescription(), "GRASSASCIIGrid"));
}

/// The first word after the header, whose keys are words with a number each. False where there is none.
bool skip_header(Words& words, std::string_view& word) {
    while (words.next(word)) {
        if (std::isalpha(static_cast<unsigned char>(word.front())) == 0 || is_not_finite(word)) return true;
        if (!words.next(word)) return false;
    }
    return false;
}

}  // namespace

void check_ascii_grid(GDALDataset& dataset, const std::string& name) {
    if (!is_ascii_grid(dataset)) return;
    const auto cols = static_cast<std::uint64_t>(dataset.GetRasterXSize());
    const std::uint64_t cells = cols * static_cast<std::uint64_t>(dataset.GetRasterYSize());
    const bool is_of_whole_numbers = GDALDataTypeIsInteger(dataset.GetRasterBand(1)->GetRasterDataType()) != 0;
    Words words(dataset.GetDescription());
    std::string_view word;
    std::uint64_t count = 0;
    for (bool more = skip_header(words, word); more; more = words.next(word)) {
        if (is_of_whole_numbers && is_not_finite(word)) {
            throw Error(fmt::format(
                "'{}' in row {} and column {} of {} would be taken for 0, for its numbers are whole: put the "
                "header's NODATA_value there",
                word.substr(0, 40), count / cols + 1, count % cols + 1, name));
        }
        if (!is_number(word)) {
            throw Error(
                fmt::format("'{}' in row {} and column {} of {} is no number: put a height there, or the "
                            "header's NODATA_value",
                            word.substr(0, 40), count / cols + 1, count % cols + 1, name));
        }
        ++count;
    }
    if (count == cells) return;
    throw Error(
        fmt::format("{} holds {} numbers where its header speaks of {} rows of {}: it is cut off, or the header "
                    "is another file's",
                    name, count, cells / cols, cols));
}

}  // namespace thalweg::io
