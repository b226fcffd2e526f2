// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <limits>
#include <optional>

#include "io/text_file.hpp"
#include "thalweg/core/error.hpp"
#include "thalweg/io/table_file.hpp"

namespace thalweg::io {
namespace {

void append_text(std::string& out, const std::string& text) {
    // RFC 4180: what holds a separator, a quote or a line break is quoted, quotes doubled.
    if (text.find_first_of(",\"\r\n") == std::string::npos) {
        out += text;
        return;
    }
    out += '"';
    for (const char c : text) {
        if (c == '"') out += '"';
        out += c;
    }
    out += '"';
}

template <class Number>
void append_number(std::string& out, Number value) {
    std::array<char, 32> digits;
    const auto end = std::to_chars(digits.data(), digits.data() + digits.size(), value).ptr;
    out.append(digits.data(), end);
}

void append_field(std::string& out, const std::string& value) { append_text(out, value); }
void append_field(std::string& out, std::int64_t value) { append_number(out, value); }
void append_field(std::string& out, double value) {
    if (!std::isnan(value)) append_number(out, value);
}

std::string to_text(const Table& table) {
    const std::size_t rows = row_count(table);
    std::string out;
    for (std::size_t i = 0; i < table.columns.size(); ++i) {
        if (i > 0) out += ',';
        append_text(out, table.columns[i].name);
    }
    out += '\n';
    for (std::size_t row = 0; row < rows; ++row) {
        for (std::size_t i = 0; i < table.columns.size(); ++i) {
            if (i > 0) out += ',';
            std::visit([&](const auto& values) { append_field(out, values[row]); }, table.columns[i].values);
        }
        out += '\n';
    }
    return out;
}

struct Record {
    std::vector<std::string> fields;
    std::size_t line;  ///< where it begins, from 1
};

/// The records of a comma-separated text, one after the other.
class Reader {
  public:
    Reader(std::string text, std::string name) : text_(std::move(text)), name_(std::move(name)) {
        if (text_.starts_with("\xEF\xBB\xBF")) at_ = 3;  // the byte order mark that spreadsheets write
    }

    bool next(Record& record) {
        if (at_ >= text_.size()) return false;
        record = {.fields = {}, .line = line_};
        bool more = true;
        while (more) {
            record.fields.push_back(at_ < text_.size() && text_[at_] == '"' ? quoted(record.line) : plain());
            more = at_ < text_.size() && text_[at_] == ',';
            if (more) ++at_;
        }
        end_of_line();
        return true;
    }

  private:
    std::string plain() {
        const std::size_t end = std::min(text_.find_first_of(",\r\n", at_), text_.size());
        std::string field = text_.substr(at_, end - at_);
        at_ = end;
        return field;
    }

    std::string quoted(std::size_t begin_line) {
        std::string field;
        for (++at_; at_ < text_.size(); ++at_) {
            if (text_[at_] == '"' && (at_ + 1 == text_.size() || text_[at_ + 1] != '"')) {
                ++at_;
                return field;
            }
            if (text_[at_] == '"') ++at_;
            line_ += text_[at_] == '\n';
            field += text_[at_];
        }
        throw Error(fmt::format("{}, line {}: a quoted field is not closed", name_, begin_line));
    }

    void end_of_line() {
        if (at_ >= text_.size()) return;
        if (text_[at_] == '\r') ++at_;
        if (at_ < text_.size() && text_[at_] != '\n') {
            throw Error(
                fmt::format("{}, line {}: text follows a quoted field or a lone carriage return", name_, line_));
        }
        ++at_;
        ++line_;
    }

    std::string text_;
    std::string name_;
    std::size_t at_ = 0;
    std::size_t line_ = 1;
};

std::optional<double> as_number(const std::string& field) {
    if (field.empty()) return std::numeric_limits<double>::quiet_NaN();
    double value = 0;
    const auto [end, status] = std::from_chars(field.data(), field.data() + field.size(), value);
    if (status != std::errc{} || end != field.data() + field.size()) return std::nullopt;
    return value;
}

Column to_column(std::string name, std::vector<std::string> fields) {
    std::vector<double> numbers;
    for (const std::string& field : fields) {
        const std::optional<double> number = as_number(field);
        if (!number) return {std::move(name), std::move(fields)};
        numbers.push_back(*number);
    }
    return {std::move(name), std::move(numbers)};
}

bool is_blank(const Record& record) { return record.fields.size() == 1 && record.fields[0].empty(); }

}  // namespace

void write_csv(const std::filesystem::path& path, const Table& table) { write_text(path, to_text(table)); }

Table read_csv(const std::filesystem::path& path) {
    std::vector<std::size_t> lines;
    return read_csv(path, lines);
}

Table read_csv(const std::filesystem::path& path, std::vector<std::size_t>& lines) {
    lines.clear();
    Reader reader(read_text(path), path.string());
    Record header;
    if (!reader.next(header) || is_blank(header)) throw Error(fmt::format("{} has no header line", path.string()));
    std::vector<std::vector<std::string>> columns(header.fields.size());
    for (Record record; reader.next(record);) {
        if (is_blank(record) && header.fields.size() > 1) continue;
        if (record.fields.size() != columns.size()) {
            throw Error(fmt::format("{}, line {}: {} fields, but the header has {}", path.string(), record.line,
                                    record.fields.size(), columns.size()));
        }
        for (std::size_t i = 0; i < columns.size(); ++i) columns[i].push_back(std::move(record.fields[i]));
        lines.push_back(record.line);
    }
    Table table{.name = path.stem().string(), .columns = {}, .kind = GeometryKind::no_geometry, .geometry = {}};
    for (std::size_t i = 0; i < columns.size(); ++i) {
        table.columns.push_back(to_column(header.fields[i], std::move(columns[i])));
    }
    return table;
}

}  // namespace thalweg::io
