// SPDX-License-Identifier: GPL-3.0-or-later
#include "thalweg/evolve/history.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "thalweg/core/error.hpp"

namespace thalweg::evolve {
namespace {

/// First row later than a time.
std::size_t row_after(const History& history, double time_yr) {
    const auto& times = history.time_yr;
    return static_cast<std::size_t>(std::upper_bound(times.begin(), times.end(), time_yr) - times.begin());
}

/// Between row − 1 and row, whose times differ.
double between(const History& h, std::size_t row, double time_yr) {
    const double share = (time_yr - h.time_yr[row - 1]) / (h.time_yr[row] - h.time_yr[row - 1]);
    return h.value[row - 1] + share * (h.value[row] - h.value[row - 1]);
}

}  // namespace

void check_history(const History& history, std::string_view what) {
    if (history.time_yr.size() != history.value.size()) {
        throw Error(fmt::format("a history of {} needs as many values as times, not {} and {}", what,
                                history.value.size(), history.time_yr.size()));
    }
    for (std::size_t row = 0; row < history.value.size(); ++row) {
        const double time = history.time_yr[row];
        if (!std::isfinite(time) || !std::isfinite(history.value[row])) {
            throw Error(fmt::format("the history of {} holds a number that is not finite in row {}", what, row + 1));
        }
        if (row > 0 && time < history.time_yr[row - 1]) {
            throw Error(fmt::format("the history of {} goes back in time, to {} yr in row {}", what, time, row + 1));
        }
        if (row > 1 && time == history.time_yr[row - 2]) {
            throw Error(fmt::format("the history of {} has three rows for the year {}: a jump takes two", what, time));
        }
    }
}

double value_at(const History& history, double time_yr) {
    const std::size_t row = row_after(history, time_yr);
    if (row == 0) return history.value.front();
    if (row == history.value.size()) return history.value.back();
    return between(history, row, time_yr);
}

double mean_between(const History& history, double start_yr, double end_yr) {
    const double reference = value_at(history, start_yr);
    double integral = 0;  // of the value above the reference
    double time = start_yr, above = 0;
    for (std::size_t row = row_after(history, start_yr); row < history.value.size(); ++row) {
        if (history.time_yr[row] >= end_yr) break;
        const double next = history.value[row] - reference;
        integral += (history.time_yr[row] - time) * 0.5 * (above + next);
        time = history.time_yr[row];
        above = next;
    }
    // The value just before the end: a jump at the very end belongs to the next span.
    const auto& times = history.time_yr;
    const auto row = static_cast<std::size_t>(std::lower_bound(times.begin(), times.end(), end_yr) - times.begin());
    double last = history.value.back();
    if (row == 0) last = history.value.front();
    if (row > 0 && row < times.size()) last = between(history, row, end_yr);
    integral += (end_yr - time) * 0.5 * (above + (last - reference));
    return reference + integral / (end_yr - start_yr);
}

double last_change_yr(const History& history) {
    for (std::size_t row = history.value.size(); row-- > 1;) {
        if (history.value[row] != history.value[row - 1]) return history.time_yr[row];
    }
    return -std::numeric_limits<double>::infinity();
}

}  // namespace thalweg::evolve
