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

/// A surface that hangs together: within `outer`, without what lies in `holes` (clockwise). Rings may touch at corners.
struct PolygonPart {
    Polygon outer;
    std::vector<Polygon> holes;
};

/// A surface in any number of parts, which share no more than corners: what OGC calls a MultiPolygon.
using MultiPolygon = std::vector<PolygonPart>;

}  // namespace thalweg
