// SPDX-License-Identifier: GPL-3.0-or-later
#include "study/results.hpp"

#include <fmt/format.h>

#include "study/report_json.hpp"
#include "thalweg/core/error.hpp"

namespace thalweg::study {

ResultKind kind_of(const std::filesystem::path& path) {
    if (!std::filesystem::is_directory(path)) return ResultKind::file;
    if (std::filesystem::is_regular_file(path / "slope_area_nodes.csv")) return ResultKind::simulated;
    const bool summarized = std::filesystem::is_regular_file(path / "summary.json");
    if (summarized && read_json(path / "summary.json").contains("mass_balance")) {
        throw Error(fmt::format("'{}' is the folder of a simulation without its slope_area_nodes.csv: simulate anew",
                                path.string()));
    }
    if (std::filesystem::is_regular_file(path / "elevation.tif")) return ResultKind::grown;
    if (summarized) return ResultKind::analyzed;
    throw Error(fmt::format("'{}' is neither a DEM nor the folder of an analyze, simulate or grow run", path.string()));
}

Index grown_outlet(const std::filesystem::path& folder, const Raster& raster) {
    const Json summary = read_json(folder / "summary.json");
    const Json::json_pointer basin("/terrain/basins/0");
    if (summary.contains(basin)) {
        const Json& outlet = summary.at(basin);
        const Point place{outlet.at("outlet_x").get<double>(), outlet.at("outlet_y").get<double>()};
        if (cell_at(raster, place) != none) return nearest_cell_with_data(raster, place);
    }
    throw Error(fmt::format("'{}' does not say where the grown terrain's water leaves; grow it anew",
                            (folder / "summary.json").string()));
}

void refuse_dem_options(const std::filesystem::path& folder, const io::ReadOptions& read,
                        const MeasureOptions& measure) {
    const bool cells = read.nodata || read.band != 1 || read.window || read.sea_level_m || read.cell_m;
    const bool systems = !read.crs.empty() || !read.reproject.empty();
    const bool asked = cells || systems || measure.channel_area_m2 || measure.edge_basins == terrain::EdgeBasins::keep;
    if (!asked) return;
    throw Error(
        fmt::format("'{}' was measured before: --channel-area-m2, --keep-edge-basins, --crs, --nodata and what "
                    "else says how a DEM is read apply to DEMs; give the DEM, or analyze it anew",
                    folder.string()));
}

const std::vector<double>& numbers_of(const Table& table, const std::string& column) {
    for (const Column& c : table.columns) {
        if (c.name != column) continue;
        if (const auto* values = std::get_if<std::vector<double>>(&c.values)) return *values;
    }
    throw Error(fmt::format("table '{}' has no column of numbers '{}'", table.name, column));
}

}  // namespace thalweg::study
