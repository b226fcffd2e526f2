// SPDX-License-Identifier: GPL-3.0-or-later
// From an experiment to a grown terrain, and how that is measured.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "study/grown_outputs.hpp"
#include "study/growth_frames.hpp"
#include "study/stopwatch.hpp"
#include "thalweg/core/error.hpp"
#include "thalweg/evolve/noise.hpp"
#include "thalweg/grow/elevations.hpp"
#include "thalweg/study/channel_heads.hpp"
#include "thalweg/study/grow.hpp"
#include "thalweg/surface/heightfield.hpp"
#include "thalweg/surface/patch.hpp"
#include "thalweg/surface/roughness.hpp"

namespace thalweg::study {
namespace {

constexpr std::uint64_t roughness_seed = 0x726f756768;

double extra_tension_of(const Experiment& e, grow::EdgeKind kind) {
    return kind == grow::EdgeKind::channel ? e.growth.extra_tension_channel : e.growth.extra_tension_divide;
}

bool less_by_ends(const grow::Edge& a, const grow::Edge& b) {
    return std::minmax(a.from, a.to) < std::minmax(b.from, b.to);
}

/// Extra tension of the lines, and of all other edges: those across valley sides.
std::vector<surface::ExtraTension> extra_tensions(const Experiment& e, const grow::SurfaceMesh& mesh) {
    std::vector<surface::ExtraTension> extra;
    for (const grow::Edge& line : mesh.lines) {
        const double tension = extra_tension_of(e, line.kind);
        if (tension > 0) extra.push_back({line.from, line.to, tension});
    }
    if (!(e.growth.extra_tension_side > 0)) return extra;
    std::vector<grow::Edge> lines = mesh.lines;
    std::sort(lines.begin(), lines.end(), less_by_ends);
    for (const auto& t : mesh.triangles) {
        for (int k = 0; k < 3; ++k) {
            const grow::Edge edge{t[k], t[(k + 1) % 3], grow::EdgeKind::divide};
            // Both triangles at an edge across a valley side run along it, one each way.
            if (edge.from > edge.to || std::binary_search(lines.begin(), lines.end(), edge, less_by_ends)) continue;
            extra.push_back({edge.from, edge.to, e.growth.extra_tension_side});
        }
    }
    return extra;
}

/// No gradient beyond that of the steepest valley side, where it is not the channel's own: of two vertices that lie
/// very near to each other the gradient may be as of a wall, and a smooth surface would carry it far beyond them.
Index limit_gradients(const grow::Network& network, GrownSurface& s) {
    double steepest = 0;
    for (const auto& [left, right] : network.sidewall_slope) steepest = std::max({steepest, left, right});
    const bool channels_stay = s.thalweg == grow::Thalweg::along_channel;
    Index limited = 0;
    for (Index vertex = 0; vertex < s.mesh.size(); ++vertex) {
        double &x = s.network.slope_x[vertex], &y = s.network.slope_y[vertex];
        const double slope = std::hypot(x, y);
        if (!(slope > steepest) || (channels_stay && s.mesh.on_channel[vertex])) continue;
        x *= steepest / slope;
        y *= steepest / slope;
        ++limited;
    }
    return limited;
}

GrownSurface surface_over(const Experiment& e, const grow::Network& network, grow::SurfaceMesh mesh) {
    GrownSurface s;
    s.mesh = std::move(mesh);
    for (const std::uint8_t channel : s.mesh.on_channel) {
        s.tension.push_back(channel ? e.growth.tension_channel : e.growth.tension_ridge);
    }
    s.extra_tension = extra_tensions(e, s.mesh);
    s.thalweg = e.growth.thalweg;
    s.network = surface::minimum_norm_network(s.tension_mesh());
    s.limited_gradients = limit_gradients(network, s);
    return s;
}

surface::FractalRoughness fractal_of(const Experiment& e, const grow::Dials& dials, double cell_m) {
    return {.amplitude_m = e.growth.roughness_m,
            .reference_m = surface_spacing_m(dials),
            .hurst = e.growth.roughness_hurst,
            .finest_m = e.growth.roughness_finest_m.value_or(cell_m),
            .seed = dials.seed ^ roughness_seed};
}

/// Drops as Flint's law makes them: differences of elevations would lose their digits far above the sea.
channel::StreamNetwork tree_of(const grow::Network& network, const grow::Flint& flint, double base_level_m) {
    channel::StreamNetwork tree = grow::stream_network(network, grow::elevations(network, flint, base_level_m));
    for (Index link = 0; link < network.size(); ++link) {
        tree.drop_m[link] = grow::gradient(flint, network.magnitude[link]) * network.length_m[link];
    }
    return tree;
}

/// On the plane, from the network's origin.
Raster evaluated(const Experiment& e, const GrownSurface& s, const grow::Dials& dials) {
    constexpr Index usual_resolution = 512;
    const Mesh plane = plane_mesh(s.mesh);
    Raster raster = surface::covering_raster(plane, e.output.resolution.value_or(usual_resolution));
    surface::evaluate(s.tension_mesh(), surface::tension_patches(s.tension_mesh(), s.network), raster);
    if (!(e.growth.roughness_m > 0)) return raster;
    if (e.growth.roughness_kind == RoughnessKind::subdivision) {
        surface::add_roughness(plane, ridge_share(s.mesh), fractal_of(e, dials, raster.grid.east_west[0]), raster);
        return raster;
    }
    Raster share = raster;
    surface::interpolate_linear(plane, ridge_share(s.mesh), share);
    std::vector<Point> centers;
    for (Index cell = 0; cell < raster.grid.size(); ++cell) {
        centers.push_back(raster.placement.center(raster.grid.row(cell), raster.grid.col(cell)));
    }
    const std::vector<double> rough = roughness(e, dials, centers, share.values);
    for (Index cell = 0; cell < raster.grid.size(); ++cell) raster.values[cell] += rough[cell];
    return raster;
}

void put_on_map(const GrowthSite& site, Raster& raster) {
    Placement& place = raster.placement;
    place.west = (place.west + site.basin.outlet.x) / site.unit_m;
    place.north = (place.north + site.basin.outlet.y) / site.unit_m;
    place.cell_width /= site.unit_m;
    place.cell_height /= site.unit_m;
    place.crs_wkt = site.crs_wkt;
}

/// The drainage area from which on the flow paths are as long as wanted.
double area_for_length(const RoutedTerrain& terrain, double length_m) {
    std::vector<Index> nodes = terrain.graph.order;
    const auto& area = terrain.drainage_area_m2;
    std::sort(nodes.begin(), nodes.end(),
              [&](Index a, Index b) { return area[a] != area[b] ? area[a] > area[b] : a < b; });
    double sum = 0;
    for (const Index node : nodes) {
        sum += terrain.graph.length[node];
        if (sum >= length_m) return area[node];
    }
    return area[nodes.back()];
}

/// Grown once more, now that it is known how large the network becomes: growth takes a microsecond per link.
std::vector<grow::Network> stages_of(const GrownTerrain& t, Index frames) {
    grow::Stages stages{.links = links_shown(t.growth.network.size(), frames), .networks = {}};
    stages.links.pop_back();
    grow::grow(t.site.basin, t.dials, stages);
    stages.networks.push_back(t.growth.network);
    return std::move(stages.networks);
}

}  // namespace

double surface_spacing_m(const grow::Dials& dials) { return 0.5 * dials.channel_maintenance_m; }

Mesh plane_mesh(const grow::SurfaceMesh& mesh) {
    Mesh plane;
    plane.x = mesh.x;
    plane.y = mesh.y;
    plane.triangles = mesh.triangles;
    return plane;
}

std::vector<double> ridge_share(const grow::SurfaceMesh& mesh) {
    std::vector<double> share;
    for (const std::uint8_t channel : mesh.on_channel) share.push_back(channel ? 0 : 1);
    return share;
}

std::vector<double> roughness(const Experiment& e, const grow::Dials& dials, std::span<const Point> places,
                              std::span<const double> ridge_share) {
    const evolve::Fractal fractal{.octaves = 5, .lacunarity = 2, .persistence = 0.5, .scale = 2};
    std::vector<double> rough = evolve::fractal_noise(places, dials.channel_maintenance_m, dials.seed ^ roughness_seed,
                                                      evolve::NoiseVariant::fbm, fractal);
    for (std::size_t i = 0; i < rough.size(); ++i) rough[i] *= e.growth.roughness_m * ridge_share[i];
    return rough;
}

std::vector<double> roughness_at(const Experiment& e, const GrownTerrain& t, std::span<const Point> places) {
    const grow::SurfaceMesh& mesh = t.surface.mesh;
    if (!(e.growth.roughness_m > 0)) return std::vector<double>(places.size(), 0);
    if (e.growth.roughness_kind == RoughnessKind::subdivision) {
        return surface::roughness_at(plane_mesh(mesh), ridge_share(mesh),
                                     fractal_of(e, t.dials, t.elevation.grid.east_west[0]), places);
    }
    return roughness(e, t.dials, places, surface::interpolate_linear_at(plane_mesh(mesh), ridge_share(mesh), places));
}

GrownTerrain grown_terrain(const Experiment& e, GrowthSite site, const Messages& messages) {
    GrownTerrain t;
    t.dials = dials_of(e);
    t.site = std::move(site);
    messages.progress("growing the network");
    const Stopwatch growing;
    t.growth = grow::grow(t.site.basin, t.dials);
    const grow::Network& network = t.growth.network;
    if (e.output.frames > 0) t.stages = stages_of(t, e.output.frames);
    t.site.basin.outlet = network.origin;
    t.tree = tree_of(network, t.dials.flint, t.site.basin.base_level_m);
    t.seconds.grow = growing.seconds();
    messages.progress(fmt::format("drawing the surface over {} links", network.size()));
    const Stopwatch triangulating;
    grow::SurfaceMesh mesh =
        grow::surface_mesh(network, t.dials.flint, t.site.basin.base_level_m, surface_spacing_m(t.dials));
    t.seconds.triangulate = triangulating.seconds();
    const Stopwatch solving;
    t.surface = surface_over(e, network, std::move(mesh));
    t.seconds.gradients = solving.seconds();
    const Stopwatch evaluating;
    t.elevation = evaluated(e, t.surface, t.dials);
    t.seconds.evaluate = evaluating.seconds();
    put_on_map(t.site, t.elevation);
    return t;
}

MeasureOptions measure_options(const GrownTerrain& t) {
    MeasureOptions options;
    options.catchment_outlet = outlet_cell(t.elevation, t.site);
    const RasterMeasurement m = measure_raster(t.elevation, options);
    options.channel_area_m2 = area_for_length(m.terrain, grow::total_length(t.growth.network));
    return options;
}

ChannelHeads grown_heads(const GrownTerrain& t) {
    return channel_heads_on(t.elevation, map_places(t.site, t.growth.network, source_vertices(t.growth.network)));
}

}  // namespace thalweg::study
