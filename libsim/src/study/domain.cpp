// SPDX-License-Identifier: GPL-3.0-or-later
#include "thalweg/study/domain.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "thalweg/core/error.hpp"
#include "thalweg/evolve/noise.hpp"
#include "thalweg/evolve/uplift.hpp"
#include "thalweg/io/geodesy.hpp"
#include "thalweg/io/polygonize.hpp"
#include "thalweg/mesh/points.hpp"
#include "thalweg/mesh/triangulate.hpp"
#include "thalweg/terrain/route.hpp"

namespace thalweg::study {
namespace {

constexpr double nan = std::numeric_limits<double>::quiet_NaN();

template <class T>
std::vector<T> slice(const std::vector<T>& values, Index first, Index count) {
    return {values.begin() + first, values.begin() + first + count};
}

/// Rows and columns [first, first + count) of a raster, with the same measures.
struct Window {
    Index first_row, rows, first_col, cols;
};

Raster crop(const Raster& whole, const Window& w) {
    Raster part;
    part.grid = {.rows = w.rows,
                 .cols = w.cols,
                 .cell_area = slice(whole.grid.cell_area, w.first_row, w.rows),
                 .east_west = slice(whole.grid.east_west, w.first_row, w.rows),
                 .north_south = slice(whole.grid.north_south, w.first_row, w.rows - 1),
                 .diagonal = slice(whole.grid.diagonal, w.first_row, w.rows - 1)};
    part.placement = whole.placement;
    part.placement.west += w.first_col * whole.placement.cell_width;
    part.placement.north -= w.first_row * whole.placement.cell_height;
    for (Index r = 0; r < w.rows; ++r) {
        const auto row = whole.values.begin() + std::size_t{w.first_row + r} * whole.grid.cols + w.first_col;
        part.values.insert(part.values.end(), row, row + w.cols);
    }
    return part;
}

/// Smallest window around the cells labelled 0, with a margin of one cell where the raster has one.
Window window_around(const Grid& grid, const std::vector<Index>& label) {
    Index top = grid.rows, bottom = 0, left = grid.cols, right = 0;
    for (Index node = 0; node < grid.size(); ++node) {
        if (label[node] != 0) continue;
        top = std::min(top, grid.row(node));
        bottom = std::max(bottom, grid.row(node));
        left = std::min(left, grid.col(node));
        right = std::max(right, grid.col(node));
    }
    top -= top > 0;
    left -= left > 0;
    bottom += bottom + 1 < grid.rows;
    right += right + 1 < grid.cols;
    return {top, bottom - top + 1, left, right - left + 1};
}

std::vector<Point> plane_positions(const Grid& grid) {
    const double dx = grid.east_west[grid.rows / 2];
    const double dy = grid.north_south.empty() ? dx : grid.north_south[(grid.rows - 1) / 2];
    std::vector<Point> positions;
    positions.reserve(grid.size());
    for (Index node = 0; node < grid.size(); ++node) {
        positions.push_back({(grid.col(node) + 0.5) * dx, (grid.rows - 0.5 - grid.row(node)) * dy});
    }
    return positions;
}

std::vector<Point> plane_positions(const Mesh& mesh) {
    std::vector<Point> positions;
    positions.reserve(mesh.size());
    for (Index node = 0; node < mesh.size(); ++node) positions.push_back({mesh.x[node], mesh.y[node]});
    return positions;
}

double longer_side(const std::vector<Point>& positions) {
    const auto [left, right] = std::minmax_element(positions.begin(), positions.end(),
                                                   [](const Point& a, const Point& b) { return a.x < b.x; });
    const auto [low, high] = std::minmax_element(positions.begin(), positions.end(),
                                                 [](const Point& a, const Point& b) { return a.y < b.y; });
    return std::max(right->x - left->x, high->y - low->y);
}

/// Uplift, rainfall and the rough initial surface, above a base level that the outlets keep.
void drive(Domain& domain, const Experiment& e, std::vector<Boundary> boundary, double base_level_m) {
    const std::size_t count = domain.positions_m.size();
    domain.setting.boundary = std::move(boundary);
    domain.setting.rainfall.assign(count, 1.0);
    domain.setting.uplift_m_per_yr =
        evolve::pattern_values(e.uplift.pattern, domain.positions_m, e.uplift.rate_m_per_yr);
    domain.start.elevation_m =
        e.initial.noise == NoiseKind::perlin
            ? evolve::perlin_surface(domain.positions_m, domain.extent_m, e.initial.amplitude_m, e.seed)
            : evolve::uniform_surface(count, e.initial.amplitude_m, e.seed);
    for (std::size_t i = 0; i < count; ++i) {
        const bool outlet = domain.setting.boundary[i] == Boundary::base_level;
        domain.start.elevation_m[i] = base_level_m + (outlet ? 0.0 : domain.start.elevation_m[i]);
    }
}

double rectangle_spacing(const Experiment& e) {
    if (e.domain.nodes && e.domain.spacing_m) {
        throw Error("domain.nodes and domain.spacing_m say the same thing: give one of them");
    }
    if (e.domain.spacing_m) return *e.domain.spacing_m;
    if (!e.domain.nodes) throw Error("domain.nodes (or domain.spacing_m) is needed");
    return std::sqrt(e.domain.size_m[0] * e.domain.size_m[1] / *e.domain.nodes);
}

Grid rectangle_grid(const Experiment& e) {
    const double spacing = rectangle_spacing(e);
    const double cols = std::round(e.domain.size_m[0] / spacing), rows = std::round(e.domain.size_m[1] / spacing);
    if (!(rows >= 3 && cols >= 3)) {
        throw Error(fmt::format("a raster mesh of {} x {} cells has no inside: it needs at least 3 x 3", rows, cols));
    }
    if (rows * cols >= none)
        throw Error(fmt::format("{} x {} cells are more than 32-bit numbers can count", rows, cols));
    return plane_grid(static_cast<Index>(rows), static_cast<Index>(cols), e.domain.size_m[0] / cols,
                      e.domain.size_m[1] / rows);
}

Mesh tin(const Experiment& e, const Polygon& outline) {
    const auto points = e.domain.spacing_m ? mesh::poisson_disk(outline, *e.domain.spacing_m, e.seed)
                                           : mesh::poisson_disk_count(outline, e.domain.nodes.value(), e.seed);
    Mesh mesh = mesh::triangulate(outline, points);
    if (std::find(mesh.on_outline.begin(), mesh.on_outline.end(), std::uint8_t{0}) == mesh.on_outline.end()) {
        throw Error(
            fmt::format("all {} nodes lie on the outline, so nothing can be eroded: ask for more nodes", mesh.size()));
    }
    return mesh;
}

Domain rectangle_domain(const Experiment& e) {
    if (e.domain.size_m.empty()) throw Error("domain.size_m (or domain.dem) is needed");
    if (e.outlets == OutletRule::dem) throw Error("outlets = \"dem\" needs domain.dem");
    if (e.domain.initial == InitialSurface::dem) throw Error("domain.initial = \"dem\" needs domain.dem");
    const double width = e.domain.size_m[0], height = e.domain.size_m[1];
    Domain domain;
    domain.area_m2 = width * height;
    std::vector<Boundary> boundary;
    if (e.domain.mesh == MeshKind::raster) {
        const Grid grid = rectangle_grid(e);
        domain.positions_m = plane_positions(grid);
        domain.placement = {.west = 0,
                            .north = height,
                            .cell_width = grid.east_west[0],
                            .cell_height = grid.north_south[0],
                            .crs_wkt = "",
                            .geographic = false};
        boundary = terrain::data_edge(grid, std::vector<double>(grid.size(), 0.0));
        domain.topology = grid;
    } else {
        rectangle_spacing(e);
        Mesh mesh = tin(e, {{0, 0}, {width, 0}, {width, height}, {0, height}});
        domain.positions_m = plane_positions(mesh);
        for (const std::uint8_t on : mesh.on_outline) boundary.push_back(on ? Boundary::open : Boundary::interior);
        domain.topology = std::move(mesh);
    }
    for (Boundary& b : boundary) b = b == Boundary::open ? Boundary::base_level : Boundary::interior;
    domain.extent_m = std::max(width, height);
    drive(domain, e, std::move(boundary), 0.0);
    return domain;
}

Domain raster_on_catchment(const Experiment& e, const Catchment& c) {
    if (e.domain.nodes || e.domain.spacing_m) {
        throw Error(
            "domain.nodes and domain.spacing_m do not apply: the cells of a raster mesh on a DEM are the DEM's");
    }
    const Grid& grid = c.raster.grid;
    Domain domain;
    domain.topology = grid;
    domain.placement = c.raster.placement;
    domain.positions_m = plane_positions(grid);
    domain.extent_m = longer_side(domain.positions_m);
    auto boundary = terrain::data_edge(grid, c.raster.values);
    for (Boundary& b : boundary) {
        const bool outlet = e.outlets == OutletRule::all && b == Boundary::open;
        b = outlet ? Boundary::base_level : Boundary::interior;
    }
    boundary[c.outlet] = Boundary::base_level;
    const double base_level = c.raster.values[c.outlet];
    drive(domain, e, std::move(boundary), base_level);
    for (Index node = 0; node < grid.size(); ++node) {
        if (std::isnan(c.raster.values[node]))
            domain.start.elevation_m[node] = nan;
        else
            domain.area_m2 += grid.area(node);
        const bool outlet = domain.setting.boundary[node] == Boundary::base_level;
        if (e.domain.initial == InitialSurface::dem && !outlet) domain.start.elevation_m[node] = c.raster.values[node];
    }
    return domain;
}

/// The plane in metres on which a catchment's TIN lies, and the way back to map coordinates.
struct Plane {
    io::LocalPlane local;  ///< used where the map is in degrees
    bool geographic;
    double unit_m;  ///< of the map, where it is projected

