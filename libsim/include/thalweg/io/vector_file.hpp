// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "thalweg/core/point.hpp"

namespace thalweg::io {

struct VectorOptions {
    std::vector<std::string> layers = {};  ///< the first of these that the file has is read alone; else all layers
    std::string crs_wkt = {};              ///< to be transformed to; empty: the file's own coordinates
};

/// Shapes of a vector file, in the order of its layers and features. Heights and attributes are left out.
struct VectorShapes {
    std::vector<Point> points;
    std::vector<std::vector<Point>> lines;
    std::vector<PolygonPart> polygons;  ///< outer rings counter-clockwise, holes clockwise
    std::string crs_wkt;                ///< of these coordinates; empty: not known
    bool geographic = false;            ///< they are degrees
    double unit_m = 1;                  ///< else: metres per unit
};

/// Reads points, lines and polygons (also collections of them) from any vector format that GDAL reads: GeoPackage,
/// GeoJSON, Shapefile, … A layer whose coordinate system is known and differs from the wanted one is transformed; one
/// without is taken as it is. Throws Error, one sentence, for what is no vector file, shapes that have no place in the
/// wanted system, coordinates that are not finite, and layers that lie in different systems when none is wanted.
VectorShapes read_vectors(const std::filesystem::path&, const VectorOptions& = {});

}  // namespace thalweg::io
