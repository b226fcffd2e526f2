// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string_view>
#include <vector>

namespace thalweg::evolve {

/// A quantity that changes in time: straight lines between its rows, constant before the first and after the last. Two
/// rows of one time are a jump; at that time the later row counts. Empty: does not change, and has no value.
struct History {
    std::vector<double> time_yr;  ///< never falling, at most two alike in a row
    std::vector<double> value;
};

/// Throws Error, naming what the history is of, unless it is as described above and all its numbers are finite.
void check_history(const History&, std::string_view what);

/// The value at a time; the history must not be empty.
double value_at(const History&, double time_yr);

/// Mean over a span of time (end > start), exact to rounding: the integral of the straight lines over its length. Where
/// the history is constant it is that constant to the last bit.
double mean_between(const History&, double start_yr, double end_yr);

/// The time from which on the value is constant; −infinity where it always is.
double last_change_yr(const History&);

}  // namespace thalweg::evolve
