// SPDX-License-Identifier: GPL-3.0-or-later
#include "thalweg/study/growth_site.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "study/map_plane.hpp"
#include "study/trunk.hpp"
#include "thalweg/channel/network.hpp"
#include "thalweg/core/error.hpp"
#include "thalweg/io/vector_file.hpp"
#include "thalweg/mesh/predicates.hpp"
#include "thalweg/mesh/triangulate.hpp"

namespace thalweg::study {
namespace {

namespace fs = std::filesystem;

double distance(const Point& a, const Point& b) { return std::hypot(b.x - a.x, b.y - a.y); }

/// An outline as it was drawn, with the plane it is to be taken to.
struct Drawn {
    Polygon outline;  ///< map coordinates
    MapPlane plane;
    std::string map_crs_wkt;  ///< of the outline's own coordinates
    std::vector<std::string> warnings = {};
};

constexpr const char* cut_by_the_map =
    "; where ±180° cuts it, draw it in one piece, with longitudes beyond 180 on the other side";

bool is_cut_by_the_map(const io::VectorShapes& shapes) {
    const auto at_the_cut = [](const PolygonPart& part) {
        return std::ranges::any_of(part.outer, [](const Point& p) { return std::abs(p.x) == 180; });
    };
    return shapes.geographic && shapes.polygons.size() > 1 && std::ranges::all_of(shapes.polygons, at_the_cut);
}

Drawn outline_in(const fs::path& file) {
    io::VectorShapes shapes = io::read_vectors(file);
    if (shapes.polygons.size() != 1) {
        throw Error(fmt::format("basin.outline: {} holds {} polygons, and a basin is one{}", file.string(),
                                shapes.polygons.size(), is_cut_by_the_map(shapes) ? cut_by_the_map : ""));
    }
    PolygonPart& drawn = shapes.polygons.front();
    if (!drawn.holes.empty()) {
        throw Error(fmt::format("basin.outline: the polygon of {} has holes, and a basin has none", file.string()));
    }
    const bool flat = shapes.geographic && beyond_the_globe(drawn.outer);
    if (shapes.geographic && !flat) drawn.outer = ring_without_jumps("basin.outline", std::move(drawn.outer));
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
    return {.outline = corners, .plane = {}, .map_crs_wkt = ""};
}

std::vector<Point> line_in(const fs::path& file, const std::string& crs_wkt) {
    const io::VectorShapes shapes = io::read_vectors(file, {.layers = {}, .crs_wkt = crs_wkt});
    if (shapes.lines.size() != 1) {
        throw Error(
            fmt::format("basin.trunk: {} holds {} lines, and a trunk is one", file.string(), shapes.lines.size()));
    }
    return shapes.lines.front();
}

/// From its first place to its last, in map coordinates.
std::vector<Point> drawn_trunk(const Shape& shape, Drawn& outline) {
    const auto* file = std::get_if<fs::path>(&shape);
    const std::vector<Point> line =
        file != nullptr ? line_in(*file, outline.map_crs_wkt) : std::get<std::vector<Point>>(shape);
    if (line.size() < 2) {
        throw Error(fmt::format("basin.trunk has {} places: it needs two, the outlet and the source", line.size()));
    }
    return line;
}

constexpr double outlet_may_be_off = 0.01;  // of the outline's extent
constexpr double as_good_as_on = 1e-6;      // of the outline's extent: what `grow::checked_basin` takes for on it

/// How far from the outline, as a share of its extent.
double share_off(const Polygon& outline, const Point& p) {
    const auto [low, high] = evolve::bounding_box(outline);
    return distance(grow::nearest_on_outline(outline, p), p) / distance(low, high);
}

/// A trunk that was drawn downstream ends at the outline, where no source can be, and does not begin there.
void turn_if_drawn_downstream(grow::Basin& basin, std::vector<std::string>& warnings) {
    const double first = share_off(basin.outline, basin.outlet), last = share_off(basin.outline, basin.source);
    const bool only_last_is_near = first > outlet_may_be_off && last <= outlet_may_be_off;
    const bool only_last_is_on = first > as_good_as_on && last <= as_good_as_on;
    if (!only_last_is_near && !only_last_is_on) return;
    std::swap(basin.outlet, basin.source);
    std::ranges::reverse(basin.bends);
    warnings.push_back(
        "basin.trunk: its last place is the one on the outline, so it was drawn downstream and is turned round");
}

/// A drawn line hardly ever ends exactly on an outline, nor does one on degrees once both lie on a plane.
void put_outlet_on_outline(grow::Basin& basin, std::vector<std::string>& warnings) {
    const double share = share_off(basin.outline, basin.outlet);
    if (share > outlet_may_be_off) return;  // which is refused then
    const Point nearest = grow::nearest_on_outline(basin.outline, basin.outlet);
    if (share > as_good_as_on) {
        warnings.push_back(fmt::format("basin.trunk: its outlet lay {:.3g} m off the outline and was put onto it",
                                       distance(nearest, basin.outlet)));
    }
    basin.outlet = nearest;
}

/// A river of a file has more bends than links can follow.
void straighten_river(const grow::Dials& dials, grow::Basin& basin, std::vector<std::string>& warnings) {
    const std::vector<Point> river = grow::trunk_of(basin);
    const double share = follow_river(river, river, dials, basin);
    if (share == 0) basin.bends.clear();
    if (share == 1 && basin.bends.size() + 2 == river.size()) return;
    warnings.push_back(fmt::format("basin.trunk: {} of the {} bends drawn are kept{}", basin.bends.size(),
                                   river.size() - 2, share > 0 && share < 1 ? ", and the upper end is left out" : ""));
}

GrowthSite drawn_site(const Experiment& e) {
    if (!e.basin.trunk) throw Error("basin.trunk is needed: a line [[x, y], [x, y]] from the outlet to a source");
    Drawn drawn = drawn_outline(*e.basin.outline);
    drawn.outline = mesh::simple_polygon(drawn.outline);  // here, where places are still those of the map
    const std::vector<Point> trunk = drawn.plane.from_map(drawn_trunk(*e.basin.trunk, drawn));
    grow::Basin basin{.outline = drawn.plane.from_map(drawn.outline),
                      .outlet = trunk.front(),
                      .source = trunk.back(),
                      .base_level_m = e.basin.base_level_m.value_or(0),
                      .bends = {trunk.begin() + 1, trunk.end() - 1}};
    turn_if_drawn_downstream(basin, drawn.warnings);
    put_outlet_on_outline(basin, drawn.warnings);
    const bool is_river = std::holds_alternative<fs::path>(*e.basin.trunk) && !basin.bends.empty();
    if (is_river) straighten_river(dials_of(e), basin, drawn.warnings);
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

/// Throws Error that says how many cells it takes for two across the basin.
[[noreturn]] void refuse_narrow_basin(const Raster& raster, const GrowthSite& site) {
    const auto [low, high] = evolve::bounding_box(site.basin.outline);
    const double longer = std::max(high.x - low.x, high.y - low.y);
    const double width = std::abs(mesh::polygon_area(site.basin.outline)) / distance(low, high);
    throw Error(
        fmt::format("the basin is narrower ({:.3g} m) than a cell ({:.3g} m), and none has its centre inside: ask for "
                    "output.resolution = {:.0f} or more",
                    width, raster.grid.east_west[0], std::ceil(2 * longer / width)));
}

}  // namespace

GrowthSite growth_site(const Catchment& c, const grow::Dials& dials) {
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
    site.basin.outlet = grow::nearest_on_outline(site.basin.outline, line.front());
    std::vector<Point> river = line;
    river.front() = site.basin.outlet;
    const double half_window = std::min(dials.channel_maintenance_m / 2 / cell_m, 1e6);
    double followed = follow_river(river, smoothed(river, static_cast<std::size_t>(half_window)), dials, site.basin);
    if (followed < 1) {
        grow::Basin straight = site.basin;
        const double seen = see_river(river, dials, straight);
        if (seen > followed) site.basin = straight, followed = seen;
        if (followed == 0) {
            throw Error(
                "basin.dem: no trunk from the outlet lies inside the basin; draw basin.outline and basin.trunk");
        }
    }
    if (followed < 1) {
        site.warnings.push_back(
            fmt::format("basin.dem: the trunk follows the lower {:.0f} % of the main stream; beyond, no trunk lies "
                        "inside the basin with room for tributaries",
                        100 * followed));
    }
    site.basin = grow::checked_basin(site.basin);
    return site;
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
        site = growth_site(largest_complete_catchment(dem.raster, options), dials_of(e));
        if (e.basin.base_level_m) site.basin.base_level_m = *e.basin.base_level_m;
    } else {
        site = drawn_site(e);
    }
    for (const std::string& warning : site.warnings) messages.warning(warning);
    return site;
}

Index outlet_cell(const Raster& raster, const GrowthSite& site) {
    const Point outlet{site.basin.outlet.x / site.unit_m, site.basin.outlet.y / site.unit_m};
    const Index nearest = nearest_cell_with_data(raster, outlet);
    if (nearest == none) refuse_narrow_basin(raster, site);
    return nearest;
}

grow::Dials dials_of(const Experiment& e) {
    if (!e.growth.channel_maintenance_m) {
        throw Error(
            "growth.channel_maintenance_m is needed: basin area per channel length in metres, one over the drainage "
            "density");
    }
    grow::Dials dials = e.growth.dials;
    dials.channel_maintenance_m = *e.growth.channel_maintenance_m;
    if (e.growth.sidewall_reach_m) dials.sidewall_reach_m = *e.growth.sidewall_reach_m;
    dials.seed = e.seed;
    return dials;
}

}  // namespace thalweg::study
