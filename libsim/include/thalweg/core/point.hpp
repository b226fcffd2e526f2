// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

namespace thalweg {

/// Position in the plane (m), or in the raster's own coordinates where a function says so.
struct Point {
    double x = 0;
    double y = 0;

    friend bool operator==(const Point&, const Point&) = default;
};

/// Closed ring without a repeated last vertex; counter-clockwise unless a function says otherwise.
using Polygon = std::vector<Point>;

}  // namespace thalweg
