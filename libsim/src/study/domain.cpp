// SPDX-License-Identifier: GPL-3.0-or-later
#include "thalweg/study/domain.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "study/map_plane.hpp"
#include "study/site.hpp"
#include "thalweg/core/error.hpp"
#include "thalweg/io/polygonize.hpp"
#include "thalweg/io/vector_file.hpp"

namespace thalweg::study {
namespace {

/// Each use of chance has a seed of its own.
std::uint64_t seed_for(const Experiment& e, std::uint64_t use) { return e.seed + 0x9e3779b97f4a7c15 * use; }

double longer_side(const std::vector<Point>& positions) {
    const auto [low, high] = evolve::bounding_box(positions);
    return std::max(high.x - low.x, high.y - low.y);
}

void check_start(const Experiment& e) {
    if (!e.initial.elevation) return;
    if (e.domain.initial == InitialSurface::dem) {
        throw Error("initial.elevation and domain.initial = \"dem\" exclude each other: give one of them");
    }
    if (e.initial.constant_m != 0) {
        throw Error("initial.elevation and initial.constant_m exclude each other: give one of them");
    }
}

/// Uplift, rain, rock, outlets and the initial surface. Outlets keep the base level, or the height an image gives them.
Domain driven(const Experiment& e, Site site) {
    check_start(e);
    Domain& d = site.domain;
    const bool has_dem = site.rim.dem_outlet != none;
    const Outlets rule = e.outlets.value_or(Outlets{.rule = has_dem ? OutletRule::dem : OutletRule::all});
    d.setting.uplift_m_per_yr =
        varied("uplift", e.uplift, e.uplift.rate_m_per_yr, seed_for(e, 1), site.nodes, d.warnings);
    d.setting.rainfall = varied("rainfall", e.rainfall, e.rainfall.maximum, seed_for(e, 2), site.nodes, d.warnings);
    d.setting.relative_erodibility = relative_erodibility(e, site.nodes, d.warnings);
    d.setting.boundary = choose_outlets(rule, site.rim, site.nodes.plane_m, d.setting.uplift_m_per_yr);
    d.start.elevation_m = initial_surface(e, site.nodes, d.extent_m, site.base_level_m, d.warnings);
    for (std::size_t i = 0; !e.initial.elevation && i < d.start.elevation_m.size(); ++i) {
        if (d.setting.boundary[i] == Boundary::base_level) d.start.elevation_m[i] = site.base_level_m;
    }
    d.positions_m = std::move(site.nodes.plane_m);
    return std::move(site.domain);
}

Domain rectangle_domain(const Experiment& e) {
    const double width = e.domain.size_m[0], height = e.domain.size_m[1];
    if (!std::isnormal(width * height)) {
        throw Error(fmt::format("domain.size_m: {} x {} m is an area that numbers cannot hold", width, height));
    }
    const PolygonPart outline{{{0, 0}, {width, 0}, {width, height}, {0, height}}, {}};
    Site site = e.domain.mesh == MeshKind::raster ? rectangle_raster_site(e) : tin_site(e, outline, "", 1);
    site.domain.extent_m = std::max(width, height);
    return driven(e, std::move(site));
}

Domain outline_domain(const Experiment& e) {
    const std::filesystem::path& file = *e.domain.outline;
    const io::VectorShapes shapes = io::read_vectors(file);
    if (shapes.polygons.size() != 1) {
        throw Error(fmt::format("domain.outline: {} holds {} polygons, and a domain is one: {}", file.string(),
                                shapes.polygons.size(),
                                shapes.polygons.empty() ? "draw it as a polygon, not as a line"
                                                        : "keep the one that is meant (ogr2ogr -where or -sql)"));
    }
    PolygonPart drawn = shapes.polygons.front();
    const bool flat = shapes.geographic && beyond_the_globe(drawn.outer);
    if (shapes.geographic && !flat) {
        drawn.outer = ring_without_jumps("domain.outline", std::move(drawn.outer));
    }
    const MapPlane plane =
        plane_about(drawn.outer, shapes.geographic && !flat, shapes.unit_m, flat ? "" : shapes.crs_wkt);
    PolygonPart outline{plane.from_map(drawn.outer), {}};
    for (const Polygon& hole : drawn.holes) outline.holes.push_back(plane.from_map(hole));
    const double unit_m = plane.geographic ? 1 : plane.unit_m;
    Site site = e.domain.mesh == MeshKind::raster ? raster_site(e, outline, plane.crs_wkt, unit_m)
                                                  : tin_site(e, outline, plane.crs_wkt, unit_m);
    if (flat) {
        site.domain.warnings.push_back(
            fmt::format("domain.outline: coordinates of {} beyond 360 or 90 degrees are taken as metres on a plane",
                        file.string()));
    }
    const auto& [low, high] = site.nodes.box_m;
    site.domain.extent_m = std::max(high.x - low.x, high.y - low.y);
    return driven(e, std::move(site));
}

/// The box around the cells inside.
evolve::Box box_of_cells(const Nodes& nodes, double dx, double dy) {
    std::vector<Point> corners;
    for (std::size_t i = 0; i < nodes.plane_m.size(); ++i) {
        if (!nodes.inside[i]) continue;
        const Point& p = nodes.plane_m[i];
        corners.push_back({p.x - dx / 2, p.y - dy / 2});
        corners.push_back({p.x + dx / 2, p.y + dy / 2});
    }
    return evolve::bounding_box(corners);
}

/// The catchment's outline on the plane of `plane_positions`, for the sides that it faces.
Polygon outline_of_cells(const Catchment& c, double dx, double dy) {
    std::vector<Index> label(c.raster.values.size());
    std::transform(c.raster.values.begin(), c.raster.values.end(), label.begin(),
                   [](double value) { return std::isnan(value) ? none : Index{0}; });
    const Raster frame{c.raster.grid,
                       {.west = 0,
                        .north = c.raster.grid.rows * dy,
                        .cell_width = dx,
                        .cell_height = dy,
                        .crs_wkt = "",
                        .geographic = false},
                       {}};
    return io::simplify(io::cell_outline(frame, label, 0), std::max(dx, dy));
}

Domain raster_on_catchment(const Experiment& e, const Catchment& c) {
    if (e.domain.nodes || e.domain.spacing_m || e.domain.points) {
        throw Error(
            "domain.nodes, domain.spacing_m and domain.points do not apply: the cells of a raster mesh on a DEM are "
            "the "
            "DEM's");
    }
    const Grid& grid = c.raster.grid;
    const double dx = grid.east_west[grid.rows / 2], dy = grid.north_south[(grid.rows - 1) / 2];
    Site site;
    site.domain.topology = grid;
    site.domain.placement = c.raster.placement;
    site.nodes.plane_m = plane_positions(grid);
    site.nodes.crs_wkt = c.raster.placement.crs_wkt;
    site.nodes.raster = &c.raster;
    for (Index node = 0; node < grid.size(); ++node) {
        site.nodes.map.push_back(c.raster.placement.center(grid.row(node), grid.col(node)));
        site.nodes.inside.push_back(!std::isnan(c.raster.values[node]));
        if (site.nodes.inside.back()) site.domain.area_m2 += grid.area(node);
    }
    site.nodes.box_m = box_of_cells(site.nodes, dx, dy);
    site.rim = {open_rim(grid, site.nodes.inside), {outline_of_cells(c, dx, dy)}, c.outlet};
    site.base_level_m = c.raster.values[c.outlet];
    site.domain.extent_m = longer_side(site.nodes.plane_m);
    Domain domain = driven(e, std::move(site));
    for (Index node = 0; e.domain.initial == InitialSurface::dem && node < grid.size(); ++node) {
        const bool outlet = domain.setting.boundary[node] == Boundary::base_level;
        if (!outlet) domain.start.elevation_m[node] = c.raster.values[node];
    }
    return domain;
}

/// Value of the cell that holds a position of the map; NaN outside.
double sample(const Raster& raster, const Point& map_position) {
    const Placement& p = raster.placement;
    const double col = std::floor((map_position.x - p.west) / p.cell_width);
    const double row = std::floor((p.north - map_position.y) / p.cell_height);
    if (!(col >= 0 && col < raster.grid.cols && row >= 0 && row < raster.grid.rows)) {
        return std::numeric_limits<double>::quiet_NaN();
    }
    return raster.values[static_cast<std::size_t>(row) * raster.grid.cols + static_cast<std::size_t>(col)];
}

/// Node of the outline nearest to a place of the map.
Index nearest_of_rim(const Site& site, const std::vector<Point>& map, const Point& to) {
    Index best = none;
    double best_square = std::numeric_limits<double>::infinity();
    for (Index node = 0; node < map.size(); ++node) {
        const double dx = map[node].x - to.x, dy = map[node].y - to.y;
        if (site.rim.boundary[node] != Boundary::open || !(dx * dx + dy * dy < best_square)) continue;
        best_square = dx * dx + dy * dy;
        best = node;
    }
    return best;
}

/// As many nodes as the DEM has cells there, unless the experiment says otherwise.
Experiment with_node_count(Experiment e, Index cells) {
    if (!e.domain.nodes && !e.domain.spacing_m) e.domain.nodes = cells;
    return e;
}

Domain tin_on_catchment(const Experiment& e, const Catchment& c) {
    const Raster& raster = c.raster;
    const MapPlane plane = plane_of(raster);
    const auto cells = static_cast<Index>(
        std::count_if(raster.values.begin(), raster.values.end(), [](double value) { return !std::isnan(value); }));
    const Experiment counted = with_node_count(e, cells);
    const double cell_m = raster.grid.north_south[(raster.grid.rows - 1) / 2];
    // A detail of the outline under half the nodes' distance would only crowd nodes along it.
    const double spacing_m =
        counted.domain.spacing_m.value_or(cell_m * std::sqrt(cells / counted.domain.nodes.value_or(cells * 1.0)));
    const Polygon outline = plane_outline(c, plane, std::max(cell_m, spacing_m / 2));
    Site site = tin_site(counted, {outline, {}}, plane.crs_wkt, plane.unit_m);
    const std::vector<Point> map = plane.to_map(site.nodes.plane_m);
    const Point outlet = raster.placement.center(raster.grid.row(c.outlet), raster.grid.col(c.outlet));
    site.rim.dem_outlet = nearest_of_rim(site, map, outlet);
    site.base_level_m = raster.values[c.outlet];
    site.domain.extent_m = longer_side(site.nodes.plane_m);
    Domain domain = driven(e, std::move(site));
    for (Index node = 0; e.domain.initial == InitialSurface::dem && node < map.size(); ++node) {
        const double height = sample(raster, map[node]);
        const bool keeps = domain.setting.boundary[node] == Boundary::base_level || std::isnan(height);
        if (!keeps) domain.start.elevation_m[node] = height;
    }
    return domain;
}

void check_one_domain(const Experiment& e, bool has_dem) {
    const int given = !e.domain.size_m.empty() + e.domain.outline.has_value() + has_dem;
    if (given == 0) throw Error("domain.size_m (or domain.outline, or domain.dem) is needed");
    if (given > 1) {
        throw Error("domain.size_m, domain.outline and domain.dem exclude each other: give one of them");
    }
    if (!has_dem && e.domain.initial == InitialSurface::dem) throw Error("domain.initial = \"dem\" needs domain.dem");
}

}  // namespace

Domain make_domain(const Experiment& e, const Catchment& catchment) {
    check_one_domain(e, true);
    return e.domain.mesh == MeshKind::raster ? raster_on_catchment(e, catchment) : tin_on_catchment(e, catchment);
}

Domain make_domain(const Experiment& e, const Messages& messages) {
    check_one_domain(e, e.domain.dem.has_value());
    if (!e.domain.dem) {
        Domain domain = e.domain.outline ? outline_domain(e) : rectangle_domain(e);
        for (const std::string& warning : domain.warnings) messages.warning(warning);
        return domain;
    }
    const NamedRaster dem = read_dem(*e.domain.dem, {}, messages);
    MeasureOptions options;
    options.channel_area_m2 = e.study.channel_area_m2;
    Domain domain = make_domain(e, largest_complete_catchment(dem.raster, options));
    for (const std::string& warning : domain.warnings) messages.warning(warning);
    domain.warnings.insert(domain.warnings.begin(), dem.warnings.begin(), dem.warnings.end());
    return domain;
}

}  // namespace thalweg::study
