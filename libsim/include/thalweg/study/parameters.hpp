// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

#include "thalweg/core/index.hpp"
#include "thalweg/core/point.hpp"
#include "thalweg/evolve/river.hpp"
#include "thalweg/evolve/tectonics.hpp"
#include "thalweg/grow/grow.hpp"
#include "thalweg/grow/surface_mesh.hpp"
#include "thalweg/mesh/points.hpp"
#include "thalweg/terrain/route.hpp"

namespace thalweg::study {

enum class MeshKind { tin, raster };
enum class OutletRule { all, dem, sides, uplift_below };
/// Where the rim looks to: eight sectors of 45°, the first about north, clockwise.
enum class Side { north, northeast, east, southeast, south, southwest, west, northwest };
enum class NoiseKind { perlin, uniform };
enum class InitialSurface { noise, dem };
enum class Solver { implicit, steady };
enum class Interpolation { gaussian, linear, natural };
enum class GeotiffKind { tiled, cog };
enum class HeightmapFile { png };
enum class MeshFile { obj, ply };
enum class FitMethod { slope_area };
enum class StudyModel { stream_power, growth };

/// Small roughness of a grown terrain.
enum class RoughnessKind : std::uint8_t {
    noise,       ///< five octaves of noise from half C down
    subdivision  ///< recursive subdivision of the surface's triangles, a fractal
};

/// Which nodes of the rim are outlets.
struct Outlets {
    OutletRule rule = OutletRule::all;
    std::vector<Side> sides = {};  ///< of `sides`
    double uplift_below = 0;       ///< of `uplift_below`: share of the largest uplift

