// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

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

/// Layer `basins`: one polygon per basin of the statistics; `outlines[i]` belongs to basin i.
Table basins_table(const Statistics&, const PositionOf&, std::vector<MultiPolygon> outlines);

/// Layer `knickpoints`: points with their prominence (m) and the steepness above and below.
Table knickpoints_table(const Statistics&, const PositionOf&);

/// All layers of network.gpkg.
std::vector<Table> network_layers(const Statistics&, const PositionOf&, std::vector<MultiPolygon> outlines);

/// links.csv: the layer's columns without its lines.
Table link_values(const Statistics&);

/// chi.csv: one row per channel node; `basin` is the number of the basin its river leaves by, −1 outside of all.
Table chi_table(const Statistics&, const PositionOf&);

/// hypsometry.csv, slope_area.csv (the bins) and slope_area_points.csv.
Table hypsometry_table(const terrain::Hypsometry&);
Table slope_area_table(const std::vector<channel::SlopeAreaBin>&);
Table slope_area_points_table(const std::vector<channel::SlopeAreaPoint>&);

}  // namespace thalweg::study
