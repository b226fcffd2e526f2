// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <limits>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "thalweg/core/index.hpp"
#include "thalweg/evolve/river.hpp"
#include "thalweg/evolve/uplift.hpp"
#include "thalweg/terrain/route.hpp"

namespace thalweg::study {

enum class MeshKind { tin, raster };
enum class OutletRule { all, dem };
enum class NoiseKind { perlin, uniform };
enum class InitialSurface { noise, dem };
enum class Solver { implicit, steady };
enum class Interpolation { gaussian, linear, natural };
enum class GeotiffKind { tiled, cog };
enum class HeightmapFile { png };
enum class MeshFile { obj, ply };
enum class FitMethod { slope_area };

/// Everything an experiment file can say, with the defaults for what it does not say. Each member is described once, in
/// `describe` below: reading, overriding, writing, `--help` and the reference page all follow from there.
struct Experiment {
    std::uint64_t seed = 1;
    std::optional<OutletRule> outlets;  ///< default: `dem` where the domain is a DEM's basin, else `all`
    struct {
        std::vector<double> size_m;
        std::optional<Index> nodes;
        std::optional<double> spacing_m;
        std::optional<MeshKind> mesh;  ///< default: TIN; in a study, the DEM's own raster
        std::optional<std::filesystem::path> dem;
        InitialSurface initial = InitialSurface::noise;
    } domain;
    struct {
        double rate_m_per_yr = 1e-3;
        evolve::Pattern pattern = evolve::Pattern::constant;
    } uplift;
    struct {
        std::optional<double> k;
        std::optional<double> m;
        double n = 1;
        terrain::Receiver receiver = terrain::Receiver::steepest;
        evolve::Flow flow = evolve::Flow::single;
        double flow_exponent = 1.1;
    } river;
    struct {
        NoiseKind noise = NoiseKind::perlin;
        double amplitude_m = 0.01;
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
    } output;
    struct {
        std::optional<std::filesystem::path> dem;
        std::optional<std::string> source;          ///< of the fetcher's catalogue, instead of a DEM
        std::optional<std::array<double, 4>> bbox;  ///< west, south, east, north (degrees)
        std::string crs;                            ///< replaces the DEM's own
        std::optional<double> nodata;               ///< besides what the DEM declares
        std::optional<double> uplift_m_per_yr;
        double uplift_sd_m_per_yr = 0;
        FitMethod method = FitMethod::slope_area;
        std::optional<double> channel_area_m2;
        std::optional<double> area_min_m2;
        std::optional<double> area_max_m2;
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
const Words<OutletRule>& words(OutletRule);
const Words<NoiseKind>& words(NoiseKind);
const Words<InitialSurface>& words(InitialSurface);
const Words<Solver>& words(Solver);
const Words<Interpolation>& words(Interpolation);
const Words<GeotiffKind>& words(GeotiffKind);
const Words<HeightmapFile>& words(HeightmapFile);
const Words<MeshFile>& words(MeshFile);
const Words<FitMethod>& words(FitMethod);
const Words<evolve::Pattern>& words(evolve::Pattern);
const Words<terrain::Receiver>& words(terrain::Receiver);
const Words<evolve::Flow>& words(evolve::Flow);

/// Calls visit(field, member) for every parameter, in the order of the file.
template <class AnyExperiment, class Visit>
void describe(AnyExperiment& e, Visit visit) {
    constexpr double infinity = std::numeric_limits<double>::infinity();
    visit(Field{"seed", "", "seed of everything random", 0}, e.seed);
    visit(Field{"outlets", "",
                "where water leaves: the whole rim, or the outlet of the DEM's basin (default where there is a DEM)"},
          e.outlets);
    visit(Field{"domain.size_m", "m", "width and height of a rectangle; simulate needs this or domain.dem", 0, infinity,
                true},
          e.domain.size_m);
    visit(Field{"domain.nodes", "",
                "number of nodes (a TIN meets it within 2 %); a rectangle needs this or domain.spacing_m", 16,
                2147483647},
          e.domain.nodes);
    visit(Field{"domain.spacing_m", "m", "distance of nodes, instead of their number", 0, infinity, true},
          e.domain.spacing_m);
    visit(Field{"domain.mesh", "",
                "Poisson-disk points and their Delaunay triangles (default), or square cells (default of a study)"},
          e.domain.mesh);
    visit(Field{"domain.dem", "", "DEM whose largest complete basin is the domain, instead of a rectangle"},
          e.domain.dem);
    visit(Field{"domain.initial", "", "start from noise, or from the DEM's own heights"}, e.domain.initial);
    visit(Field{"uplift.rate_m_per_yr", "m/yr", "largest uplift rate", 0}, e.uplift.rate_m_per_yr);
    visit(Field{"uplift.pattern", "", "shape of the uplift over the domain"}, e.uplift.pattern);
    visit(Field{"river.k", "m^(1-2m)/yr", "erodibility; simulate needs it, a study fits it", 0, infinity, true},
          e.river.k);
    visit(Field{"river.m", "", "exponent of the drainage area; simulate needs it, a study fits it", 0, 5}, e.river.m);
    visit(Field{"river.n", "", "exponent of the slope", 0.3, 5}, e.river.n);
    visit(Field{"river.receiver", "", "neighbour that takes the water"}, e.river.receiver);
    visit(Field{"river.flow", "", "all water to one receiver, or divided among all lower neighbours"}, e.river.flow);
    visit(Field{"river.flow_exponent", "", "exponent of the slopes in the shares of multiple flow", 0, 1000, true},
          e.river.flow_exponent);
    visit(Field{"initial.noise", "", "roughness of the initial surface"}, e.initial.noise);
    visit(Field{"initial.amplitude_m", "m", "height of that roughness", 0}, e.initial.amplitude_m);
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
    visit(Field{"output.resolution", "", "cells along the longer side of a TIN's heightfield; default 512", 2, 100000},
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
    visit(Field{"study.dem", "", "the DEM to be explained; a study needs it or a source"}, e.study.dem);
    visit(Field{"study.source", "", "where to fetch the DEM from, instead of study.dem (thalweg fetch --help)"},
          e.study.source);
    visit(Field{"study.bbox", "degrees", "west, south, east and north edge of what is fetched", -180, 180},
          e.study.bbox);
    visit(Field{"study.crs", "", "coordinate system to use instead of the DEM's, e.g. EPSG:32611"}, e.study.crs);
    visit(Field{"study.nodata", "m", "value to be taken as no data, besides what the DEM declares"}, e.study.nodata);
    visit(Field{"study.uplift_m_per_yr", "m/yr",
                "uplift rate of the real landscape (k cannot be told without); a study needs it", 0, infinity, true},
          e.study.uplift_m_per_yr);
    visit(Field{"study.uplift_sd_m_per_yr", "m/yr", "standard deviation of that rate", 0}, e.study.uplift_sd_m_per_yr);
    visit(Field{"study.method", "", "what is matched"}, e.study.method);
    visit(Field{"study.channel_area_m2", "m2",
                "drainage area where channels begin; default: 0.1 % of the studied basin, at least 50 cells, rounded "
                "to 1-2-5",
                0, infinity, true},
          e.study.channel_area_m2);
    visit(Field{"study.area_min_m2", "m2", "smallest drainage area in the fit", 0}, e.study.area_min_m2);
    visit(Field{"study.area_max_m2", "m2", "largest drainage area in the fit", 0, infinity, true}, e.study.area_max_m2);
}

/// Reads an experiment file (TOML), applies overrides of the form "river.k=2e-5" and checks every value. Paths are
/// relative to the file. Throws Error, one sentence: no file, not TOML (with the line), an unknown key (with the
/// nearest known one), a wrong type, a value out of range.
Experiment read_experiment(const std::filesystem::path&, const std::vector<std::string>& overrides = {});

/// The experiment as TOML with every value and unit, such that reading it again gives the same experiment.
std::string to_toml(const Experiment&);

/// One line per parameter, for `--help`.
std::string experiment_reference();

}  // namespace thalweg::study
