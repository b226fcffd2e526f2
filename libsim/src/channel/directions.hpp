// SPDX-License-Identifier: GPL-3.0-or-later
// Private: angles between directions on the plane.
#pragma once

#include <cmath>
#include <numbers>

#include "thalweg/core/point.hpp"

namespace thalweg::channel {

/// Counterclockwise from one direction to another, in [0, 2π).
inline double turn(const Point& from, const Point& to) {
    const double angle = std::atan2(from.x * to.y - from.y * to.x, from.x * to.x + from.y * to.y);
    return angle < 0 ? angle + 2 * std::numbers::pi : angle;
}

}  // namespace thalweg::channel
