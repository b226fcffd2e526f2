// SPDX-License-Identifier: GPL-3.0-or-later
// One row per basin.
#include "study/columns.hpp"
#include "study/layer_styles.hpp"
#include "thalweg/study/tables.hpp"

namespace thalweg::study {
namespace {

using Columns = std::vector<Column>;
using Row = BasinStatistics;

void add(Columns& columns, Columns more) {
    for (Column& column : more) columns.push_back(std::move(column));
}

Columns place_columns(const std::vector<Row>& rows, const PositionOf& position) {
    Wholes id;
    for (std::size_t b = 0; b < rows.size(); ++b) id.push_back(static_cast<std::int64_t>(b));
    return {{"id", id},
            {"outlet_x", column_of(rows, [&](const Row& r) { return position(r.basin.outlet).x; })},
            {"outlet_y", column_of(rows, [&](const Row& r) { return position(r.basin.outlet).y; })},
            {"area_m2", column_of(rows, [](const Row& r) { return r.basin.area_m2; })},
            {"complete", wholes_of(rows, [](const Row& r) { return r.basin.complete; })}};
}

Columns shape_columns(const std::vector<Row>& rows) {
    return {{"length_m", column_of(rows, [](const Row& r) { return r.length_m; })},
            {"perimeter_m", column_of(rows, [](const Row& r) { return r.perimeter_m; })},
            {"form_factor", column_of(rows, [](const Row& r) { return r.shape.form_factor; })},
            {"circularity", column_of(rows, [](const Row& r) { return r.shape.circularity; })},
            {"elongation", column_of(rows, [](const Row& r) { return r.shape.elongation; })},
            {"asymmetry_percent", column_of(rows, [](const Row& r) { return r.asymmetry_percent; })},
            {"relief_m", column_of(rows, [](const Row& r) { return r.relief_m; })},
            {"relief_ratio", column_of(rows, [](const Row& r) { return r.shape.relief_ratio; })},
            {"ruggedness", column_of(rows, [](const Row& r) { return r.shape.ruggedness; })}};
}

Columns hypsometry_columns(const std::vector<Row>& rows) {
    return {{"elevation_min_m", column_of(rows, [](const Row& r) { return r.hypsometry.minimum_m; })},
            {"elevation_max_m", column_of(rows, [](const Row& r) { return r.hypsometry.maximum_m; })},
            {"elevation_mean_m", column_of(rows, [](const Row& r) { return r.hypsometry.mean_m; })},
            {"hypsometric_integral", column_of(rows, [](const Row& r) { return r.hypsometry.integral; })},
            {"hypsometric_skewness", column_of(rows, [](const Row& r) { return r.hypsometry.skewness; })},
            {"hypsometric_kurtosis", column_of(rows, [](const Row& r) { return r.hypsometry.kurtosis; })},
            {"density_skewness", column_of(rows, [](const Row& r) { return r.hypsometry.density_skewness; })},
            {"density_kurtosis", column_of(rows, [](const Row& r) { return r.hypsometry.density_kurtosis; })}};
}

Columns channel_columns(const std::vector<Row>& rows) {
    return {{"channel_length_m", column_of(rows, [](const Row& r) { return r.channel_length_m; })},
            {"drainage_density_per_m", column_of(rows, [](const Row& r) { return r.drainage_density_per_m; })},
            {"sources", wholes_of(rows, [](const Row& r) { return r.sources; })},
            {"max_strahler", wholes_of(rows, [](const Row& r) { return r.max_strahler; })},
            {"max_shreve", wholes_of(rows, [](const Row& r) { return r.max_shreve; })}};
}

Columns steepness_columns(const std::vector<Row>& rows) {
    return {{"theta", column_of(rows, [](const Row& r) { return r.slope_area.theta.value; })},
            {"theta_se", column_of(rows, [](const Row& r) { return r.slope_area.theta.standard_error; })},
            {"ks", column_of(rows, [](const Row& r) { return r.slope_area.ks.value; })},
            {"ks_se", column_of(rows, [](const Row& r) { return r.slope_area.ks.standard_error; })},
            {"ksn_median", column_of(rows, [](const Row& r) { return r.ksn_quartiles[1]; })},
            {"ksn_lower_quartile", column_of(rows, [](const Row& r) { return r.ksn_quartiles[0]; })},
            {"ksn_upper_quartile", column_of(rows, [](const Row& r) { return r.ksn_quartiles[2]; })}};
}

}  // namespace

Table basin_values(const Statistics& s, const PositionOf& position) {
    Table table{.name = "basins",
                .columns = place_columns(s.basins, position),
                .kind = GeometryKind::no_geometry,
                .geometry = {}};
    for (auto* part : {&shape_columns, &hypsometry_columns, &channel_columns, &steepness_columns}) {
        add(table.columns, (*part)(s.basins));
    }
    return table;
}

Table basins_table(const Statistics& s, const PositionOf& position, std::vector<MultiPolygon> outlines) {
    Table table = basin_values(s, position);
    table.kind = GeometryKind::polygon;
    table.polygons = std::move(outlines);
    table.style = basins_style();
    return table;
}

Table basin_hypsometry_table(const Statistics& s) {
    Wholes basin;
    Doubles height, area;
    for (std::size_t b = 0; b < s.basins.size(); ++b) {
        const terrain::Hypsometry& h = s.basins[b].hypsometry;
        basin.insert(basin.end(), h.relative_height.size(), static_cast<std::int64_t>(b));
        height.insert(height.end(), h.relative_height.begin(), h.relative_height.end());
        area.insert(area.end(), h.relative_area.begin(), h.relative_area.end());
    }
    return {.name = "basin_hypsometry",
            .columns = {{"basin", basin}, {"relative_height", height}, {"relative_area", area}},
            .kind = GeometryKind::no_geometry,
            .geometry = {}};
}

}  // namespace thalweg::study
