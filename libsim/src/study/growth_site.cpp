// SPDX-License-Identifier: GPL-3.0-or-later
#include "thalweg/study/growth_site.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "study/map_plane.hpp"
#include "thalweg/channel/network.hpp"
#include "thalweg/core/error.hpp"
#include "thalweg/io/vector_file.hpp"
#include "thalweg/mesh/predicates.hpp"

namespace thalweg::study {
namespace {

namespace fs = std::filesystem;

Point between(const Point& a, const Point& b, double share) {
    return {a.x + share * (b.x - a.x), a.y + share * (b.y - a.y)};
}

double distance(const Point& a, const Point& b) { return std::hypot(b.x - a.x, b.y - a.y); }

/// An outline as it was drawn, with the plane it is to be taken to.
struct Drawn {
    Polygon outline;  ///< map coordinates
    MapPlane plane;
    std::string map_crs_wkt;  ///< of the outline's own coordinates
    std::vector<std::string> warnings = {};
};

/// What a GeoJSON file without a coordinate system is taken for, though it cannot be: degrees.
bool beyond_the_globe(const Polygon& outline) {
    return std::any_of(outline.begin(), outline.end(),
                       [](const Point& p) { return std::abs(p.x) > 360 || std::abs(p.y) > 90; });
}

Drawn outline_in(const fs::path& file) {
    io::VectorShapes shapes = io::read_vectors(file);
    if (shapes.polygons.size() != 1) {
        throw Error(fmt::format("basin.outline: {} holds {} polygons, and a basin is one", file.string(),
                                shapes.polygons.size()));
    }
    PolygonPart& drawn = shapes.polygons.front();
    if (!drawn.holes.empty()) {
        throw Error(fmt::format("basin.outline: the polygon of {} has holes, and a basin has none", file.string()));
    }
    const bool flat = shapes.geographic && beyond_the_globe(drawn.outer);
    const std::string crs_wkt = flat ? "" : shapes.crs_wkt;
    Drawn result{.outline = std::move(drawn.outer), .plane = {}, .map_crs_wkt = crs_wkt};
    result.plane = plane_about(result.outline, shapes.geographic && !flat, shapes.unit_m, crs_wkt);
    if (flat) {
        result.warnings.push_back(fmt::format(
            "basin.outline: coordinates of {} beyond 360 or 90 degrees are taken as metres on a plane", file.string()));
    }
    return result;
}

Drawn drawn_outline(const Shape& shape) {
    if (const auto* file = std::get_if<fs::path>(&shape)) return outline_in(*file);
    const auto& corners = std::get<std::vector<Point>>(shape);
    if (corners.size() < 3) {
        throw Error(fmt::format("basin.outline has {} corners: a polygon needs at least three", corners.size()));
    }
    Polygon outline = corners;
    if (outline.front() == outline.back()) outline.pop_back();
    return {.outline = std::move(outline), .plane = {}, .map_crs_wkt = ""};
}

std::vector<Point> line_in(const fs::path& file, const std::string& crs_wkt) {
    const io::VectorShapes shapes = io::read_vectors(file, {.layers = {}, .crs_wkt = crs_wkt});
    if (shapes.lines.size() != 1) {
        throw Error(
            fmt::format("basin.trunk: {} holds {} lines, and a trunk is one", file.string(), shapes.lines.size()));
    }
    return shapes.lines.front();
}

/// Outlet and source in map coordinates.
std::vector<Point> drawn_trunk(const Shape& shape, Drawn& outline) {
    const auto* file = std::get_if<fs::path>(&shape);
    const std::vector<Point> line =
        file != nullptr ? line_in(*file, outline.map_crs_wkt) : std::get<std::vector<Point>>(shape);
    const bool wrong = file == nullptr ? line.size() != 2 : line.size() < 2;
    if (wrong) {
        throw Error(fmt::format("basin.trunk has {} places: it needs two, the outlet and the source", line.size()));
    }
    if (line.size() > 2) {
        outline.warnings.push_back("basin.trunk: a trunk is straight, and the bends of the drawn line are left out");
    }
    return {line.front(), line.back()};
}

Point nearest_on_outline(const Polygon& outline, const Point& p) {
    Point nearest = outline[0];
    for (std::size_t i = 0; i < outline.size(); ++i) {
        const Point& a = outline[i];
        const Point& b = outline[(i + 1) % outline.size()];
        const double square = (b.x - a.x) * (b.x - a.x) + (b.y - a.y) * (b.y - a.y);
        const double along = (p.x - a.x) * (b.x - a.x) + (p.y - a.y) * (b.y - a.y);
        const Point on_side = between(a, b, std::clamp(along / square, 0.0, 1.0));
        if (distance(on_side, p) < distance(nearest, p)) nearest = on_side;
    }
    return nearest;
}

/// A drawn line hardly ever ends exactly on an outline, nor does one on degrees once both lie on a plane.
void put_outlet_on_outline(grow::Basin& basin, std::vector<std::string>& warnings) {
    constexpr double farthest = 0.01;  // of the outline's extent
    const Point nearest = nearest_on_outline(basin.outline, basin.outlet);
    const double off = distance(nearest, basin.outlet);
    const auto [low, high] = evolve::bounding_box(basin.outline);
    if (off > farthest * distance(low, high)) return;  // which is refused then
    basin.outlet = nearest;
    if (off > 1e-6 * distance(low, high)) {
        warnings.push_back(
            fmt::format("basin.trunk: its outlet lay {:.3g} m off the outline and was put onto it", off));
    }
}

GrowthSite drawn_site(const Experiment& e) {
    if (!e.basin.trunk) throw Error("basin.trunk is needed: a line [[x, y], [x, y]] from the outlet to a source");
    Drawn drawn = drawn_outline(*e.basin.outline);
    const std::vector<Point> trunk = drawn.plane.from_map(drawn_trunk(*e.basin.trunk, drawn));
    grow::Basin basin{.outline = drawn.plane.from_map(drawn.outline),
                      .outlet = trunk[0],
                      .source = trunk[1],
                      .base_level_m = e.basin.base_level_m.value_or(0)};
    put_outlet_on_outline(basin, drawn.warnings);
    return {.basin = grow::checked_basin(basin),
            .unit_m = drawn.plane.geographic ? 1 : drawn.plane.unit_m,
            .crs_wkt = drawn.plane.crs_wkt,
            .warnings = std::move(drawn.warnings)};
}

/// Cells of the main stream, from the outlet to where it begins to be a channel.
std::vector<Index> main_stream(const Catchment& c) {
    MeasureOptions options;
    options.catchment_outlet = c.outlet;
    const RasterMeasurement m = measure_raster(c.raster, options);
    const RoutedTerrain& terrain = m.terrain;
    std::vector<Index> largest(terrain.graph.size(), none);
    for (const Index node : terrain.graph.order) {
        const Index receiver = terrain.graph.receiver[node];
        if (receiver == none) continue;
        Index& so_far = largest[receiver];
        if (so_far == none || terrain.drainage_area_m2[node] > terrain.drainage_area_m2[so_far]) so_far = node;
    }
    const double threshold = m.statistics.channels.threshold_area_m2;
    std::vector<Index> stream{c.outlet};
    for (Index node = largest[c.outlet]; node != none && terrain.drainage_area_m2[node] >= threshold;) {
        stream.push_back(node);
        node = largest[node];
    }
    return stream;
}

bool crosses_outline(const Polygon& outline, const Point& from, const Point& to) {
    for (std::size_t i = 0; i < outline.size(); ++i) {
        if (mesh::segments_cross(from, to, outline[i], outline[(i + 1) % outline.size()])) return true;
    }
    return false;
}

/// Whether the line from the outlet to the source, widened by 1 % of its length but near the outlet, stays inside.
bool is_clear(const Polygon& outline, const Point& outlet, const Point& source) {
    constexpr double clearance = 0.01;
    const Point aside{-clearance * (source.y - outlet.y), clearance * (source.x - outlet.x)};
    const Point near = between(outlet, source, 0.1);
    const Point beyond = between(outlet, source, 1 + clearance);
    if (crosses_outline(outline, between(outlet, source, 1e-6), beyond)) return false;
    for (const double side : {-1.0, 1.0}) {
        const Point from{near.x + side * aside.x, near.y + side * aside.y};
        const Point to{beyond.x + side * aside.x, beyond.y + side * aside.y};
        if (crosses_outline(outline, near, from) || crosses_outline(outline, from, to)) return false;
    }
    return true;
}

/// Whether a network can grow from this trunk.
bool is_trunk(const grow::Basin& basin) {
    try {
        grow::checked_basin(basin);
        return true;
    } catch (const Error&) {
        return false;
    }
}

}  // namespace

GrowthSite growth_site(const Catchment& c) {
    const MapPlane plane = plane_of(c.raster);
    const Grid& grid = c.raster.grid;
    const double cell_m = grid.north_south[(grid.rows - 1) / 2];
    const std::vector<Index> stream = main_stream(c);
    std::vector<Point> map;
    for (const Index cell : stream) map.push_back(c.raster.placement.center(grid.row(cell), grid.col(cell)));
    const std::vector<Point> line = plane.from_map(std::move(map));
    GrowthSite site{.basin = {.outline = plane_outline(c, plane, cell_m),
                              .outlet = {},
                              .source = {},
                              .base_level_m = c.raster.values[c.outlet]},
                    .unit_m = plane.geographic ? 1 : plane.unit_m,
                    .crs_wkt = plane.crs_wkt,
                    .warnings = {}};
    site.basin.outlet = nearest_on_outline(site.basin.outline, line.front());
    // No more than some hundred places are tried: a stream is seen in stretches, not in single cells.
    const std::size_t step = std::max<std::size_t>(1, line.size() / 400);
    for (std::size_t at = line.size() - 1; at > 0; at -= std::min(at, step)) {
        site.basin.source = line[at];
        if (!is_clear(site.basin.outline, site.basin.outlet, line[at]) || !is_trunk(site.basin)) continue;
        site.basin = grow::checked_basin(site.basin);
        const double share = static_cast<double>(at) / static_cast<double>(line.size() - 1);
        if (share < 1) {
            site.warnings.push_back(fmt::format(
                "basin.dem: a trunk is straight, and from the outlet the lower {:.0f} % of the main stream are seen",
                100 * share));
        }
        return site;
    }
    throw Error(
        "basin.dem: no straight trunk from the outlet lies inside the basin; draw basin.outline and basin.trunk");
}

GrowthSite growth_site(const Experiment& e, const Messages& messages) {
    if (e.basin.dem && (e.basin.outline || e.basin.trunk)) {
        throw Error("basin.dem brings its own outline and trunk: give these or the DEM");
    }
    if (!e.basin.dem && !e.basin.outline) {
        throw Error("basin.outline (or basin.dem) is needed: where the network grows");
    }
    GrowthSite site;
    if (e.basin.dem) {
        NamedRaster dem = read_dem(*e.basin.dem, {}, messages);
        MeasureOptions options;
        options.channel_area_m2 = e.study.channel_area_m2;
        site = growth_site(largest_complete_catchment(dem.raster, options));
        if (e.basin.base_level_m) site.basin.base_level_m = *e.basin.base_level_m;
    } else {
        site = drawn_site(e);
    }
    for (const std::string& warning : site.warnings) messages.warning(warning);
    return site;
}

grow::Dials dials_of(const Experiment& e) {
    if (!e.growth.channel_maintenance_m) {
        throw Error(
            "growth.channel_maintenance_m is needed: basin area per channel length in metres, one over the drainage "
            "density");
    }
    grow::Dials dials = e.growth.dials;
    dials.channel_maintenance_m = *e.growth.channel_maintenance_m;
    dials.seed = e.seed;
    return dials;
}

}  // namespace thalweg::study
