// SPDX-License-Identifier: GPL-3.0-or-later
// Private: between the coordinates of a map and a plane in metres.
#pragma once

#include <string>
#include <vector>

#include "thalweg/io/geodesy.hpp"
#include "thalweg/study/domain.hpp"

namespace thalweg::study {

/// The plane in metres on which a piece of a map lies, and the way back to its coordinates.
struct MapPlane {
    io::LocalPlane local = {};  ///< used where the map is in degrees
    bool geographic = false;
    double unit_m = 1;    ///< of the map, where it is projected
    std::string crs_wkt;  ///< of the plane's metres, or of the map's units where those are no degrees

    std::vector<Point> from_map(std::vector<Point>) const;
    std::vector<Point> to_map(std::vector<Point>) const;
};

MapPlane plane_of(const Raster&);

/// What a vector file without a coordinate system is taken for, though it cannot be: degrees.
bool beyond_the_globe(const std::vector<Point>&);

/// A closed ring in degrees whose longitudes jump where the map is cut (±180° or 0°/360°), without the jump: every
/// corner is within half a turn of the one before, so that the ring has a middle. What lies within it needs no such
/// care: the way to the plane takes longitudes a turn apart for the same. Throws Error, beginning with `what`, if the
/// ring goes around a pole.
Polygon ring_without_jumps(const std::string& what, Polygon lon_lat_deg);

/// Plane for coordinates of a system whose unit is `unit_m` metres, or degrees, about their middle.
MapPlane plane_about(const std::vector<Point>& places, bool geographic, double unit_m, const std::string& crs_wkt);

/// The catchment's outline in metres on its plane, without the staircase of its cells.
Polygon plane_outline(const Catchment&, const MapPlane&, double tolerance_m);

}  // namespace thalweg::study
