// SPDX-License-Identifier: GPL-3.0-or-later
#include "thalweg/grow/divides.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "grow/plane.hpp"

namespace thalweg::grow {
namespace {

using std::numbers::pi;

/// Horizontal gradient of the plane of a valley side; `quarter_turn` leads from its link into the interfluve.
Point plane_gradient(const ValleySide& side, double quarter_turn) {
    const Point away{std::cos(side.direction_rad), std::sin(side.direction_rad)};
    const Point upstream = side.junction == JunctionAt::lower_end ? away : -1.0 * away;
    const double across2 = side.sidewall_slope * side.sidewall_slope - side.gradient * side.gradient;
    return side.gradient * upstream + std::sqrt(std::max(0.0, across2)) * turned(away, quarter_turn);
}

}  // namespace

double gradient(const Flint& flint, Index magnitude) { return flint.p * std::pow(2.0 * magnitude - 1, flint.q); }

double junction_angle(double downstream_gradient, double inflow_gradient) {
    return std::acos(std::min(1.0, downstream_gradient / inflow_gradient));
}

double divide_direction(const ValleySide& first, const ValleySide& second) {
    const double sector = second.direction_rad - first.direction_rad;
    const Point difference = plane_gradient(first, pi / 2) - plane_gradient(second, -pi / 2);
    double beyond_first = std::atan2(difference.x, -difference.y) - first.direction_rad;
    beyond_first -= pi * std::floor(beyond_first / pi);  // of the line's two halves the first one counter-clockwise
    const bool between = norm(difference) > 0 && beyond_first > 0 && beyond_first < sector;
    if (!between) return first.direction_rad + sector / 2;
    return first.direction_rad + std::clamp(beyond_first, 0.1 * sector, 0.9 * sector);
}

}  // namespace thalweg::grow
