// SPDX-License-Identifier: GPL-3.0-or-later
#include "study/site.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "thalweg/core/error.hpp"
#include "thalweg/core/random.hpp"
#include "thalweg/mesh/predicates.hpp"
#include "thalweg/mesh/triangulate.hpp"
#include "thalweg/terrain/route.hpp"

namespace thalweg::study {
namespace {

constexpr double nan = std::numeric_limits<double>::quiet_NaN();

double area_of(const PolygonPart& part) {
    double area = std::abs(mesh::polygon_area(part.outer));
    for (const Polygon& hole : part.holes) area -= std::abs(mesh::polygon_area(hole));
    return area;
}

/// Distance of nodes, from itself or from their number.
double spacing_in(const Experiment& e, double area_m2) {
    if (e.domain.nodes && e.domain.spacing_m) {
        throw Error("domain.nodes and domain.spacing_m say the same thing: give one of them");
    }
    if (e.domain.spacing_m) return *e.domain.spacing_m;
    if (!e.domain.nodes) throw Error("domain.nodes (or domain.spacing_m) is needed");
    return std::sqrt(area_m2 / *e.domain.nodes);
}

void refuse_points(const Experiment& e) {
    if (e.domain.points) throw Error("domain.points does not apply to a raster mesh, whose nodes are its cells");
}

/// Cells of `spacing` around the middle of a bounding box, and which of them have their centre in the rings.
struct Cells {
    Grid grid;
    Point low;
    std::vector<std::uint8_t> inside;
    double count = 0;
};

/// Even-odd filling along the centres of each row.
void mark_inside(const std::vector<Polygon>& rings, double spacing, Cells& cells) {
    std::vector<double> crossings;
    for (Index row = 0; row < cells.grid.rows; ++row) {
        const double y = cells.low.y + (cells.grid.rows - 0.5 - row) * spacing;
        crossings.clear();
        for (const Polygon& ring : rings) {
            for (std::size_t i = 0; i < ring.size(); ++i) {
                const Point& a = ring[i];
                const Point& b = ring[(i + 1) % ring.size()];
                if ((a.y <= y) == (b.y <= y)) continue;
                const double x = a.x + (y - a.y) * ((b.x - a.x) / (b.y - a.y));
                crossings.push_back((x - cells.low.x) / spacing - 0.5);
            }
        }
        std::sort(crossings.begin(), crossings.end());
        for (std::size_t i = 0; i + 1 < crossings.size(); i += 2) {
            const double first = std::max(0.0, std::ceil(crossings[i]));
            const double last = std::min<double>(cells.grid.cols, std::ceil(crossings[i + 1]));
            for (double col = first; col < last; ++col) {
                cells.inside[std::size_t{row} * cells.grid.cols + static_cast<std::size_t>(col)] = 1;
                ++cells.count;
            }
        }
    }
}

Cells cells_in(const std::vector<Polygon>& rings, double spacing) {
    const auto [low, high] = evolve::bounding_box(rings.front());
    const double cols = std::max(1.0, std::ceil((high.x - low.x) / spacing - 1e-9));
    const double rows = std::max(1.0, std::ceil((high.y - low.y) / spacing - 1e-9));
    if (rows * cols >= none) {
        throw Error(fmt::format("{} x {} cells are more than 32-bit numbers can count", rows, cols));
    }
    Cells cells;
    cells.grid = plane_grid(static_cast<Index>(rows), static_cast<Index>(cols), spacing, spacing);
    cells.low = {(low.x + high.x - cols * spacing) / 2, (low.y + high.y - rows * spacing) / 2};
    cells.inside.assign(cells.grid.size(), 0);
    mark_inside(rings, spacing, cells);
    return cells;
}

/// Corrects the size of the cells until their number is met within 2 %.
Cells cells_by_count(const std::vector<Polygon>& rings, double spacing, Index wanted, std::uint64_t seed) {
    Random jitter(seed, 0x63656c6c);
    for (int attempt = 0; attempt < 200; ++attempt) {
        Cells cells = cells_in(rings, spacing);
        if (std::abs(cells.count - wanted) <= 0.02 * wanted) return cells;
        spacing *= std::sqrt(std::max(cells.count, 1.0) / wanted);
        if (attempt >= 4) spacing *= 0.95 + 0.1 * jitter.uniform();
    }
    throw Error(fmt::format("no size of cells gives {} of them in this outline: ask for more, or for domain.spacing_m",
                            wanted));
}

/// Columns and rows whose product is within 2 % of the wanted number; of those the squarest cells.
std::pair<double, double> columns_and_rows(const Experiment& e) {
    const double width = e.domain.size_m[0], height = e.domain.size_m[1];
    const double spacing = spacing_in(e, width * height);
    const std::pair<double, double> plain{std::round(width / spacing), std::round(height / spacing)};
    if (!e.domain.nodes) return plain;
    if (!(std::max(plain.first, plain.second) < none)) {
        throw Error(fmt::format("a domain of {} x {} m is too narrow for {} cells: they would make one line", width,
                                height, *e.domain.nodes));
    }
    const double wanted = *e.domain.nodes;
    const auto missed = [&](double cols, double rows) { return std::abs(cols * rows - wanted) > 0.02 * wanted; };
    if (!missed(plain.first, plain.second)) return plain;
    std::pair<double, double> best = plain;
    double least = std::numeric_limits<double>::infinity();
    for (double rows = std::max(3.0, plain.second - 8); rows <= plain.second + 8; ++rows) {
        const double cols = std::max(3.0, std::round(wanted / rows));
        const double oblong = std::abs(std::log(width / cols * rows / height));
        if (missed(cols, rows) || !(oblong < least)) continue;
        least = oblong;
        best = {cols, rows};
    }
    if (std::isinf(least)) {
        throw Error(
            fmt::format("no raster of whole rows and columns has {} cells within 2 %: ask for another number, or "
                        "for domain.spacing_m",
                        wanted));
    }
    return best;
}

void check_any_inside(const std::vector<Boundary>& boundary, const std::vector<std::uint8_t>& inside) {
    for (std::size_t i = 0; i < boundary.size(); ++i) {
        if (inside[i] && boundary[i] == Boundary::interior) return;
    }
    throw Error("all nodes lie on the rim, so nothing can be eroded: ask for more nodes");
}

}  // namespace

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

std::vector<Boundary> open_rim(const Grid& grid, const std::vector<std::uint8_t>& inside) {
    std::vector<double> data(inside.size());
    std::transform(inside.begin(), inside.end(), data.begin(), [](std::uint8_t in) { return in ? 0.0 : nan; });
    std::vector<Boundary> boundary = terrain::data_edge(grid, data);
    for (std::size_t i = 0; i < boundary.size(); ++i) {
        if (!inside[i]) boundary[i] = Boundary::interior;
    }
    return boundary;
}

Site tin_site(const Experiment& e, const PolygonPart& outline_m, const std::string& crs_wkt, double unit_m) {
    const auto pattern = e.domain.points.value_or(mesh::PointPattern::poisson);
    spacing_in(e, 1);
    const mesh::PointSet points = e.domain.spacing_m
                                      ? mesh::place_points(outline_m, pattern, *e.domain.spacing_m, e.seed)
                                      : mesh::place_points_count(outline_m, pattern, *e.domain.nodes, e.seed);
    Mesh mesh = mesh::triangulate(outline_m, points);
    Site site;
    site.domain.unit_m = unit_m;
    site.domain.placement.crs_wkt = crs_wkt;
    site.domain.area_m2 = area_of(outline_m);
    site.rim.rings = mesh::simple_rings(outline_m);
    for (Index node = 0; node < mesh.size(); ++node) {
        site.nodes.plane_m.push_back({mesh.x[node], mesh.y[node]});
        site.nodes.map.push_back({mesh.x[node] / unit_m, mesh.y[node] / unit_m});
        site.rim.boundary.push_back(mesh.on_outline[node] ? Boundary::open : Boundary::interior);
    }
    site.nodes.inside.assign(mesh.size(), 1);
    site.nodes.box_m = evolve::bounding_box(mesh.outline);
    site.nodes.crs_wkt = crs_wkt;
    site.nodes.unit_m = unit_m;
    site.domain.topology = std::move(mesh);
    check_any_inside(site.rim.boundary, site.nodes.inside);
    return site;
}

Site raster_site(const Experiment& e, const PolygonPart& outline_m, const std::string& crs_wkt, double unit_m) {
    refuse_points(e);
    Site site;
    site.rim.rings = mesh::simple_rings(outline_m);
    const double spacing = spacing_in(e, area_of(outline_m));
    const Cells cells = e.domain.nodes ? cells_by_count(site.rim.rings, spacing, *e.domain.nodes, e.seed)
                                       : cells_in(site.rim.rings, spacing);
    const double side = cells.grid.east_west[0];
    site.domain.unit_m = unit_m;
    site.domain.placement = {.west = cells.low.x / unit_m,
                             .north = (cells.low.y + cells.grid.rows * side) / unit_m,
                             .cell_width = side / unit_m,
                             .cell_height = side / unit_m,
                             .crs_wkt = crs_wkt,
                             .geographic = false};
    site.domain.area_m2 = cells.count * side * side;
    site.nodes.plane_m = plane_positions(cells.grid);
    for (Point& p : site.nodes.plane_m) p = {p.x + cells.low.x, p.y + cells.low.y};
    for (const Point& p : site.nodes.plane_m) site.nodes.map.push_back({p.x / unit_m, p.y / unit_m});
    site.nodes.inside = cells.inside;
    site.nodes.box_m = evolve::bounding_box(site.rim.rings.front());
    site.nodes.crs_wkt = crs_wkt;
    site.nodes.unit_m = unit_m;
    site.rim.boundary = open_rim(cells.grid, cells.inside);
    site.domain.topology = cells.grid;
    check_any_inside(site.rim.boundary, site.nodes.inside);
    return site;
}

Site rectangle_raster_site(const Experiment& e) {
    refuse_points(e);
    const double width = e.domain.size_m[0], height = e.domain.size_m[1];
    const auto [cols, rows] = columns_and_rows(e);
    if (!(rows >= 3 && cols >= 3)) {
        throw Error(fmt::format("a raster mesh of {} x {} cells has no inside: it needs at least 3 x 3", rows, cols));
    }
    if (rows * cols >= none) {
        throw Error(fmt::format("{} x {} cells are more than 32-bit numbers can count", rows, cols));
    }
    const Grid grid = plane_grid(static_cast<Index>(rows), static_cast<Index>(cols), width / cols, height / rows);
    Site site;
    site.domain.area_m2 = width * height;
    site.domain.placement = {.west = 0,
                             .north = height,
                             .cell_width = grid.east_west[0],
                             .cell_height = grid.north_south[0],
                             .crs_wkt = "",
                             .geographic = false};
    site.nodes.plane_m = plane_positions(grid);
    site.nodes.map = site.nodes.plane_m;
    site.nodes.inside.assign(grid.size(), 1);
    site.nodes.box_m = {{0, 0}, {width, height}};
    site.rim.rings = {{{0, 0}, {width, 0}, {width, height}, {0, height}}};
    site.rim.boundary = open_rim(grid, site.nodes.inside);
    site.domain.topology = grid;
    return site;
}

}  // namespace thalweg::study
