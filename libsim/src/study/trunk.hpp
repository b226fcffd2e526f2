// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <vector>

#include "thalweg/grow/grow.hpp"

namespace thalweg::study {

/// A line's means over so many places to either side, fewer near the ends, which stay where they are.
std::vector<Point> smoothed(const std::vector<Point>& line, std::size_t half_window);

/// Lets the trunk follow a river from the outlet, its first place, as far and as closely as a network can grow from it:
/// bends that lie less than C/2 off the straight line are left out, for so wide are the valleys beside it. Where the
/// smoothed river is no use, the river itself is taken. Returns the
/// share of the river's places below its source; 0, and nothing changed, if there is no such trunk.
double follow_river(const std::vector<Point>& river, std::vector<Point> smooth, const grow::Dials&, grow::Basin&);

/// Lets the trunk run straight from the outlet to the uppermost of a river's places that is seen from there with a
/// clear distance of 1 % of the trunk's length to either side. Returns the share of the river's places below; 0, and
/// nothing changed, if there is none.
double see_river(const std::vector<Point>& river, const grow::Dials&, grow::Basin&);

}  // namespace thalweg::study
