// SPDX-License-Identifier: GPL-3.0-or-later
#include "thalweg/study/grow.hpp"

#include <fmt/format.h>

#include <cmath>
#include <limits>
#include <numbers>

#include "study/grown_outputs.hpp"
#include "study/growth_frames.hpp"
#include "study/noting.hpp"
#include "study/stopwatch.hpp"
#include "study/terrain_files.hpp"
#include "thalweg/channel/d8_length.hpp"
#include "thalweg/core/error.hpp"
#include "thalweg/io/raster_file.hpp"
#include "thalweg/io/table_file.hpp"
#include "thalweg/mesh/triangulate.hpp"
#include "thalweg/study/output_folder.hpp"

namespace thalweg::study {
namespace {

constexpr double degrees_per_radian = 180 / std::numbers::pi;
constexpr double within_cells = 2;  ///< so near a junction counts as found again

const char* name_of(grow::StopReason reason) {
    switch (reason) {
        case grow::StopReason::density_reached:
            return "the density is reached";
        case grow::StopReason::no_candidate:
            return "no link can take a tributary";
        case grow::StopReason::link_limit:
            break;
    }
    return "as many links as can be sensible: the dials would shrink links to nothing";
}

TerrainInput input_of(const GrownTerrain& t, const RasterMeasurement& m) {
    const Grid& grid = t.elevation.grid;
    TerrainInput input;
    input.rows = grid.rows;
    input.cols = grid.cols;
    input.dx_m = grid.east_west[0];
    input.dy_m = grid.north_south.empty() ? grid.east_west[0] : grid.north_south[0];
    input.valid_cells = m.valid_cells;
    input.nodata_cells = grid.size() - m.valid_cells;
    input.area_m2 = m.area_m2;
    return input;
}

double median_link_m(const GrownTerrain& t) {
    std::vector<double> lengths = t.growth.network.length_m;
    return quantile(std::move(lengths), 0.5);
}

/// Whether a junction found within so many cells of one grown says anything: where links are as short as that, there is
/// nearly always one.
bool can_be_found_again(const GrownTerrain& t) {
    return within_cells * t.elevation.grid.east_west[0] < median_link_m(t);
}

/// What an analysis of the raster finds again of the tree.
Json recovery_json(const GrownTerrain& t, const RasterMeasurement& m) {
    const grow::Network& network = t.growth.network;
    std::vector<Index> vertices;
    for (const grow::Junction& junction : network.junctions) vertices.push_back(junction.vertex);
    const double cell = t.elevation.placement.cell_width;
    const Recovery r = recovery(map_places(t.site, network, vertices), grow::total_length(network),
                                m.statistics.network, positions(t.elevation), within_cells * cell);
    const double known = can_be_found_again(t) ? 1 : std::numeric_limits<double>::quiet_NaN();
    return {{"junctions", r.grown},
            {"junctions_found", r.found},
            {"recovered_share", number(known * r.recovered / r.grown)},
            {"false_share", number(known * r.unmatched / r.found)},
            {"length_ratio", number(known * r.found_length_m / channel::d8_length_factor / r.tree_length_m)}};
}

Json angles_json(const GrownTerrain& t) {
    const TributaryAngles a = tributary_angles(t.growth.network, t.dials.flint);
    return {{"count", a.count},
            {"drawn_mean_deg", number(a.drawn_mean * degrees_per_radian)},
            {"drawn_sd_deg", number(a.drawn_sd * degrees_per_radian)},
            {"howard_mean_deg", number(a.howard_mean * degrees_per_radian)},
            {"howard_sd_deg", number(a.howard_sd * degrees_per_radian)}};
}

/// Valley sides less steep than their channel: no plane through the channel is as flat as they should be.
Index sides_flatter_than_channels(const GrownTerrain& t) {
    const grow::Network& network = t.growth.network;
    Index count = 0;
    for (Index link = 0; link < network.size(); ++link) {
        const double channel = grow::gradient(t.dials.flint, network.magnitude[link]);
        for (const double side : network.sidewall_slope[link]) count += side < channel;
    }
    return count;
}

/// How far the lowest and the highest cell lie from the outlet's height, at least 0 (m). Curves along a divide from a
/// high ridge may sag beyond its lower end, under the outlet.
struct Extent {
    double below, above;
};

Extent extent_about_outlet(const GrownTerrain& t) {
    const double outlet = t.site.basin.base_level_m;
    Extent extent{0, 0};
    for (const double height : t.elevation.values) {  // fmax: no data are NaN
        extent.below = std::fmax(extent.below, outlet - height);
        extent.above = std::fmax(extent.above, height - outlet);
    }
    return extent;
}

/// The terrain as `analyze` sees it, once with channels as long as the tree and once with its sources.
struct Measured {
    RasterMeasurement by_area, by_heads;
};

Measured measured(const GrownTerrain& t) {
    MeasureOptions options = measure_options(t);
    Measured m;
    m.by_area = measure_raster(t.elevation, options);
    options.heads = grown_heads(t);
    m.by_heads = measure_raster(t.elevation, options);
    return m;
}

Json summary_json(const GrownTerrain& t, const Measured& m) {
    const grow::Network& network = t.growth.network;
    const double length = grow::total_length(network), area = grow::total_area(network);
    std::vector<std::string> notes = t.site.warnings;
    notes.push_back("input: a grown terrain is no file and has no checksum");
    notes.push_back(
        "terrain.channels: begin at the drainage area that makes paths on the raster as long as the tree's links");
    const double outline = std::abs(mesh::polygon_area(t.site.basin.outline));
    Json summary{{"links", network.size()},
                 {"junctions", network.junctions.size()},
                 {"max_shreve", network.magnitude[0]},
                 {"basin_area_m2", outline},
                 {"polygon_area_sum_m2", area},
                 {"total_length_m", length},
                 {"drainage_density_per_m", length / area},
                 {"target_drainage_density_per_m", 1 / t.dials.channel_maintenance_m},
                 {"stop_reason", name_of(t.growth.stopped)},
                 {"lengthened", t.growth.lengthened},
                 {"refused", t.growth.refused},
                 {"last_resorts", t.growth.last_resorts},
                 {"elevation_max_m", number(m.by_area.statistics.hypsometry.maximum_m)},
                 {"vertices", t.surface.mesh.size()},
                 {"triangles", t.surface.mesh.triangles.size()},
                 {"limited_gradients", t.surface.limited_gradients},
                 {"sides_flatter_than_channels", sides_flatter_than_channels(t)},
                 {"dip_below_outlet_m", extent_about_outlet(t).below},
                 {"tributary_angles", angles_json(t)}};
    summary["tree"] = tree_json(tree_statistics(network, t.tree), notes);
    summary["terrain"] = terrain_json(input_of(t, m.by_area), m.by_area.statistics, positions(t.elevation),
                                      conditioning_json(m.by_area.conditioning, Conditioning::fill), notes);
    summary["terrain"]["measured_on"] = "raster";
    summary["terrain"]["routing"] = "d8";
    summary["recovery"] = {{"within_m", within_cells * t.elevation.grid.east_west[0]},
                           {"by_heads", recovery_json(t, m.by_heads)},
                           {"by_area", recovery_json(t, m.by_area)}};
    explain_null("recovery", summary["recovery"],
                 can_be_found_again(t)
                     ? "a share needs a junction"
                     : "two cells are longer than the median link, so that near every junction there is "
                       "one by chance; ask for more cells (output.resolution)",
                 notes);
    explain_null("tributary_angles", summary["tributary_angles"], "a mean needs a junction, its spread two", notes);
    summary["notes"] = notes;
    return summary;
}

/// Always an OBJ, and what is asked for besides.
std::vector<MeshFile> mesh_files(const Experiment& e) {
    std::vector<MeshFile> files{MeshFile::obj};
    if (e.output.mesh_file == MeshFile::ply) files.push_back(MeshFile::ply);
    return files;
}

Json write_terrain(const Experiment& e, const GrownTerrain& t, const std::filesystem::path& folder) {
    const Raster& z = t.elevation;
    const bool cloud = e.output.geotiff == GeotiffKind::cog;
    io::write_raster(folder / "elevation.tif", z.grid, z.placement, z.values,
                     {.nodata = {},
                      .description = "elevation (m)",
                      .layout = cloud ? io::Layout::cloud_optimized : io::Layout::tiled});
    const auto own = [&](const LocalMetres& local) {
        TriangleSurface surface = triangles_of(e, t);
        const Point& origin = t.growth.network.origin;
        for (double& x : surface.x) x += origin.x - local.origin.x * t.site.unit_m;
        for (double& y : surface.y) y += origin.y - local.origin.y * t.site.unit_m;
        return PlacedSurface{std::move(surface), local};
    };
    const double extent = std::max(z.grid.rows, z.grid.cols) * z.grid.east_west[0];
    return write_terrain_files(z, {.files = mesh_files(e), .surface = own, .extent_m = extent}, e, folder);
}

void check_outputs(Experiment e) {
    e.output.mesh_file = e.output.mesh_file.value_or(MeshFile::obj);
    check_terrain_files(e);
}

void warn(const Experiment& e, const GrownTerrain& t, const Messages& messages) {
    const double density = grow::total_length(t.growth.network) / grow::total_area(t.growth.network);
    const double wanted = 1 / t.dials.channel_maintenance_m;
    if (t.dials.stop == grow::Stop::density && density < 0.99 * wanted) {
        messages.warning(fmt::format("the drainage density came to {:.4g} per metre, not {:.4g}: {}", density, wanted,
                                     name_of(t.growth.stopped)));
    }
    if (const Index flat = sides_flatter_than_channels(t); flat > 0) {
        messages.warning(
            fmt::format("{} of {} valley sides are less steep than their channel: water on them runs beside it and not "
                        "to it; give a "
                        "smaller growth.flint_p or steeper growth.sidewall_angle_deg",
                        flat, 2 * t.growth.network.size()));
    }
    constexpr double worth_telling = 0.01;  // of what rises above the outlet
    const Extent extent = extent_about_outlet(t);
    if (extent.below > worth_telling * extent.above) {
        messages.warning(fmt::format(
            "the surface dips {:.3g} m below its outlet, between ridges of unlike heights or over low ones: give a "
            "larger growth.tension_ridge (20, say), a smaller growth.delta_sidewall_angle_deg or, where it is far "
            "less than growth.channel_maintenance_m, a larger growth.sidewall_reach_m",
            extent.below));
    }
    if (const Banks banks = banks_of(e, t); banks.beyond > 0) {
        messages.warning(
            fmt::format("{:.2g} % of the places on channels' banks lie beyond their valley side and are left out of "
                        "the mesh: give a "
                        "smaller growth.channel_width_m or growth.channel_width_exponent",
                        100.0 * static_cast<double>(banks.beyond) / static_cast<double>(banks.all)));
    }
    const double cell = t.elevation.grid.east_west[0];
    const double median = median_link_m(t);
    if (cell > median / 5) {
        messages.warning(fmt::format(
            "cells of {:.3g} m are coarse for links of {:.3g} m: the raster does not show every valley; "
            "ask for output.resolution = {:.0f}",
            cell, median, std::ceil(std::max(t.elevation.grid.rows, t.elevation.grid.cols) * cell * 15 / median)));
    }
}

/// Where not even the steepest valley side is as steep as exterior links, all water would run beside these.
void check_slopes(const grow::Dials& dials) {
    grow::check_dials(dials);
    const double steepest_deg = dials.sidewall_angle_deg + dials.delta_sidewall_angle_deg;
    const double steepest = std::tan(steepest_deg / degrees_per_radian);
    if (dials.flint.p < steepest) return;
    throw Error(
        fmt::format("growth.flint_p is {}, so exterior links are steeper than the steepest valley sides ({:.3g}, of {} "
                    "degrees), from which no water would come to them: give a smaller one, or steeper sides",
                    dials.flint.p, steepest, steepest_deg));
}

std::string write_all(Experiment e, const GrownTerrain& t, const std::filesystem::path& folder,
                      const Messages& messages) {
    messages.progress("measuring and writing");
    std::vector<std::string> warnings;
    warn(e, t, noting(messages, warnings));
    const Stopwatch writing;
    const Measured m = measured(t);
    Json summary = summary_json(t, m);
    for (const std::string& warning : warnings) summary["notes"].push_back(warning);
    summary.update(write_terrain(e, t, folder));
    if (e.output.frames > 0) summary["frames"] = write_frames(t, folder);
    io::write_geopackage(folder / "network.gpkg", grown_layers(e, t), t.site.crs_wkt);
    const Statistics& s = m.by_area.statistics;
    write_statistics(s, positions(t.elevation), folder);
    io::write_csv(folder / "slope_area_points.csv", slope_area_points_table(s.slope_area_points));
    e.basin.base_level_m = t.site.basin.base_level_m;
    write_text(folder / "experiment.toml", to_toml(e));
    const double output_seconds = writing.seconds();
    summary["seconds"] = {
        {"grow", t.seconds.grow},
        {"triangulate", t.seconds.triangulate},
        {"gradients", t.seconds.gradients},
        {"evaluate", t.seconds.evaluate},
        {"output", output_seconds},
        {"total", t.seconds.grow + t.seconds.triangulate + t.seconds.gradients + t.seconds.evaluate + output_seconds}};
    std::string text = text_of(summary);
    write_text(folder / "summary.json", text);
    return text;
}

}  // namespace

std::string grow(const Experiment& e, const std::filesystem::path& folder, const Messages& messages) {
    check_outputs(e);
    check_slopes(dials_of(e));
    return write_all(e, grown_terrain(e, growth_site(e, messages), messages), folder, messages);
}

std::string grow(const Experiment& e, const Catchment& catchment, const std::filesystem::path& folder,
                 const Messages& messages) {
    check_outputs(e);
    return write_all(e, grown_terrain(e, growth_site(catchment, dials_of(e)), messages), folder, messages);
}

}  // namespace thalweg::study
