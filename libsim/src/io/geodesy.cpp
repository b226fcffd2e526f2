// SPDX-License-Identifier: GPL-3.0-or-later
#include "thalweg/io/geodesy.hpp"

#include <fmt/format.h>
#include <ogr_spatialref.h>

#include <GeographicLib/Geodesic.hpp>
#include <GeographicLib/PolygonArea.hpp>
#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <numbers>

#include "io/gdal_guard.hpp"
#include "thalweg/core/error.hpp"

namespace thalweg::io {
namespace {

using GeographicLib::Geodesic;

constexpr double radians = std::numbers::pi / 180;

/// Area (m²) per radian of longitude between two latitudes. With s = sin(latitude) it is the integral of
/// b²/(1 − e²s²)² over s; five Gauss points give it to rounding (2e-13 for the whole earth at once), because the
/// poles of the integrand lie at s = 1/e (12 for the earth), and the difference of the sines is formed without
/// cancellation, which the closed form in authalic latitudes is not.
double zone_area(double south_deg, double north_deg, double a, double f) {
    constexpr std::array<double, 5> node{-0.9061798459386640, -0.5384693101056831, 0, 0.5384693101056831,
                                         0.9061798459386640};
    constexpr std::array<double, 5> weight{0.2369268850561891, 0.4786286704993665, 0.5688888888888889,
                                           0.4786286704993665, 0.2369268850561891};
    const double middle = (north_deg + south_deg) / 2 * radians;
    const double half = (north_deg - south_deg) / 2 * radians;
    const double sine_middle = std::sin(middle) * std::cos(half);
    const double sine_half = std::cos(middle) * std::sin(half);
    const double e2 = f * (2 - f);
    const double b = a * (1 - f);
    double sum = 0;
    for (std::size_t i = 0; i < node.size(); ++i) {
        const double s = sine_middle + node[i] * sine_half;
        const double root = 1 - e2 * s * s;
        sum += weight[i] / (root * root);
    }
    return b * b * sine_half * sum;
}

void check_extent(Index rows, Index cols, double north, double dlon, double dlat) {
    if (rows == 0 || cols == 0) throw Error(fmt::format("a grid needs at least one cell, not {} x {}", rows, cols));
    if (std::uint64_t{rows} * cols >= none) {
        throw Error(fmt::format("{} x {} cells are more than 32-bit numbers can count", rows, cols));
    }
    if (!(dlon > 0) || !(dlat > 0) || !std::isfinite(dlon) || !std::isfinite(dlat) || !std::isfinite(north)) {
        throw Error(fmt::format("cells need a positive size, not {} x {} degrees", dlon, dlat));
    }
    // A millionth of a cell allows for cell sizes written with few digits.
    const double south = north - rows * dlat;
    if (north > 90 + 1e-6 * dlat || south < -90 - 1e-6 * dlat) {
        throw Error(fmt::format("latitudes from {} to {} degrees reach beyond the poles", south, north));
    }
    if (cols * dlon > 360 + 1e-6 * dlon) {
        throw Error(fmt::format("{} cells of {} degrees are wider than the earth", cols, dlon));
    }
}

double geodesic_length(const Geodesic& earth, double lat_a, double lat_b, double dlon) {
    double length = 0;
    earth.Inverse(lat_a, 0, lat_b, dlon, length);
    return length;
}

std::unique_ptr<OGRSpatialReference> plane_crs(const LocalPlane& plane) {
    auto crs = std::make_unique<OGRSpatialReference>();
    crs->SetProjCS("Local equal-area plane");
    crs->SetWellKnownGeogCS("WGS84");
    crs->SetLAEA(plane.latitude_deg, plane.longitude_deg, 0, 0);
    crs->SetLinearUnits(SRS_UL_METER, 1);
    crs->SetAxisMappingStrategy(OAMS_TRADITIONAL_GIS_ORDER);
    return crs;
}

std::unique_ptr<OGRSpatialReference> wgs84() {
    auto crs = std::make_unique<OGRSpatialReference>();
    crs->SetWellKnownGeogCS("WGS84");
    crs->SetAxisMappingStrategy(OAMS_TRADITIONAL_GIS_ORDER);
    return crs;
}

std::vector<Point> transform(const OGRSpatialReference& from, const OGRSpatialReference& to,
                             const std::vector<Point>& points, const GdalGuard& gdal) {
    const std::unique_ptr<OGRCoordinateTransformation> change(OGRCreateCoordinateTransformation(&from, &to));
    if (!change) throw Error("there is no way from one coordinate system to the other" + because(gdal));
    std::vector<double> x, y;
    for (const Point& p : points) x.push_back(p.x), y.push_back(p.y);
    if (!points.empty() && !change->Transform(static_cast<int>(x.size()), x.data(), y.data())) {
        throw Error("some points have no place in the other coordinate system" + because(gdal));
    }
    std::vector<Point> result(points.size());
    for (std::size_t i = 0; i < points.size(); ++i) result[i] = {x[i], y[i]};
    return result;
}

}  // namespace

Grid geographic_grid(Index rows, Index cols, double north_deg, double dlon_deg, double dlat_deg,
                     double equatorial_radius_m, double flattening) {
    check_extent(rows, cols, north_deg, dlon_deg, dlat_deg);
    const Geodesic earth(equatorial_radius_m, flattening);
    const auto edge = [&](double row) { return std::clamp(north_deg - row * dlat_deg, -90.0, 90.0); };
    Grid grid{.rows = rows, .cols = cols, .cell_area = {}, .east_west = {}, .north_south = {}, .diagonal = {}};
    for (Index r = 0; r < rows; ++r) {
        const double here = edge(r + 0.5);
        const double zone = zone_area(edge(r + 1.0), edge(r), equatorial_radius_m, flattening);
        grid.cell_area.push_back(zone * dlon_deg * radians);
        grid.east_west.push_back(geodesic_length(earth, here, here, dlon_deg));
        if (r + 1 == rows) break;
        const double below = edge(r + 1.5);
        grid.north_south.push_back(geodesic_length(earth, here, below, 0));
        grid.diagonal.push_back(geodesic_length(earth, here, below, dlon_deg));
    }
    return grid;
}

std::string LocalPlane::crs_wkt() const {
    const GdalGuard gdal;
    char* text = nullptr;
    plane_crs(*this)->exportToWkt(&text);
    const std::string wkt = text;
    CPLFree(text);
    return wkt;
}

std::vector<Point> to_plane(const LocalPlane& plane, const std::vector<Point>& lon_lat_deg) {
    const GdalGuard gdal;
    return transform(*wgs84(), *plane_crs(plane), lon_lat_deg, gdal);
}

std::vector<Point> from_plane(const LocalPlane& plane, const std::vector<Point>& metres) {
    const GdalGuard gdal;
    return transform(*plane_crs(plane), *wgs84(), metres, gdal);
}

std::vector<Point> reproject(const std::string& from_wkt, const std::string& to_wkt, const std::vector<Point>& points) {
    const GdalGuard gdal;
    const auto system = [&](const std::string& wkt) {
        OGRSpatialReference crs;
        if (crs.importFromWkt(wkt.c_str()) != OGRERR_NONE) {
            throw Error("a coordinate system cannot be understood" + because(gdal));
        }
        crs.SetAxisMappingStrategy(OAMS_TRADITIONAL_GIS_ORDER);
        return crs;
    };
    const OGRSpatialReference from = system(from_wkt), to = system(to_wkt);
    if (from.IsSame(&to)) return points;
    return transform(from, to, points, gdal);
}

double geodesic_area(const Polygon& lon_lat_deg) {
    GeographicLib::PolygonArea ring(Geodesic::WGS84());
    for (const Point& p : lon_lat_deg) ring.AddPoint(p.y, p.x);
    double perimeter = 0;
    double area = 0;
    ring.Compute(false, true, perimeter, area);
    return std::abs(area);
}

}  // namespace thalweg::io
