// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <vector>

#include "thalweg/core/raster.hpp"

namespace thalweg::io {

/// Grid of cells of dlon by dlat degrees whose northern edge lies at `north_deg`: exact cell areas and geodesic distances
/// between cell centres on the ellipsoid with equatorial radius a (m) and flattening f (GeographicLib; WGS 84 default).
/// Throws Error beyond the poles, or for cells wider than the earth.
Grid geographic_grid(Index rows, Index cols, double north_deg, double dlon_deg, double dlat_deg,
                     double equatorial_radius_m = 6378137.0, double flattening = 1 / 298.257223563);

/// A plane for a piece of a geographic raster: Lambert's azimuthal equal-area projection about a centre, on WGS 84.
struct LocalPlane {
    double longitude_deg;
    double latitude_deg;
    std::string crs_wkt() const;
};
std::vector<Point> to_plane(const LocalPlane&, const std::vector<Point>& lon_lat_deg);
std::vector<Point> from_plane(const LocalPlane&, const std::vector<Point>& metres);

/// Coordinates of one system in another, easting or longitude first in both. Throws Error where a system cannot be
/// understood, or points have no place in the other.
std::vector<Point> reproject(const std::string& from_wkt, const std::string& to_wkt, const std::vector<Point>&);

/// Area (m²) of a ring of longitudes and latitudes on the WGS 84 ellipsoid, edges being geodesics.
double geodesic_area(const Polygon& lon_lat_deg);

}  // namespace thalweg::io
