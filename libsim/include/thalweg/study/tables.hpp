// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <functional>
#include <vector>

#include "thalweg/core/table.hpp"
#include "thalweg/study/measure.hpp"

namespace thalweg::study {

/// Position of a node in the coordinates of the output.
using PositionOf = std::function<Point(Index)>;

/// Centres of a raster's cells; positions of a mesh's nodes.
PositionOf positions(const Raster&);

/// Layers `links` (lines along the flow), `junctions` (points; outlets and sources too) of a measured network.
Table links_table(const Statistics&, const PositionOf&);
Table junctions_table(const Statistics&, const PositionOf&);

/// basins.csv: one row per basin of the statistics.
Table basin_values(const Statistics&, const PositionOf&);

/// Layer `basins`: the same with one polygon each; `outlines[i]` belongs to basin i.
Table basins_table(const Statistics&, const PositionOf&, std::vector<MultiPolygon> outlines);

/// Layer `knickpoints`: points with their prominence (m) and the steepness above and below.
Table knickpoints_table(const Statistics&, const PositionOf&);

/// All layers of network.gpkg.
std::vector<Table> network_layers(const Statistics&, const PositionOf&, std::vector<MultiPolygon> outlines);

/// links.csv: the layer's columns without its lines.
Table link_values(const Statistics&);

/// junctions.csv and knickpoints.csv: the layers' columns with the place as columns `x` and `y`.
Table with_coordinates(Table points);

/// basin_hypsometry.csv: each basin's curve, one row per height.
Table basin_hypsometry_table(const Statistics&);

/// strahler.csv, horton.csv, tokunaga.csv and width_function.csv.
Table strahler_table(const std::vector<channel::OrderStatistics>&);
Table horton_table(const channel::HortonRatios&);
Table tokunaga_table(const channel::Tokunaga&);
Table width_function_table(const channel::WidthFunction&);

/// chi.csv: one row per channel node; `basin` is the number of the basin its river leaves by, −1 outside of all.
Table chi_table(const Statistics&, const PositionOf&);

/// Writes every table of the statistics as a CSV of its name.
void write_statistics(const Statistics&, const PositionOf&, const std::filesystem::path& folder);

/// hypsometry.csv; slope_area.csv, slope_area_cells.csv and slope_area_links.csv (bins); slope_area_points.csv.
Table hypsometry_table(const terrain::Hypsometry&);
Table slope_area_table(const char* name, const std::vector<channel::SlopeAreaBin>&);
Table slope_area_points_table(const std::vector<channel::SlopeAreaPoint>&);

}  // namespace thalweg::study
