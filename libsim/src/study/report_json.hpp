// SPDX-License-Identifier: GPL-3.0-or-later
// Private: how results become JSON. Keys carry their units; what cannot be computed is null.
#pragma once

#include <nlohmann/json.hpp>

#include <cmath>
#include <optional>
#include <string>
#include <vector>

#include "thalweg/study/analyze.hpp"
#include "thalweg/study/measure.hpp"
#include "thalweg/study/tables.hpp"
#include "thalweg/study/tree_statistics.hpp"

namespace thalweg::study {

using Json = nlohmann::ordered_json;

/// The number, or null where it is not finite.
inline Json number(double value) { return std::isfinite(value) ? Json(value) : Json(nullptr); }
Json numbers(std::span<const double> values);

/// `[low, high]`, or null where the estimate has none.
Json interval(const Estimate&);

const char* routing_name(Routing);
const char* edge_basins_name(terrain::EdgeBasins);

/// What a terrain was, before anything is measured on it.
struct TerrainInput {
    std::string file;  ///< "" where it was not a file
    std::string sha256;
    std::string crs;
    bool geographic = false;
    Index rows = 0, cols = 0;   ///< 0 on a TIN
    double dx_m = 0, dy_m = 0;  ///< mean size of a cell; 0 on a TIN
    Index valid_cells = 0, nodata_cells = 0;
    double area_m2 = 0;
    std::optional<Origin> origin;
};

/// Title, licence and citation of a DEM.
Json origin_json(const Origin&);

/// The keys of an `analyze` summary. `conditioning` may be null (a mesh needs none). Reasons for nulls go to `notes`.
Json terrain_json(const TerrainInput&, const Statistics&, const PositionOf&, Json conditioning,
                  std::vector<std::string>& notes);

Json conditioning_json(const ConditioningReport&, Conditioning method);

/// The keys from `channels` to `junctions` of a grown tree, and `flint_links`.
Json tree_json(const TreeStatistics&, std::vector<std::string>& notes);

/// The keys `tokunaga`, `hack`, `links`, `flint`, `junctions`, `area_exceedance` and `width_function`.
Json network_json(const NetworkStatistics&, std::vector<std::string>& notes);

Json chi_json(const ChiStatistics&, std::vector<std::string>& notes);

/// Adds "key: reason" to the notes if anything in the JSON is null.
void explain_null(const char* key, const Json&, const char* reason, std::vector<std::string>& notes);

/// The text of a file: two spaces of indentation and a final newline.
std::string text_of(const Json&);

/// Reads a file of ours; throws Error where it is missing or no JSON.
Json read_json(const std::filesystem::path&);

}  // namespace thalweg::study
