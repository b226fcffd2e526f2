// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cmath>
#include <numbers>
#include <utility>
#include <vector>

#include "thalweg/core/point.hpp"
#include "thalweg/core/random.hpp"

namespace support {

using thalweg::Point;
using thalweg::Polygon;

inline Polygon rectangle(double width, double height) { return {{0, 0}, {width, 0}, {width, height}, {0, height}}; }

inline Polygon l_shape() { return {{0, 0}, {2, 0}, {2, 1}, {1, 1}, {1, 2}, {0, 2}}; }

/// Star-shaped about the origin: corners at increasing angles, at radii from 0.15 to 1. Concave, with acute corners.
inline Polygon random_star(int corners, std::uint64_t seed) {
    thalweg::Random random(seed, 77);
    Polygon star;
    for (int i = 0; i < corners; ++i) {
        const double angle = 2 * std::numbers::pi * (i + 0.8 * random.uniform()) / corners;
        const double radius = 0.15 + 0.85 * random.uniform();
        star.push_back({radius * std::cos(angle), radius * std::sin(angle)});
    }
    return star;
}

/// Corners on an ellipse at random angles: convex, with sides of very unequal length.
inline Polygon random_convex(int corners, std::uint64_t seed) {
    thalweg::Random random(seed, 78);
    Polygon convex;
    for (int i = 0; i < corners; ++i) {
        const double angle = 2 * std::numbers::pi * (i + 0.9 * random.uniform()) / corners;
        convex.push_back({3 * std::cos(angle), std::sin(angle)});
    }
    return convex;
}

/// A basin as polygonising a raster gives it: many short sides along rows and columns. Counter-clockwise.
inline Polygon staircase(int steps) {
    Polygon ring{{0, 0}};
    for (int i = 0; i < steps; ++i) {
        ring.push_back({i + 1.0, -static_cast<double>(i)});
        ring.push_back({i + 1.0, -static_cast<double>(i) - 1});
    }
    ring[0] = {0, 0};
    ring.push_back({static_cast<double>(steps) + 3, -static_cast<double>(steps)});
    ring.push_back({static_cast<double>(steps) + 3, 4});
    ring.push_back({0, 4});
    return ring;
}

inline std::vector<std::pair<const char*, Polygon>> many_outlines() {
    return {{"square", rectangle(1, 1)},        {"rectangle", rectangle(3, 1)},       {"L", l_shape()},
            {"strip", rectangle(100, 1)},       {"wedge", {{0, 0}, {10, 0}, {0, 1}}}, {"star", random_star(17, 1)},
            {"sharp star", random_star(60, 2)}, {"convex", random_convex(12, 3)},     {"stairs", staircase(20)}};
}

/// Even-odd rule, slowly.
inline bool is_inside(const Polygon& polygon, const Point& p) {
    bool inside = false;
    for (std::size_t i = 0; i < polygon.size(); ++i) {
        const Point& a = polygon[i];
        const Point& b = polygon[(i + 1) % polygon.size()];
        if ((a.y > p.y) == (b.y > p.y)) continue;
        if (a.x + (p.y - a.y) / (b.y - a.y) * (b.x - a.x) > p.x) inside = !inside;
    }
    return inside;
}

inline double distance(const Point& a, const Point& b) { return std::hypot(a.x - b.x, a.y - b.y); }

}  // namespace support
