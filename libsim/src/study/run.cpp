// SPDX-License-Identifier: GPL-3.0-or-later
#include "thalweg/study/run.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>

#include "study/noting.hpp"
#include "study/report_json.hpp"
#include "study/run_growth.hpp"
#include "thalweg/core/error.hpp"
#include "thalweg/study/compare.hpp"
#include "thalweg/study/fetch.hpp"
#include "thalweg/study/figure.hpp"
#include "thalweg/study/fit.hpp"
#include "thalweg/study/manifest.hpp"
#include "thalweg/study/output_folder.hpp"
#include "thalweg/study/simulate.hpp"

namespace thalweg::study {
namespace {

namespace fs = std::filesystem;

fs::path step_folder(const fs::path& folder, const char* step) {
    fs::create_directory(folder / step);
    return folder / step;
}

/// The experiment that simulates what was fitted: the study's uplift and the fitted k and m on the DEM's own raster.
/// A fetched DEM is named as it lies beside the simulation's folder, so that the study can be moved.
Experiment fitted_experiment(const Experiment& study, const fs::path& dem, const infer::SlopeAreaFit& fit) {
    if (!(fit.k && fit.k->value > 0 && fit.m.value > 0)) {
        throw Error(
            fmt::format("the fit gives m = {:.3g}, with which no landscape can be simulated: slopes do not "
                        "fall downstream in the range of areas (see study.area_min_m2 and study.area_max_m2)",
                        fit.m.value));
    }
    Experiment e = study;
    e.domain.dem = study.study.dem ? *study.study.dem : fs::path("..") / dem;
    e.domain.mesh = study.domain.mesh.value_or(MeshKind::raster);
    e.uplift.rate_m_per_yr = *study.study.uplift_m_per_yr;
    e.river.k = fit.k->value;
    e.river.m = fit.m.value;
    return e;
}

bool explains_by(const Experiment& e, StudyModel model) {
    return std::ranges::find(e.study.models, model) != e.study.models.end();
}

/// What the study's own experiment.toml says: the uplift that is simulated is the study's.
Experiment resolved(Experiment e) {
    if (e.study.uplift_m_per_yr) e.uplift.rate_m_per_yr = *e.study.uplift_m_per_yr;
    return e;
}

/// Where the values stand that a study finds, which its experiment.toml has not: with them it would be another one.
std::string found_values(const Experiment& e) {
    std::string text;
    if (explains_by(e, StudyModel::stream_power)) text += "# k and m as fitted: simulate/experiment.toml\n";
    if (explains_by(e, StudyModel::growth)) text += "# The dials of growth as fitted: grow/experiment.toml\n";
    return text;
}

/// Relief of a model's terrain over that of the real one, told where it is far from 1.
void warn_of_relief(const fs::path& folder, const char* model, const char* why, const Messages& messages) {
    const auto relief = [&](const char* step) {
        const Json input = read_json(folder / step / "summary.json").at("input");
        return input.at("elevation_max_m").get<double>() - input.at("elevation_min_m").get<double>();
    };
    const double real = relief("basin"), made = relief(model);
    if (made < 1.5 * real && real < 1.5 * made) return;
    messages.warning(fmt::format("the {} relief is {:.0f} m, the real one {:.0f} m: {}", model, made, real, why));
}

FitOptions fit_options(const Experiment& e) {
    FitOptions options;
    options.fit.n = e.river.n;
    options.fit.uplift_m_per_yr = e.study.uplift_m_per_yr;
    options.fit.uplift_sd_m_per_yr = e.study.uplift_sd_m_per_yr;
    options.fit.deposition_g = e.deposition.g;
    options.fit.area_min_m2 = e.study.area_min_m2;
    options.fit.area_max_m2 = e.study.area_max_m2;
    return options;
}

/// Relative path and checksum of every file of the study, in order of the path; not of those that hold seconds.
Json checksums(const fs::path& folder) {
    std::vector<fs::path> files;
    for (const auto& entry : fs::recursive_directory_iterator(folder)) {
        const std::string name = fs::relative(entry.path(), folder).generic_string();
        const bool timed =
            name == "simulate/summary.json" || name == "simulate/history.csv" || name == "grow/summary.json";
        if (entry.is_regular_file() && !timed) files.push_back(fs::relative(entry.path(), folder));
    }
    std::sort(files.begin(), files.end());
    Json list = Json::array();
    for (const fs::path& file : files) {
        list.push_back({{"file", file.generic_string()}, {"sha256", sha256_of(folder / file)}});
    }
    return list;
}

Json manifest_json(const Experiment& e, const NamedRaster& dem, const fs::path& folder) {
    const Versions v = versions();
    Json libraries;
    for (const auto& [name, version] : v.libraries) libraries[name] = version;
    Json input{{"file", dem.file}, {"sha256", dem.sha256}, {"crs", dem.crs_name}};
    if (dem.origin) input["provenance"] = origin_json(*dem.origin);
    std::vector<std::string> steps{"measure", "basin"};
    if (e.study.source) steps.insert(steps.begin(), "fetch");
    if (explains_by(e, StudyModel::stream_power)) {
        steps.insert(steps.end(), {"fit", "simulate", "synthetic", "compare"});
    }
    if (explains_by(e, StudyModel::growth)) {
        steps.insert(steps.end(), {"growth_fit", "grow", "grown", "compare_grown"});
    }
    return {{"program", "thalweg"},
            {"version", v.thalweg},
            {"commit", v.commit},
            {"libraries", libraries},
            {"command", "thalweg run experiment.toml"},
            {"seed", e.seed},
            {"input", input},
            {"steps", steps},
            {"outputs", checksums(folder)}};
}

void check_dem_is_named(const Experiment& e) {
    if (e.study.dem && e.study.source) throw Error("study.dem and study.source exclude each other: give one of them");
    if (!e.study.dem && !e.study.source) {
        throw Error("study.dem is needed: the DEM to be explained (or study.source and study.bbox)");
    }
    if (e.study.source && !e.study.bbox) {
        throw Error("study.bbox is needed with study.source: west, south, east and north in degrees");
    }
}

/// The study's DEM: the file it names, or what its source has for its box, which then is a part of the study.
fs::path dem_of(const Experiment& e, const fs::path& folder, const Messages& messages) {
    if (e.study.dem) return *e.study.dem;
    messages.progress(fmt::format("fetching {}", *e.study.source));
    return fetch_dem(*e.study.source, *e.study.bbox, step_folder(folder, "fetch"));
}

/// The basin that a study explains, and by which options it was measured.
struct StudiedBasin {
    const Experiment& experiment;
    fs::path dem;  ///< relative to the study's folder
    const Catchment& catchment;
    const MeasureOptions& options;
};

void run_erosion_steps(const StudiedBasin& b, const fs::path& folder, const Messages& messages) {
    const FitOutcome fitted = fit(folder / "basin", fit_options(b.experiment), step_folder(folder, "fit"), messages);
    simulate(fitted_experiment(b.experiment, b.dem, fitted.fit), b.catchment, step_folder(folder, "simulate"),
             messages);
    const NamedRaster synthetic = read_dem(folder / "simulate/elevation.tif", {}, {});
    analyze(synthetic, b.options, step_folder(folder, "synthetic"), about("synthetic", messages));
    compare(folder / "basin", folder / "synthetic",
            {.read = {},
             .measure = b.options,
             .realisations = b.experiment.study.realisations,
             .model_of_b = folder / "simulate"},
            step_folder(folder, "compare"), messages);
}

void draw_all(const fs::path& folder, const Messages& messages) {
    messages.progress("drawing");
    draw_figures("study", folder);
}

}  // namespace

std::string run_study(const Experiment& e, Figures figures, const fs::path& folder, const Messages& messages) {
    check_dem_is_named(e);
    if (e.output.checkpoint_every) {
        throw Error(
            "output.checkpoint_every is for thalweg simulate alone: what goes on with --resume is one simulation");
    }
    if (explains_by(e, StudyModel::stream_power) && !e.study.uplift_m_per_yr) {
        throw Error("study.uplift_m_per_yr is needed: slopes alone tell only k/u, and a simulation needs both");
    }
    const auto start = std::chrono::steady_clock::now();
    std::vector<std::string> notes;
    write_text(folder / "experiment.toml", found_values(e) + to_toml(resolved(e)));
    MeasureOptions options;
    options.channel_area_m2 = e.study.channel_area_m2;
    const fs::path dem_file = dem_of(e, folder, messages);
    const NamedRaster dem = read_dem(dem_file, {.nodata = e.study.nodata, .crs = e.study.crs}, messages);
    analyze(dem, options, step_folder(folder, "measure"), about("whole DEM", messages));

    const Catchment catchment = largest_complete_catchment(dem.raster, options);
    options.catchment_outlet = catchment.outlet;
    if (!options.channel_area_m2) options.channel_area_m2 = catchment_channel_area(catchment.raster);
    NamedRaster basin{catchment.raster, dem.file, dem.sha256, dem.crs_name, {}, dem.origin};
    analyze(basin, options, step_folder(folder, "basin"), about("its basin", messages));

    if (explains_by(e, StudyModel::stream_power)) {
        run_erosion_steps({e, fs::relative(dem_file, folder), catchment, options}, folder, messages);
        warn_of_relief(folder, "synthetic",
                       "the fitted law does not carry over to the whole catchment; see the range of areas and the "
                       "errors of the fit",
                       noting(messages, notes));
    }
    if (explains_by(e, StudyModel::growth)) {
        run_growth_steps(resolved(e), catchment, options, folder, messages);
        warn_of_relief(folder, "grown",
                       "grown links run straight and are more, so that sources come to lie lower than where rivers "
                       "wind, and what growth leaves bare is as high as valley sides reach; another seed shows by "
                       "how much it differs",
                       noting(messages, notes));
    }

    Json manifest = manifest_json(e, dem, folder);
    manifest["notes"] = notes;
    write_text(folder / "manifest.json", text_of(manifest));
    if (figures == Figures::draw) draw_all(folder, messages);
    manifest["seconds"] = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    std::string text = text_of(manifest);
    write_text(folder / "manifest.json", text);
    return text;
}

}  // namespace thalweg::study
