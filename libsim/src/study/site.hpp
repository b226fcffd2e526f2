// SPDX-License-Identifier: GPL-3.0-or-later
// Private: a domain's mesh and rim, before anything drives it.
#pragma once

#include <optional>

#include "study/drivers.hpp"
#include "study/outlets.hpp"

namespace thalweg::study {

struct Site {
    Domain domain;
    Nodes nodes;
    Rim rim;
    double base_level_m = 0;
};

/// Positions of a grid's cells on a plane that has its zero at the grid's south-west corner.
std::vector<Point> plane_positions(const Grid&);

/// Open where a cell lies at the grid's edge or beside one outside; interior elsewhere.
std::vector<Boundary> open_rim(const Grid&, const std::vector<std::uint8_t>& inside);

/// A TIN in a polygon of the plane. `crs_wkt` and `unit_m` are of the map that the plane belongs to.
Site tin_site(const Experiment&, const PolygonPart& outline_m, const std::string& crs_wkt, double unit_m);

/// The cells of a raster whose centres lie in a polygon of the plane.
Site raster_site(const Experiment&, const PolygonPart& outline_m, const std::string& crs_wkt, double unit_m);

/// A raster of whole cells in a rectangle at the plane's zero.
Site rectangle_raster_site(const Experiment&);

}  // namespace thalweg::study
