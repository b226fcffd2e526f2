// SPDX-License-Identifier: GPL-3.0-or-later
#include "thalweg/core/table.hpp"

#include <fmt/format.h>

#include "thalweg/core/error.hpp"

namespace thalweg {

std::size_t row_count(const Table& table) {
    const bool has_geometry = table.kind != GeometryKind::no_geometry;
    const bool has_polygons = table.kind == GeometryKind::polygon;
    std::size_t rows = has_polygons ? table.polygons.size() : table.geometry.size();
    if ((!has_polygons && !table.polygons.empty()) || ((has_polygons || !has_geometry) && !table.geometry.empty())) {
        throw Error(fmt::format("table '{}' has geometry of another kind than it says", table.name));
    }
    bool first = !has_geometry;
    for (const Column& column : table.columns) {
        const std::size_t size = std::visit([](const auto& values) { return values.size(); }, column.values);
        if (first) rows = size;
        first = false;
        if (size != rows) {
            throw Error(fmt::format("table '{}': column '{}' has {} rows where {} were needed", table.name, column.name,
                                    size, rows));
        }
    }
    return rows;
}

}  // namespace thalweg
