// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <vector>

#include "study/report_json.hpp"
#include "thalweg/study/analyze.hpp"
#include "thalweg/study/height_survey.hpp"

namespace thalweg::study {

/// What a DEM was, for the summary of what was measured on it.
TerrainInput input_of(const NamedRaster&, const RasterMeasurement&);

/// What was read, and what in it may mislead: the object `ingest` of the summary.
Json ingest_json(const NamedRaster&, const RasterMeasurement&, const HeightSurvey&,
                 const std::vector<std::string>& hints);

/// The same in one line for the terminal.
std::string ingest_line(const NamedRaster&, const RasterMeasurement&);

}  // namespace thalweg::study
