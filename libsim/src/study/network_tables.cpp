// SPDX-License-Identifier: GPL-3.0-or-later
// What is counted on networks, one tidy table each.
#include <array>
#include <utility>

#include "study/columns.hpp"
#include "thalweg/io/table_file.hpp"
#include "thalweg/study/tables.hpp"

namespace thalweg::study {

Table with_coordinates(Table points) {
    Doubles x, y;
    for (const auto& place : points.geometry) {
        x.push_back(place.front().x);
        y.push_back(place.front().y);
    }
    points.columns.push_back({"x", x});
    points.columns.push_back({"y", y});
    points.geometry.clear();
    points.kind = GeometryKind::no_geometry;
    return points;
}

Table strahler_table(const std::vector<channel::OrderStatistics>& orders) {
    return {.name = "strahler",
            .columns = {{"order", wholes_of(orders, [](const auto& o) { return o.order; })},
                        {"streams", wholes_of(orders, [](const auto& o) { return o.streams; })},
                        {"mean_length_m", column_of(orders, [](const auto& o) { return o.mean_length_m; })},
                        {"mean_area_m2", column_of(orders, [](const auto& o) { return o.mean_area_m2; })},
                        {"mean_slope", column_of(orders, [](const auto& o) { return o.mean_slope; })},
                        {"mean_drop_m", column_of(orders, [](const auto& o) { return o.mean_drop_m; })}},
            .kind = GeometryKind::no_geometry,
            .geometry = {}};
}

Table horton_table(const channel::HortonRatios& horton) {
    const std::vector<channel::HortonRatio> rows{horton.bifurcation, horton.length, horton.area, horton.slope};
    return {.name = "horton",
            .columns = {{"ratio", Texts{"RB", "RL", "RA", "RS"}},
                        {"regression", column_of(rows, [](const auto& r) { return r.regression; })},
                        {"regression_se", column_of(rows, [](const auto& r) { return r.regression_se; })},
                        {"regression_low95", column_of(rows, [](const auto& r) { return r.regression_ci95[0]; })},
                        {"regression_high95", column_of(rows, [](const auto& r) { return r.regression_ci95[1]; })},
                        {"mean_ratio", column_of(rows, [](const auto& r) { return r.mean_ratio; })}},
            .kind = GeometryKind::no_geometry,
            .geometry = {}};
}

Table tokunaga_table(const channel::Tokunaga& t) {
    Wholes order, above;
    Doubles per_stream, pooled;
    for (std::size_t i = 0; i < t.per_stream.size(); ++i) {
        for (std::size_t k = 0; k < t.per_stream[i].size(); ++k) {
            order.push_back(static_cast<std::int64_t>(i + 1));
            above.push_back(static_cast<std::int64_t>(k + 1));
            per_stream.push_back(t.per_stream[i][k]);
            pooled.push_back(t.pooled.at(k));
        }
    }
    return {.name = "tokunaga",
            .columns = {{"order", order}, {"k", above}, {"T", per_stream}, {"T_k", pooled}},
            .kind = GeometryKind::no_geometry,
            .geometry = {}};
}

Table width_function_table(const channel::WidthFunction& width) {
    return {.name = "width_function",
            .columns = {{"distance_m", width.distance_m}, {"links", width.links}},
            .kind = GeometryKind::no_geometry,
            .geometry = {}};
}

void write_statistics(const Statistics& s, const PositionOf& position, const std::filesystem::path& folder) {
    for (const Table& table :
         {hypsometry_table(s.hypsometry), basin_values(s, position), basin_hypsometry_table(s),
          strahler_table(s.strahler), horton_table(s.horton), tokunaga_table(s.network_laws.tokunaga),
          width_function_table(s.network_laws.width), link_values(s), with_coordinates(junctions_table(s, position)),
          with_coordinates(knickpoints_table(s, position)), chi_table(s, position),
          slope_area_table("slope_area", s.slope_area.bins),
          slope_area_table("slope_area_cells", s.slope_area_nodes.law.bins),
          slope_area_table("slope_area_links", s.slope_area_links.law.bins)}) {
        io::write_csv(folder / (table.name + ".csv"), table);
    }
}

}  // namespace thalweg::study
