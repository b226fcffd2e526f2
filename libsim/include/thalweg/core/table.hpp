// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <string>
#include <variant>
#include <vector>

#include "thalweg/core/point.hpp"

namespace thalweg {

/// A named column; the unit is part of the name (`area_m2`). NaN is written as an empty field.
struct Column {
    std::string name;
    std::variant<std::vector<double>, std::vector<std::int64_t>, std::vector<std::string>> values;
};

enum class GeometryKind { no_geometry, point, line, polygon };

/// Named columns of equal length, with one geometry per row where `kind` asks for it: what statistics fill and `io`
/// writes as CSV or as a GeoPackage layer. Points (one vertex) and lines (two or more) are held by `geometry`, polygons
/// by `polygons`; whichever `kind` does not ask for is empty.
struct Table {
    std::string name;
    std::vector<Column> columns;
    GeometryKind kind = GeometryKind::no_geometry;
    std::vector<std::vector<Point>> geometry;
    std::vector<MultiPolygon> polygons = {};
    std::string style = {};  ///< how QGIS draws the layer (its QML), where a format can carry it
};

/// Number of rows. Throws Error if the columns (or the geometry) are of unequal length, or if there is geometry that
/// `kind` does not ask for.
std::size_t row_count(const Table& table);

}  // namespace thalweg
