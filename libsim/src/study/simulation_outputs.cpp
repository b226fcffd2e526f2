// SPDX-License-Identifier: GPL-3.0-or-later
#include "study/simulation_outputs.hpp"

#include <cmath>

#include "thalweg/core/error.hpp"
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
Raster interpolated(const Mesh& mesh, const std::vector<double>& elevation_m, const Experiment& e) {
    constexpr Index usual_resolution = 512;
    Raster raster = surface::covering_raster(mesh, e.output.resolution.value_or(usual_resolution));
    interpolate(mesh, elevation_m, e, raster);
    return raster;
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

Raster elevation_raster(const Grid& grid, const Domain& domain, const std::vector<double>& elevation_m,
                        const Experiment&) {
    return {grid, domain.placement, elevation_m};
}

Raster elevation_raster(const Mesh& mesh, const Domain& domain, const std::vector<double>& elevation_m,
                        const Experiment& e) {
    Raster raster = interpolated(mesh, elevation_m, e);
    put_on_map(domain, raster.placement);
    return raster;
}

Heightfield heightfield(const Grid& grid, const Domain& domain, const Finished& f, const Experiment& e) {
    if (e.output.resolution) {
        throw Error("output.resolution does not apply to a raster mesh: it is written at its own cells");
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

PositionOf map_positions(const Domain& domain, const Raster& elevation) {
    if (std::holds_alternative<Grid>(domain.topology)) return positions(elevation);
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
    io::write_geopackage(folder / "network.gpkg",
                         network_layers(s, position, std::move(outlines)),
                         e.placement.crs_wkt);
    io::write_csv(folder / "slope_area_nodes.csv", node_table(f));
    write_statistics(s, position, folder);
    io::write_csv(folder / "history.csv", history_table(o.history));
}

}  // namespace thalweg::study
