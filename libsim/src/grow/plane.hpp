// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cmath>

#include "thalweg/core/point.hpp"

namespace thalweg::grow {

// Points as vectors.
inline Point operator+(const Point& a, const Point& b) { return {a.x + b.x, a.y + b.y}; }
inline Point operator-(const Point& a, const Point& b) { return {a.x - b.x, a.y - b.y}; }
inline Point operator*(double factor, const Point& a) { return {factor * a.x, factor * a.y}; }
inline double dot(const Point& a, const Point& b) { return a.x * b.x + a.y * b.y; }
inline double cross(const Point& a, const Point& b) { return a.x * b.y - a.y * b.x; }
inline double norm(const Point& a) { return std::sqrt(dot(a, a)); }

inline Point nearest_on_segment(const Point& a, const Point& b, const Point& p) {
    const double at = dot(p - a, b - a) / dot(b - a, b - a);
    return at <= 0 ? a : at >= 1 ? b : a + at * (b - a);
}

/// The vector turned counter-clockwise.
inline Point turned(const Point& a, double angle_rad) {
    const double c = std::cos(angle_rad);
    const double s = std::sin(angle_rad);
    return {c * a.x - s * a.y, s * a.x + c * a.y};
}

}  // namespace thalweg::grow