    friend bool operator==(const Outlets&, const Outlets&) = default;
};

/// How something varies over the domain: the product of a pattern, an image and painted lines, each from 0 to 1.
struct Variation {
    evolve::Pattern pattern = evolve::Pattern::constant;
    double direction_deg = 0;
    Index steps = 4;
    evolve::NoiseVariant noise = evolve::NoiseVariant::fbm;
    double noise_scale = 4;
    std::optional<std::filesystem::path> field;
    std::vector<std::filesystem::path> lines;
    std::vector<double> lines_width_m;  ///< one for all files of lines, or one for each
    std::vector<double> lines_value;    ///< likewise
};

/// Corners of a line or polygon, or the vector file that holds it.
using Shape = std::variant<std::vector<Point>, std::filesystem::path>;

/// Everything an experiment file can say, with the defaults for what it does not say. Each member is described once, in
/// `describe` below: reading, overriding, writing, `--help` and the reference page all follow from there.
struct Experiment {
    std::uint64_t seed = 1;
    std::optional<Outlets> outlets;  ///< default: `dem` where the domain is a DEM's basin, else `all`
    struct {
        std::vector<double> size_m;
        std::optional<Index> nodes;
        std::optional<double> spacing_m;
        std::optional<MeshKind> mesh;  ///< default: TIN; in a study, the DEM's own raster
        std::optional<std::filesystem::path> dem;
        InitialSurface initial = InitialSurface::noise;
        std::optional<std::filesystem::path> outline;
        std::optional<mesh::PointPattern> points;  ///< of a TIN; default: Poisson disks
    } domain;
    struct : Variation {
        double rate_m_per_yr = 1e-3;
        std::optional<std::filesystem::path> history;
    } uplift;
    struct : Variation {
        double maximum = 1;
    } rainfall;
    struct {
        std::optional<double> k;
        std::optional<double> m;
        double n = 1;
        terrain::Receiver receiver = terrain::Receiver::steepest;
        evolve::Flow flow = evolve::Flow::single;
        double flow_exponent = 1.1;
        std::optional<std::filesystem::path> k_field;
    } river;
    struct {
        std::optional<std::filesystem::path> history;
    } base_level;
    struct {
        NoiseKind noise = NoiseKind::perlin;
        double amplitude_m = 0.01;
        double constant_m = 0;
        std::optional<std::filesystem::path> elevation;
    } initial;
    struct {
        std::optional<double> talus_angle_deg;
        double diffusivity_m2_per_yr = 0;
        double critical_slope = 0;
    } hillslope;
    struct {
        double g = 0;
    } deposition;
    struct {
        Solver solver = Solver::implicit;
        double step_yr = 100000;
        Index max_steps = 5000;
        double convergence = 1e-3;
    } time;
    struct {
        std::optional<Index> resolution;
        Interpolation interpolation = Interpolation::linear;
        std::optional<double> sigma_cells;
        GeotiffKind geotiff = GeotiffKind::tiled;
        std::optional<HeightmapFile> heightmap;
        std::optional<MeshFile> mesh_file;
        std::optional<MeshFile> heightfield_mesh_file;
        bool solid = false;
        std::optional<double> base_depth_m;
        std::optional<Index> snapshots_every;
        std::optional<Index> checkpoint_every;
        Index frames = 0;
    } output;
    struct {
        std::optional<Shape> outline;
        std::optional<Shape> trunk;          ///< from the outlet to the source
        std::optional<double> base_level_m;  ///< default: 0, or the DEM's height at the outlet
        std::optional<std::filesystem::path> dem;
    } basin;
    struct {
        std::optional<double> channel_maintenance_m;
        std::optional<double> sidewall_reach_m;  ///< none: valley sides rise however far off their link is
        grow::Dials dials;  ///< but for those two and `seed`, which stand elsewhere: see `dials_of`
        grow::Thalweg thalweg = grow::Thalweg::along_channel;
        double tension_channel = 5;
        double tension_ridge = 0;
        double extra_tension_channel = 0;  ///< along channels
        double extra_tension_divide = 0;   ///< along divides and the outline
        double extra_tension_side = 0;     ///< across valley sides
        double channel_width_m = 0;        ///< of exterior links
        double channel_width_exponent = 0.5;
        double roughness_m = 0;
        RoughnessKind roughness_kind = RoughnessKind::noise;
        double roughness_hurst = 0.7;
        std::optional<double> roughness_finest_m;  ///< default: a cell of the raster
    } growth;
    struct {
        std::optional<std::filesystem::path> dem;
        std::optional<std::string> source;          ///< of the fetcher's catalogue, instead of a DEM
        std::optional<std::array<double, 4>> bbox;  ///< west, south, east, north (degrees)
        std::string crs;                            ///< replaces the DEM's own
        std::optional<double> nodata;               ///< besides what the DEM declares
        std::optional<double> uplift_m_per_yr;
        double uplift_sd_m_per_yr = 0;
        FitMethod method = FitMethod::slope_area;
        std::vector<StudyModel> models{StudyModel::stream_power};
        std::optional<double> channel_area_m2;
        std::optional<double> area_min_m2;
        std::optional<double> area_max_m2;
        Index realisations = 0;
    } study;
};

/// What a parameter means: shown by `--help`, written beside its value, checked on reading.
struct Field {
    std::string_view key;   ///< "river.k"
    std::string_view unit;  ///< "" where it has none
    std::string_view text;
    double smallest = -std::numeric_limits<double>::infinity();
    double largest = std::numeric_limits<double>::infinity();
    bool smallest_excluded = false;
};

/// The words that stand for the values of an enumeration.
template <class E>
using Words = std::vector<std::pair<std::string_view, E>>;
const Words<MeshKind>& words(MeshKind);
const Words<Side>& words(Side);
const Words<mesh::PointPattern>& words(mesh::PointPattern);
const Words<evolve::NoiseVariant>& words(evolve::NoiseVariant);
const Words<NoiseKind>& words(NoiseKind);
const Words<InitialSurface>& words(InitialSurface);
const Words<Solver>& words(Solver);
const Words<Interpolation>& words(Interpolation);
const Words<GeotiffKind>& words(GeotiffKind);
const Words<HeightmapFile>& words(HeightmapFile);
const Words<MeshFile>& words(MeshFile);
const Words<FitMethod>& words(FitMethod);
const Words<StudyModel>& words(StudyModel);
const Words<RoughnessKind>& words(RoughnessKind);
const Words<grow::Stop>& words(grow::Stop);
const Words<grow::Divides>& words(grow::Divides);
const Words<grow::UpstreamLink>& words(grow::UpstreamLink);
const Words<grow::Thalweg>& words(grow::Thalweg);
const Words<evolve::Pattern>& words(evolve::Pattern);
const Words<terrain::Receiver>& words(terrain::Receiver);
const Words<evolve::Flow>& words(evolve::Flow);

/// The keys of a variation, in one table or the other.
struct VariationKeys {
    std::string_view pattern, direction_deg, steps, noise, noise_scale, field, lines, lines_width_m, lines_value;
};

template <class AnyVariation, class Visit>
void describe_variation(const VariationKeys& keys, AnyVariation& v, Visit& visit) {
    constexpr double infinity = std::numeric_limits<double>::infinity();
    visit(Field{keys.pattern, "", "its shape over the domain"}, v.pattern);
    visit(Field{keys.direction_deg, "degrees", "where a gradient or steps rise to, clockwise from north", -360, 360},
          v.direction_deg);
    visit(Field{keys.steps, "", "number of steps", 1, 10000}, v.steps);
    visit(Field{keys.noise, "", "kind of noise"}, v.noise);
    visit(Field{keys.noise_scale, "", "hills of the noise along the longer side", 0, 10000, true}, v.noise_scale);
    visit(Field{keys.field, "", "image or map that multiplies the shape, scaled to a largest value of 1"}, v.field);
    visit(Field{keys.lines, "", "vector file of rivers or ridges to be painted, or a list of files"}, v.lines);
    visit(
        Field{keys.lines_width_m, "m", "width of the painted corridors, for all files or one each", 0, infinity, true},
        v.lines_width_m);
    visit(Field{keys.lines_value, "", "value on the lines relative to elsewhere, for all files or one each", 0, 1e6},
          v.lines_value);
}

/// The basin to grow a network in, and the dials.
template <class AnyExperiment, class Visit>
void describe_growth(AnyExperiment& e, Visit& visit) {
    constexpr double infinity = std::numeric_limits<double>::infinity();
    visit(Field{"basin.outline", "",
                "outline of the basin: corners [[x, y], …] or a vector file with one polygon; grow needs it or a DEM"},
          e.basin.outline);
    visit(
        Field{
            "basin.trunk", "",
            "main stream: [[x, y], ...] from the outlet on the outline over its bends to a source inside, or a vector "
            "file with one line (bends of less than C/2 are left out); in the outline's coordinates"},
        e.basin.trunk);
    visit(Field{"basin.base_level_m", "m", "height of the outlet; default 0, with a DEM its own"},
          e.basin.base_level_m);
    visit(Field{"basin.dem", "", "DEM whose largest complete basin and main stream are taken, instead of an outline"},
          e.basin.dem);
    auto& g = e.growth;
    visit(Field{"growth.channel_maintenance_m", "m",
                "constant of channel maintenance C, basin area per channel length; grow needs it", 0, 1e9, true},
          g.channel_maintenance_m);
    visit(Field{"growth.mean_junction", "", "place of a tributary on its link, 0: lower, 1: upper end", 0, 1},
          g.dials.mean_junction);
    visit(Field{"growth.delta_junction", "", "spread of that place", 0, 1}, g.dials.delta_junction);
    visit(Field{"growth.mean_length", "", "length of a tributary, 1: to the edge of its polygon", 1e-3, 1},
          g.dials.mean_length);
    visit(Field{"growth.delta_length", "", "spread of that length", 0, 1}, g.dials.delta_length);
    visit(Field{"growth.flint_p", "m/m", "gradient of exterior links", 1e-9, 10}, g.dials.flint.p);
    visit(Field{"growth.flint_q", "", "exponent of gradient with 2·magnitude − 1", -2, -0.05}, g.dials.flint.q);
    visit(Field{"growth.sidewall_angle_deg", "degrees", "slope of valley sides", 1, 89}, g.dials.sidewall_angle_deg);
    visit(Field{"growth.delta_sidewall_angle_deg", "degrees", "spread of that slope", 0, 44},
          g.dials.delta_sidewall_angle_deg);
    visit(Field{"growth.sidewall_reach_m", "m",
                "distance from its link beyond which a valley side rises no more; default: it rises all the way", 0,
                1e9, true},
          g.sidewall_reach_m);
    visit(Field{"growth.lower_bias", "", "share of tributaries on the obtuse side of a stream's lower third", 0, 1},
          g.dials.lower_bias);
    visit(
        Field{"growth.middle_bias", "", "share on the side opposite the next one downstream in its middle third", 0, 1},
        g.dials.middle_bias);
    visit(Field{"growth.divides", "",
                "where the divides at a junction run: by the slopes of links and valley sides, or by drawn shares"},
          g.dials.divides);
    visit(Field{"growth.divide_across", "",
                "share of the angle from the link below to the one above at which the divide across from the tributary "
                "leaves; this and the following five for growth.divides = \"shares\"",
                0.1, 0.9},
          g.dials.divide_across.mean);
    visit(Field{"growth.delta_divide_across", "", "spread of that share", 0, 0.8}, g.dials.divide_across.delta);
    visit(Field{"growth.divide_below", "", "the same from the link below to the tributary", 0.1, 0.9},
          g.dials.divide_below.mean);
    visit(Field{"growth.delta_divide_below", "", "spread of that share", 0, 0.8}, g.dials.divide_below.delta);
    visit(Field{"growth.divide_above", "", "the same from the tributary to the link above", 0.1, 0.9},
          g.dials.divide_above.mean);
    visit(Field{"growth.delta_divide_above", "", "spread of that share", 0, 0.8}, g.dials.divide_above.delta);
    visit(Field{"growth.upstream_link", "", "whether an exterior link turns when it receives a tributary"},
          g.dials.upstream_link);
    visit(Field{"growth.stop", "", "stop at the drainage density wanted, or when no link can take a tributary"},
          g.dials.stop);
    visit(
        Field{"growth.thalweg", "", "the surface's gradient on channels: the channel's own, or found like all others"},
        g.thalweg);
    visit(Field{"growth.tension_channel", "", "tension of the surface at channels", 0, 1e6}, g.tension_channel);
    visit(Field{"growth.tension_ridge", "", "tension at divides and the outline", 0, 1e6}, g.tension_ridge);
    visit(Field{"growth.extra_tension_channel", "", "tension of edges along channels beyond the mean of their ends'", 0,
                1e6},
          g.extra_tension_channel);
    visit(Field{"growth.extra_tension_divide", "", "the same for edges along divides and the outline", 0, 1e6},
          g.extra_tension_divide);
    visit(Field{"growth.extra_tension_side", "", "the same for edges across valley sides", 0, 1e6},
          g.extra_tension_side);
    visit(Field{"growth.channel_width_m", "m", "width of an exterior link's channel; 0: channels are lines", 0, 1e6},
          g.channel_width_m);
    visit(Field{"growth.channel_width_exponent", "", "exponent of that width with the magnitude", 0, 2},
          g.channel_width_exponent);
    visit(Field{"growth.roughness_m", "m", "height of the surface's small roughness; 0: none", 0, 1e5}, g.roughness_m);
    visit(
        Field{"growth.roughness_kind", "", "octaves of noise, or a fractal by subdivision of the surface's triangles"},
        g.roughness_kind);
    visit(Field{"growth.roughness_hurst", "",
                "of subdivision: exponent of differences in height with distance, 1: smooth, 0: jagged", 0.01, 0.99},
          g.roughness_hurst);
    visit(Field{"growth.roughness_finest_m", "m",
                "of subdivision: edges up to that length are not divided further; "
                "default a cell of the raster",
                0, infinity, true},
          g.roughness_finest_m);
}

/// Calls visit(field, member) for every parameter, in the order of the file.
template <class AnyExperiment, class Visit>
void describe(AnyExperiment& e, Visit visit) {
    constexpr double infinity = std::numeric_limits<double>::infinity();
    visit(Field{"seed", "", "seed of everything random", 0}, e.seed);
    visit(
        Field{"outlets", "",
              "where water leaves: \"all\" of the rim (default), \"dem\" for the outlet of the DEM's basin (default "
              "where "
              "there is a DEM), a list of sides (\"north\", \"northeast\", …), or { uplift_below = 0.33 } for the rim "
              "where uplift is under that share of its largest value"},
        e.outlets);
    visit(
        Field{"domain.size_m", "m",
              "width and height of a rectangle; simulate needs this, domain.outline or domain.dem", 0, infinity, true},
        e.domain.size_m);
    visit(Field{"domain.nodes", "",
                "number of nodes, met within 2 %; needed, or domain.spacing_m, unless there is a DEM", 16, 2147483647},
          e.domain.nodes);
    visit(Field{"domain.spacing_m", "m", "distance of nodes, instead of their number", 0, infinity, true},
          e.domain.spacing_m);
    visit(
        Field{"domain.mesh", "", "points and their Delaunay triangles (default), or square cells (default of a study)"},
        e.domain.mesh);
    visit(Field{"domain.points", "", "how a TIN's points are placed; default \"poisson\", at random"}, e.domain.points);
    visit(Field{"domain.outline", "", "vector file with the polygon that is the domain, instead of a rectangle"},
          e.domain.outline);
    visit(Field{"domain.dem", "", "DEM whose largest complete basin is the domain, instead of a rectangle"},
          e.domain.dem);
    visit(Field{"domain.initial", "", "start from noise, or from the DEM's own heights"}, e.domain.initial);
    visit(Field{"uplift.rate_m_per_yr", "m/yr", "largest uplift rate", 0}, e.uplift.rate_m_per_yr);
    describe_variation({"uplift.pattern", "uplift.direction_deg", "uplift.steps", "uplift.noise", "uplift.noise_scale",
                        "uplift.field", "uplift.lines", "uplift.lines_width_m", "uplift.lines_value"},
                       e.uplift, visit);
    visit(Field{"rainfall.maximum", "", "largest relative rainfall", 0}, e.rainfall.maximum);
    describe_variation(
        {"rainfall.pattern", "rainfall.direction_deg", "rainfall.steps", "rainfall.noise", "rainfall.noise_scale",
         "rainfall.field", "rainfall.lines", "rainfall.lines_width_m", "rainfall.lines_value"},
        e.rainfall, visit);
    visit(Field{"uplift.history", "",
                "CSV of time_yr and rate_m_per_yr (takes the place of uplift.rate_m_per_yr) or factor (multiplies it), "
                "straight lines between its rows"},
          e.uplift.history);
    visit(Field{"river.k", "m^(1-2m)/yr", "erodibility; simulate needs it, a study fits it", 0, infinity, true},
          e.river.k);
    visit(Field{"river.m", "", "exponent of the drainage area; simulate needs it, a study fits it", 0, 5}, e.river.m);
    visit(Field{"river.n", "", "exponent of the slope", 0.3, 5}, e.river.n);
    visit(Field{"river.receiver", "", "neighbour that takes the water"}, e.river.receiver);
    visit(Field{"river.flow", "", "all water to one receiver, or divided among all lower neighbours"}, e.river.flow);
    visit(Field{"river.flow_exponent", "", "exponent of the slopes in the shares of multiple flow", 0, 1000, true},
          e.river.flow_exponent);
    visit(Field{"river.k_field", "", "image or map of the erodibility, scaled so that its largest value is river.k"},
          e.river.k_field);
    visit(Field{"base_level.history", "",
                "CSV of time_yr and elevation_m of every outlet, straight lines between its rows"},
          e.base_level.history);
    visit(Field{"initial.noise", "", "roughness of the initial surface"}, e.initial.noise);
    visit(Field{"initial.amplitude_m", "m", "height of that roughness", 0}, e.initial.amplitude_m);
    visit(Field{"initial.constant_m", "m", "height of the land above base level beneath that roughness"},
          e.initial.constant_m);
    visit(Field{"initial.elevation", "", "image or map of the initial heights (m), instead of constant and roughness"},
          e.initial.elevation);
    visit(Field{"hillslope.talus_angle_deg", "degrees", "steepest stable slope; absent: no limit", 0, 90, true},
          e.hillslope.talus_angle_deg);
    visit(Field{"hillslope.diffusivity_m2_per_yr", "m2/yr", "diffusivity of soil creep; 0: none", 0},
          e.hillslope.diffusivity_m2_per_yr);
    visit(Field{"hillslope.critical_slope", "m/m", "slope that creep cannot pass; 0: linear diffusion", 0},
          e.hillslope.critical_slope);
    visit(Field{"deposition.g", "", "G: how readily rivers lay down what they carry; 0: never", 0}, e.deposition.g);
    visit(Field{"time.solver", "", "implicit time stepping, or the steady state directly"}, e.time.solver);
    visit(Field{"time.step_yr", "yr", "time step", 0, infinity, true}, e.time.step_yr);
    visit(Field{"time.max_steps", "", "most steps (or sweeps of the steady solver)", 1, 1e9}, e.time.max_steps);
    visit(Field{"time.convergence", "", "stop when the mean rate is below this share of the mean uplift; 0: never", 0},
          e.time.convergence);
    visit(Field{"output.resolution", "",
                "cells along the longer side of the heightfield; default 512 of a TIN, a raster mesh's own cells", 2,
                100000},
          e.output.resolution);
    visit(Field{"output.interpolation", "",
                "how a TIN becomes a heightfield: smoothed, linear in its triangles, or by natural neighbours"},
          e.output.interpolation);
    visit(Field{"output.sigma_cells", "",
                "standard deviation of the Gaussian weights, in cells; default: the nodes' mean distance", 0, 10000,
                true},
          e.output.sigma_cells);
    visit(Field{"output.geotiff", "", "layout of the GeoTIFFs: tiles, or cloud-optimized with overviews"},
          e.output.geotiff);
    visit(Field{"output.heightmap", "", "also write the heightfield with 16 bits, as terrain renderers import it"},
          e.output.heightmap);
    visit(Field{"output.mesh_file", "", "also write the simulation's own nodes and triangles"}, e.output.mesh_file);
    visit(Field{"output.heightfield_mesh_file", "", "also write the heightfield as triangles"},
          e.output.heightfield_mesh_file);
    visit(Field{"output.solid", "", "close those meshes with vertical sides and a flat base"}, e.output.solid);
    visit(
        Field{"output.base_depth_m", "m",
              "depth of that base below the lowest point; default: a twentieth of the longer side", 0, infinity, true},
        e.output.base_depth_m);
    visit(Field{"output.snapshots_every", "", "steps between snapshots (pictures and a netCDF); absent: none", 1, 1e9},
          e.output.snapshots_every);
    visit(Field{"output.checkpoint_every", "",
                "steps after which a run saves itself, so that --resume can go on; absent: never", 1, 1e9},
          e.output.checkpoint_every);
    visit(Field{"output.frames", "", "of grow: pictures of the network from the trunk to the whole; 0: none", 0, 1000},
          e.output.frames);
    describe_growth(e, visit);
    visit(Field{"study.dem", "", "the DEM to be explained; a study needs it or a source"}, e.study.dem);
    visit(Field{"study.source", "", "where to fetch the DEM from, instead of study.dem (thalweg fetch --help)"},
          e.study.source);
    visit(Field{"study.bbox", "degrees", "west, south, east and north edge of what is fetched", -180, 180},
          e.study.bbox);
    visit(Field{"study.crs", "", "coordinate system to use instead of the DEM's, e.g. EPSG:32611"}, e.study.crs);
    visit(Field{"study.nodata", "m", "value to be taken as no data, besides what the DEM declares"}, e.study.nodata);
    visit(Field{"study.uplift_m_per_yr", "m/yr",
                "uplift rate of the real landscape (k cannot be told without); a study by stream-power needs it", 0,
                infinity, true},
          e.study.uplift_m_per_yr);
    visit(Field{"study.uplift_sd_m_per_yr", "m/yr", "standard deviation of that rate", 0}, e.study.uplift_sd_m_per_yr);
    visit(Field{"study.method", "", "what is matched"}, e.study.method);
    visit(Field{"study.models", "", "what explains the DEM: stream-power erosion, network growth, or a list of both"},
          e.study.models);
    visit(Field{"study.channel_area_m2", "m2",
                "drainage area where channels begin; default: 0.1 % of the studied basin, at least 50 cells, rounded "
                "to 1-2-5",
                0, infinity, true},
          e.study.channel_area_m2);
    visit(Field{"study.area_min_m2", "m2", "smallest drainage area in the fit", 0}, e.study.area_min_m2);
    visit(Field{"study.area_max_m2", "m2", "largest drainage area in the fit", 0, infinity, true}, e.study.area_max_m2);
    visit(
        Field{"study.realisations", "",
              "each model is made with so many other seeds, by which its distances are judged; 0: none, 20 are enough",
              0, 1000},
        e.study.realisations);
}

/// Reads an experiment file (TOML), applies overrides of the form "river.k=2e-5" and checks every value. Paths are
/// relative to the file. Throws Error, one sentence: no file, not TOML (with the line), an unknown key (with the
/// nearest known one), a wrong type, a value out of range.
Experiment read_experiment(const std::filesystem::path&, const std::vector<std::string>& overrides = {});

/// The experiment as TOML with every value and unit, such that reading it again gives the same experiment.
std::string to_toml(const Experiment&);

/// Only these sections, "" for what stands above them.
std::string to_toml(const Experiment&, std::span<const std::string_view> sections);

/// One line per parameter, for `--help`.
std::string experiment_reference();

}  // namespace thalweg::study
