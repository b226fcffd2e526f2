// SPDX-License-Identifier: GPL-3.0-or-later
// Private: how rows of structs become columns.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "thalweg/core/index.hpp"
#include "thalweg/core/table.hpp"

namespace thalweg::study {

using Doubles = std::vector<double>;
using Wholes = std::vector<std::int64_t>;
using Texts = std::vector<std::string>;

/// -1 stands for "none", which a GeoPackage reader would take for four thousand million.
inline std::int64_t or_minus_one(Index value) { return value == none ? -1 : static_cast<std::int64_t>(value); }

/// `get` of each row: a column of numbers, whole numbers or text.
template <class Row, class Get>
auto column_of(const std::vector<Row>& rows, Get get) {
    std::vector<decltype(get(rows.front()))> values;
    values.reserve(rows.size());
    for (const Row& row : rows) values.push_back(get(row));
    return values;
}

/// The same of whole numbers of any kind.
template <class Row, class Get>
Wholes wholes_of(const std::vector<Row>& rows, Get get) {
    return column_of(rows, [&](const Row& row) { return static_cast<std::int64_t>(get(row)); });
}

}  // namespace thalweg::study
