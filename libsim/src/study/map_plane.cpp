// SPDX-License-Identifier: GPL-3.0-or-later
#include "study/map_plane.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "thalweg/core/error.hpp"
#include "thalweg/io/polygonize.hpp"

namespace thalweg::study {

std::vector<Point> MapPlane::from_map(std::vector<Point> points) const {
    if (geographic) return io::to_plane(local, points);
    for (Point& p : points) p = {p.x * unit_m, p.y * unit_m};
    return points;
}

std::vector<Point> MapPlane::to_map(std::vector<Point> points) const {
    if (geographic) return io::from_plane(local, points);
    for (Point& p : points) p = {p.x / unit_m, p.y / unit_m};
    return points;
}

MapPlane plane_of(const Raster& raster) {
    const Placement& place = raster.placement;
    const Point middle = place.center(raster.grid.rows / 2, raster.grid.cols / 2);
    return plane_about({middle}, place.geographic, place.geographic ? 1 : raster.grid.east_west[0] / place.cell_width,
                       place.crs_wkt);
}

bool beyond_the_globe(const std::vector<Point>& places) {
    return std::ranges::any_of(places, [](const Point& p) { return std::abs(p.x) > 360 || std::abs(p.y) > 90; });
}

Polygon ring_without_jumps(const std::string& what, Polygon ring) {
    for (std::size_t i = 1; i < ring.size(); ++i) {
        const double jump = ring[i].x - ring[i - 1].x;
        if (std::abs(jump) > 180) ring[i].x -= 360 * std::round(jump / 360);
    }
    if (std::abs(ring.back().x - ring.front().x) <= 180) return ring;
    throw Error(
        fmt::format("{} goes around a pole: bring it to a polar map first, e.g. by ogr2ogr -t_srs EPSG:3413", what));
}

MapPlane plane_about(const std::vector<Point>& places, bool geographic, double unit_m, const std::string& crs_wkt) {
    if (!geographic) return {.unit_m = unit_m, .crs_wkt = crs_wkt};
    const auto [west, east] =
        std::minmax_element(places.begin(), places.end(), [](const Point& a, const Point& b) { return a.x < b.x; });
    const auto [south, north] =
        std::minmax_element(places.begin(), places.end(), [](const Point& a, const Point& b) { return a.y < b.y; });
    const io::LocalPlane local{.longitude_deg = std::remainder((west->x + east->x) / 2, 360),
                               .latitude_deg = (south->y + north->y) / 2};
    return {.local = local, .geographic = true, .crs_wkt = local.crs_wkt()};
}

Polygon plane_outline(const Catchment& c, const MapPlane& plane, double tolerance_m) {
    std::vector<Index> label(c.raster.values.size());
    std::transform(c.raster.values.begin(), c.raster.values.end(), label.begin(),
                   [](double value) { return std::isnan(value) ? none : Index{0}; });
    return io::simplify(plane.from_map(io::cell_outline(c.raster, label, 0)), tolerance_m);
}

}  // namespace thalweg::study