    std::vector<Point> from_map(std::vector<Point> points) const {
        if (geographic) return io::to_plane(local, points);
        for (Point& p : points) p = {p.x * unit_m, p.y * unit_m};
        return points;
    }
    std::vector<Point> to_map(std::vector<Point> points) const {
        if (geographic) return io::from_plane(local, points);
        for (Point& p : points) p = {p.x / unit_m, p.y / unit_m};
        return points;
    }
};

Plane plane_of(const Raster& raster) {
    const Placement& place = raster.placement;
    const Point middle = place.center(raster.grid.rows / 2, raster.grid.cols / 2);
    return {.local = {.longitude_deg = middle.x, .latitude_deg = middle.y},
            .geographic = place.geographic,
            .unit_m = place.geographic ? 1 : raster.grid.east_west[0] / place.cell_width};
}

/// The catchment's outline in metres on its plane, without the staircase of its cells.
Polygon plane_outline(const Catchment& c, const Plane& plane, double tolerance_m) {
    std::vector<Index> label(c.raster.values.size());
    std::transform(c.raster.values.begin(), c.raster.values.end(), label.begin(),
                   [](double value) { return std::isnan(value) ? none : Index{0}; });
    return io::simplify(plane.from_map(io::cell_outline(c.raster, label, 0)), tolerance_m);
}

/// Value of the cell that holds a position of the plane; NaN outside.
double sample(const Raster& raster, const Point& map_position) {
    const Placement& p = raster.placement;
    const double col = std::floor((map_position.x - p.west) / p.cell_width);
    const double row = std::floor((p.north - map_position.y) / p.cell_height);
    if (!(col >= 0 && col < raster.grid.cols && row >= 0 && row < raster.grid.rows)) return nan;
    return raster.values[static_cast<std::size_t>(row) * raster.grid.cols + static_cast<std::size_t>(col)];
}

Index nearest(const std::vector<Point>& positions, const std::vector<std::uint8_t>& candidates, const Point& to) {
    Index best = none;
    double best_square = std::numeric_limits<double>::infinity();
    for (Index node = 0; node < positions.size(); ++node) {
        const double dx = positions[node].x - to.x, dy = positions[node].y - to.y;
        if (!candidates[node] || !(dx * dx + dy * dy < best_square)) continue;
        best_square = dx * dx + dy * dy;
        best = node;
    }
    return best;
}

/// As many nodes as the DEM has cells there, unless the experiment says otherwise.
Experiment with_node_count(Experiment e, const Raster& raster) {
    if (e.domain.nodes && e.domain.spacing_m) {
        throw Error("domain.nodes and domain.spacing_m say the same thing: give one of them");
    }
    if (!e.domain.nodes && !e.domain.spacing_m) {
        e.domain.nodes = static_cast<Index>(
            std::count_if(raster.values.begin(), raster.values.end(), [](double value) { return !std::isnan(value); }));
    }
    return e;
}

/// Base level at the node of the outline nearest to the outlet, or all around.
std::vector<Boundary> tin_boundary(const Mesh& mesh, const std::vector<Point>& map_positions, const Point& outlet,
                                   std::optional<OutletRule> rule) {
    std::vector<Boundary> boundary(mesh.size(), Boundary::interior);
    for (Index node = 0; rule == OutletRule::all && node < mesh.size(); ++node) {
        if (mesh.on_outline[node]) boundary[node] = Boundary::base_level;
    }
    boundary[nearest(map_positions, mesh.on_outline, outlet)] = Boundary::base_level;
    return boundary;
}

Domain tin_on_catchment(const Experiment& e, const Catchment& c) {
    const Raster& raster = c.raster;
    const Plane plane = plane_of(raster);
    const double cell_m = raster.grid.north_south[(raster.grid.rows - 1) / 2];
    Mesh mesh = tin(with_node_count(e, raster), plane_outline(c, plane, cell_m));
    Domain domain;
    domain.unit_m = plane.unit_m;
    domain.placement.crs_wkt = plane.geographic ? plane.local.crs_wkt() : raster.placement.crs_wkt;
    domain.positions_m = plane_positions(mesh);
    domain.extent_m = longer_side(domain.positions_m);
    domain.area_m2 = mesh::polygon_area(mesh.outline);
    const std::vector<Point> map_positions = plane.to_map(domain.positions_m);
    const Point outlet = raster.placement.center(raster.grid.row(c.outlet), raster.grid.col(c.outlet));
    auto boundary = tin_boundary(mesh, map_positions, outlet, e.outlets);
    domain.topology = std::move(mesh);
    drive(domain, e, std::move(boundary), raster.values[c.outlet]);
    for (Index node = 0; e.domain.initial == InitialSurface::dem && node < map_positions.size(); ++node) {
        const double height = sample(raster, map_positions[node]);
        const bool keeps = domain.setting.boundary[node] == Boundary::base_level || std::isnan(height);
        if (!keeps) domain.start.elevation_m[node] = height;
    }
    return domain;
}

}  // namespace

Catchment largest_complete_catchment(const Raster& dem, const MeasureOptions& options) {
    const RasterMeasurement m = measure_raster(dem, options);
    const auto& basins = m.statistics.basins;
    if (basins.empty() || !basins.front().basin.complete) {
        throw Error(
            "the DEM holds no complete catchment as large as the channel threshold: every river is cut by its edge; "
            "use a larger DEM or a smaller channel area");
    }
    std::vector<double> masked(dem.values.size(), nan);
    for (Index node = 0; node < dem.grid.size(); ++node) {
        if (m.statistics.basin_of[node] == 0) masked[node] = dem.values[node];
    }
    const Window window = window_around(dem.grid, m.statistics.basin_of);
    const Index outlet = basins.front().basin.outlet;
    const Index row = dem.grid.row(outlet) - window.first_row, col = dem.grid.col(outlet) - window.first_col;
    return {.raster = crop({dem.grid, dem.placement, std::move(masked)}, window), .outlet = row * window.cols + col};
}

Domain make_domain(const Experiment& e, const Catchment& catchment) {
    if (!e.domain.size_m.empty()) throw Error("domain.size_m and domain.dem exclude each other: give one of them");
    return e.domain.mesh == MeshKind::raster ? raster_on_catchment(e, catchment) : tin_on_catchment(e, catchment);
}

Domain make_domain(const Experiment& e, const Messages& messages) {
    if (!e.domain.dem) return rectangle_domain(e);
    const NamedRaster dem = read_dem(*e.domain.dem, {}, messages);
    MeasureOptions options;
    options.channel_area_m2 = e.study.channel_area_m2;
    Domain domain = make_domain(e, largest_complete_catchment(dem.raster, options));
    domain.warnings = dem.warnings;
    return domain;
}

}  // namespace thalweg::study
