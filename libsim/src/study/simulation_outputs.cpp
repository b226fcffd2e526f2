// SPDX-License-Identifier: GPL-3.0-or-later
#include "study/simulation_outputs.hpp"

#include <cmath>

#include "thalweg/core/error.hpp"
#include "thalweg/io/geodesy.hpp"
#include "thalweg/io/image_file.hpp"
#include "thalweg/io/polygonize.hpp"
#include "thalweg/io/raster_file.hpp"
#include "thalweg/io/table_file.hpp"
#include "thalweg/surface/heightfield.hpp"

namespace thalweg::study {
namespace {

constexpr double nan = std::numeric_limits<double>::quiet_NaN();

Table node_table(const Finished& f) {
    std::vector<double> area, slope;
    std::vector<std::int64_t> limited;
    for (Index node = 0; node < f.terrain.graph.size(); ++node) {
        if (!(f.law_slope[node] > 0)) continue;
        area.push_back(f.law_area_m2[node]);
        slope.push_back(f.law_slope[node]);
        limited.push_back(f.talus_limited[node]);
    }
    return {.name = "slope_area_nodes",
            .columns = {{"area_m2", area}, {"slope", slope}, {"talus_limited", limited}},
            .kind = GeometryKind::no_geometry,
            .geometry = {}};
}

Table history_table(const std::vector<evolve::StepRecord>& history) {
    std::vector<std::int64_t> step, lakes;
    std::vector<double> time, highest, mean, max_rate, mean_rate, seconds;
    for (const auto& r : history) {
        step.push_back(r.step);
        time.push_back(r.time_yr);
        lakes.push_back(r.lakes);
        highest.push_back(r.elevation_max_m);
        mean.push_back(r.elevation_mean_m);
        max_rate.push_back(r.max_rate_m_per_yr);
        mean_rate.push_back(r.mean_rate_m_per_yr);
        seconds.push_back(r.seconds);
    }
    return {.name = "history",
            .columns = {{"step", step},
                        {"time_yr", time},
                        {"lakes", lakes},
                        {"elevation_max_m", highest},
                        {"elevation_mean_m", mean},
                        {"max_rate_m_per_yr", max_rate},
                        {"mean_rate_m_per_yr", mean_rate},
                        {"seconds", seconds}},
            .kind = GeometryKind::no_geometry,
            .geometry = {}};
}

template <class T>
std::vector<T> pick(const std::vector<T>& values, const std::vector<Index>& node, T outside) {
    std::vector<T> picked(node.size(), outside);
    for (std::size_t i = 0; i < node.size(); ++i) {
        if (node[i] != none) picked[i] = values[node[i]];
    }
    return picked;
}

/// Mean distance that square cells of the nodes' mean area would have.
double mean_spacing(const Mesh& mesh) {
    double area = 0;
    for (const double cell : mesh.cell_area) area += cell;
    return std::sqrt(area / mesh.size());
}

void interpolate(const Mesh& mesh, const std::vector<double>& values, const Experiment& e, Raster& raster) {
    switch (e.output.interpolation) {
        case Interpolation::linear:
            return surface::interpolate_linear(mesh, values, raster);
        case Interpolation::natural:
            return surface::interpolate_natural(mesh, values, raster);
        case Interpolation::gaussian:
            break;
    }
    const double sigma_m = e.output.sigma_cells ? *e.output.sigma_cells * raster.grid.east_west[0] : mean_spacing(mesh);
    surface::interpolate_gaussian(mesh, values, sigma_m, raster);
}

io::Layer layer(const Experiment& e, std::string description) {
    const bool cloud = e.output.geotiff == GeotiffKind::cog;
    return {.nodata = {},
            .description = std::move(description),
            .layout = cloud ? io::Layout::cloud_optimized : io::Layout::tiled};
}

/// On the mesh's own plane, in metres.
Index resolution_of(const Experiment& e) {
    constexpr Index usual_resolution = 512;
    return e.output.resolution.value_or(usual_resolution);
}

Raster interpolated(const Mesh& mesh, const std::vector<double>& elevation_m, const Experiment& e) {
    Raster raster = surface::covering_raster(mesh, resolution_of(e));
    interpolate(mesh, elevation_m, e, raster);
    return raster;
}

/// A grid of `resolution` cells along the longer side over the same ground, square in the map's units, from the same
/// north-west corner.
Raster covering_cells(const Raster& cells, Index resolution) {
    const Placement& old = cells.placement;
    const double width = cells.grid.cols * old.cell_width, height = cells.grid.rows * old.cell_height;
    Raster cover{{}, old, {}};
    const double size = std::max(width, height) / resolution;
    const auto count = [&](double side) { return static_cast<Index>(std::ceil(side / size - 1e-9)); };
    cover.placement.cell_width = cover.placement.cell_height = size;
    const Index rows = count(height), cols = count(width);
    cover.grid = old.geographic ? io::geographic_grid(rows, cols, old.north, size, size)
                                : plane_grid(rows, cols, cells.grid.east_west[0] * size / old.cell_width,
                                             cells.grid.north_south[0] * size / old.cell_height);
    return cover;
}

/// Bilinear between the centres of the cells, no data in cells without.
Raster resampled(const Raster& cells, Index resolution) {
    Raster cover = covering_cells(cells, resolution);
    const io::Image image{.rows = cells.grid.rows, .cols = cells.grid.cols, .values = cells.values};
    const double across = cover.placement.cell_width / cells.placement.cell_width;
    const double down = cover.placement.cell_height / cells.placement.cell_height;
    for (Index node = 0; node < cover.grid.size(); ++node) {
        const double column = (cover.grid.col(node) + 0.5) * across, row = (cover.grid.row(node) + 0.5) * down;
        cover.values.push_back(io::bilinear(image, column, row));
    }
    return cover;
}

/// The cell that holds the centre of each cell of another grid over it; `none` outside, and where that one has no data.
std::vector<Index> cells_under(const Raster& cover, const Raster& cells) {
    std::vector<Index> under(cover.grid.size());
    for (Index node = 0; node < cover.grid.size(); ++node) {
        under[node] = cell_at(cells, cover.placement.center(cover.grid.row(node), cover.grid.col(node)));
        if (std::isnan(cover.values[node])) under[node] = none;
    }
    return under;
}

/// From that plane to the map.
void put_on_map(const Domain& domain, Placement& place) {
    place.crs_wkt = domain.placement.crs_wkt;
    place.west /= domain.unit_m;
    place.north /= domain.unit_m;
    place.cell_width /= domain.unit_m;
    place.cell_height /= domain.unit_m;
}

}  // namespace

void check_heightfield(const Grid& grid, const Domain& domain, const Experiment& e) {
    if (e.output.interpolation != Interpolation::linear) {
        throw Error(
            "output.interpolation does not apply to a raster mesh, which has a height in every cell: leave it out");
    }
    if (e.output.resolution) covering_cells({grid, domain.placement, {}}, *e.output.resolution);
}

void check_heightfield(const Mesh& mesh, const Domain&, const Experiment& e) {
    surface::covering_grid(mesh, resolution_of(e));
}

Raster elevation_raster(const Grid& grid, const Domain& domain, const std::vector<double>& elevation_m,
                        const Experiment& e) {
    Raster cells{grid, domain.placement, elevation_m};
    return e.output.resolution ? resampled(cells, *e.output.resolution) : cells;
}

Raster elevation_raster(const Mesh& mesh, const Domain& domain, const std::vector<double>& elevation_m,
                        const Experiment& e) {
    Raster raster = interpolated(mesh, elevation_m, e);
    put_on_map(domain, raster.placement);
    return raster;
}

Heightfield heightfield(const Grid& grid, const Domain& domain, const Finished& f, const Experiment& e) {
    if (e.output.resolution) {
        const Raster cells{grid, domain.placement, f.terrain.elevation_m};
        Heightfield h{.elevation = resampled(cells, *e.output.resolution)};
        const std::vector<Index> node = cells_under(h.elevation, cells);
        h.drainage_area_m2 = pick(f.law_area_m2, node, nan);
        h.basin_of = pick(f.statistics.basin_of, node, none);
        return h;
    }
    Heightfield h{{grid, domain.placement, f.terrain.elevation_m}, f.law_area_m2, f.statistics.basin_of};
    for (Index node = 0; node < grid.size(); ++node) {
        if (std::isnan(f.terrain.elevation_m[node])) h.drainage_area_m2[node] = nan;
    }
    return h;
}

Heightfield heightfield(const Mesh& mesh, const Domain& domain, const Finished& f, const Experiment& e) {
    Heightfield h;
    h.elevation = interpolated(mesh, f.terrain.elevation_m, e);
    const std::vector<Index> node = surface::nearest_node(mesh, h.elevation);
    h.drainage_area_m2 = pick(f.law_area_m2, node, nan);
    h.basin_of = pick(f.statistics.basin_of, node, none);
    put_on_map(domain, h.elevation.placement);
    return h;
}

PositionOf map_positions(const Domain& domain) {
    if (const Grid* grid = std::get_if<Grid>(&domain.topology)) return positions(Raster{*grid, domain.placement, {}});
    return [&domain](Index node) {
        return Point{domain.positions_m[node].x / domain.unit_m, domain.positions_m[node].y / domain.unit_m};
    };
}

void write_results(const Heightfield& h, const Finished& f, const Outcome& o, const PositionOf& position,
                   const Experiment& experiment, const std::filesystem::path& folder) {
    const Raster& e = h.elevation;
    io::write_raster(folder / "elevation.tif", e.grid, e.placement, e.values, layer(experiment, "elevation (m)"));
    io::write_raster(folder / "drainage_area.tif", e.grid, e.placement, h.drainage_area_m2,
                     layer(experiment, "drainage area of the nearest node (m2)"));
    const Statistics& s = f.statistics;
    auto outlines = io::cell_outlines(e, h.basin_of, static_cast<Index>(s.basins.size()));
    io::write_geopackage(folder / "network.gpkg", network_layers(s, position, std::move(outlines)),
                         e.placement.crs_wkt);
    io::write_csv(folder / "slope_area_nodes.csv", node_table(f));
    write_statistics(s, position, folder);
    io::write_csv(folder / "history.csv", history_table(o.history));
}

}  // namespace thalweg::study
