// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "thalweg/channel/growth_measures.hpp"
#include "thalweg/study/analyze.hpp"
#include "thalweg/study/domain.hpp"
#include "thalweg/study/growth_dials.hpp"
#include "thalweg/study/growth_site.hpp"

namespace thalweg::study {

/// A basin, what its rivers and valleys measure, and the dials with which networks grow there that measure alike.
struct GrowthFit {
    GrowthSite site;
    double channel_area_m2;  ///< drainage area where channels were taken to begin; NaN where they begin otherwise
    channel::GrowthMeasures measures;
    DialsFit dials;
    std::vector<std::string> notes;
};

/// What tells of growth on a raster that was measured, C freed of what D8 adds to the length of channels (5.5 % on
/// straight ones).
channel::GrowthMeasures growth_measures(const Raster&, const RasterMeasurement&);

/// Measures a catchment and finds its dials. C is freed of what D8 adds to the length of channels (5.5 % on straight
/// ones): a grown network's links are straight. Throws Error where no trunk lies inside the basin or `fit_dials`
/// cannot.
GrowthFit fit_growth(const Catchment&, const MeasureOptions&, std::uint64_t seed, const GrowthRules& = {});

struct GrowthFitOptions {
    io::ReadOptions read;
    MeasureOptions measure;
    std::optional<OutletRequest> outlet = {};         ///< of a DEM what drains to it, instead of its largest basin
    std::optional<std::filesystem::path> heads = {};  ///< points where channels begin, instead of at a drainage area
    std::uint64_t seed = 1;
};

/// The same for the largest complete catchment (or that above an outlet) of a DEM, of an analyze folder (its
/// filled.tif, with its channel area, or with the heads given) or of a simulate folder (its elevation.tif), written
/// into an existing folder: fit.json, fit.csv (what was measured beside what grown networks measure), growth.toml and
/// basin.gpkg (the outline and trunk that it names), from which `thalweg grow` grows the like. Returns the text of
/// fit.json.
std::string fit_growth(const std::filesystem::path& target, const GrowthFitOptions&,
                       const std::filesystem::path& folder, const Messages&);

/// Writes those files.
std::string write_growth_fit(const GrowthFit&, const std::string& measured_on, const std::filesystem::path& folder);

/// The experiment that grows the like; its basin is the file `basin`.
Experiment growth_experiment(const GrowthFit&, const std::filesystem::path& basin);

}  // namespace thalweg::study
