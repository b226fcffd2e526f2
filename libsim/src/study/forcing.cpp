// SPDX-License-Identifier: GPL-3.0-or-later
#include "study/forcing.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "thalweg/core/error.hpp"
#include "thalweg/io/table_file.hpp"

namespace thalweg::study {
namespace {

/// A table with the lines its rows stand in, for messages.
struct HistoryFile {
    std::string name;
    Table table;
    std::vector<std::size_t> lines;
};

HistoryFile read_file(const std::filesystem::path& path) {
    HistoryFile file{.name = path.string(), .table = {}, .lines = {}};
    file.table = io::read_csv(path, file.lines);
    if (file.lines.empty()) throw Error(fmt::format("{} holds no row below its header", file.name));
    return file;
}

const Column* column_named(const HistoryFile& file, std::string_view name) {
    const auto found = std::ranges::find(file.table.columns, name, &Column::name);
    return found == file.table.columns.end() ? nullptr : &*found;
}

/// The first line whose field is not a finite number.
[[noreturn]] void refuse_fields(const HistoryFile& file, const Column& column) {
    std::size_t row = 0;
    std::string shown = "";
    if (const auto* texts = std::get_if<std::vector<std::string>>(&column.values)) {
        const auto is_number = [](const std::string& text) {
            char* end = nullptr;
            const double value = std::strtod(text.c_str(), &end);
            return !text.empty() && *end == '\0' && std::isfinite(value);
        };
        row = static_cast<std::size_t>(std::ranges::find_if_not(*texts, is_number) - texts->begin());
        shown = (*texts)[row];
    } else {
        const auto& numbers = std::get<std::vector<double>>(column.values);
        const auto finite = [](double value) { return std::isfinite(value); };
        row = static_cast<std::size_t>(std::ranges::find_if_not(numbers, finite) - numbers.begin());
        if (!std::isnan(numbers[row])) shown = fmt::format("{}", numbers[row]);
    }
    throw Error(fmt::format("{}, line {}: {} must be a finite number, not '{}'", file.name, file.lines[row],
                            column.name, shown));
}

std::vector<double> numbers_of(const HistoryFile& file, const Column& column) {
    const auto* numbers = std::get_if<std::vector<double>>(&column.values);
    const bool whole =
        numbers != nullptr && std::ranges::all_of(*numbers, [](double value) { return std::isfinite(value); });
    if (!whole) refuse_fields(file, column);
    return *numbers;
}

std::vector<double> times_of(const HistoryFile& file) {
    const Column* column = column_named(file, "time_yr");
    if (column == nullptr) throw Error(fmt::format("{} has no column time_yr", file.name));
    const std::vector<double> time = numbers_of(file, *column);
    for (std::size_t row = 1; row < time.size(); ++row) {
        if (time[row] < time[row - 1]) {
            throw Error(fmt::format("{}, line {}: time_yr goes back from {} to {}; sort the rows by time", file.name,
                                    file.lines[row], time[row - 1], time[row]));
        }
        if (row > 1 && time[row] == time[row - 2]) {
            throw Error(fmt::format("{}, line {}: a third row for the year {}; a jump takes two rows", file.name,
                                    file.lines[row], time[row]));
        }
    }
    return time;
}

void refuse_negative(const HistoryFile& file, const Column& column, const std::vector<double>& values) {
    const auto bad = std::ranges::find_if(values, [](double value) { return value < 0; });
    if (bad == values.end()) return;
    throw Error(fmt::format("{}, line {}: {} must be at least 0, not {}; subsidence is a falling base level", file.name,
                            file.lines[static_cast<std::size_t>(bad - values.begin())], column.name, *bad));
}

void read_uplift(const std::filesystem::path& path, Forcing& forcing) {
    const HistoryFile file = read_file(path);
    const Column* rate = column_named(file, "rate_m_per_yr");
    const Column* factor = column_named(file, "factor");
    if ((rate == nullptr) == (factor == nullptr)) {
        throw Error(fmt::format("{} needs one of the columns rate_m_per_yr and factor beside time_yr", file.name));
    }
    const Column& column = rate != nullptr ? *rate : *factor;
    forcing.uplift_factor = {times_of(file), numbers_of(file, column)};
    refuse_negative(file, column, forcing.uplift_factor.value);
    if (rate == nullptr) return;
    const double largest = std::ranges::max(forcing.uplift_factor.value);
    forcing.uplift_m_per_yr = largest;
    for (double& value : forcing.uplift_factor.value) value = largest > 0 ? value / largest : 1;
}

void read_base_level(const std::filesystem::path& path, Forcing& forcing) {
    const HistoryFile file = read_file(path);
    const Column* level = column_named(file, "elevation_m");
    if (level == nullptr) throw Error(fmt::format("{} has no column elevation_m", file.name));
    forcing.base_level_m = {times_of(file), numbers_of(file, *level)};
}

}  // namespace

Forcing read_forcing(const Experiment& e) {
    Forcing forcing;
    const bool any = e.uplift.history || e.base_level.history;
    if (any && e.time.solver == Solver::steady) {
        throw Error(
            "time.solver = \"steady\" knows no time, so uplift.history and base_level.history need \"implicit\"");
    }
    if (e.uplift.history) read_uplift(*e.uplift.history, forcing);
    if (e.base_level.history) read_base_level(*e.base_level.history, forcing);
    return forcing;
}

Experiment with_forced_rate(Experiment e, const Forcing& forcing) {
    if (forcing.uplift_m_per_yr) e.uplift.rate_m_per_yr = *forcing.uplift_m_per_yr;
    return e;
}

void drive_in_time(Domain& domain, const Experiment& e, const Forcing& forcing) {
    domain.setting.uplift_factor = forcing.uplift_factor;
    domain.setting.base_level_m = forcing.base_level_m;
    if (forcing.base_level_m.value.empty()) return;
    const double first = evolve::value_at(forcing.base_level_m, domain.start.time_yr);
    const auto& boundary = domain.setting.boundary;
    std::vector<double>& elevation = domain.start.elevation_m;
    const auto outlet = std::ranges::find(boundary, Boundary::base_level);
    if (outlet == boundary.end()) return;
    const double rise = first - elevation[static_cast<std::size_t>(outlet - boundary.begin())];
    for (std::size_t node = 0; node < elevation.size(); ++node) {
        const bool base = boundary[node] == Boundary::base_level && !std::isnan(elevation[node]);
        if (base) elevation[node] = first;
        if (!base && e.domain.initial == InitialSurface::noise) elevation[node] += rise;
    }
}

}  // namespace thalweg::study
