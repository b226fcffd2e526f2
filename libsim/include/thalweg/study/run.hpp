// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <string>

#include "thalweg/study/analyze.hpp"
#include "thalweg/study/parameters.hpp"

namespace thalweg::study {

enum class Figures { draw, leave_out };

/// The whole study that an experiment describes, one folder per step: `measure` (the DEM), `basin` (its largest
/// complete catchment alone), `fit` (k and m of that), `simulate` (a landscape on the same outline with them),
/// `synthetic` (that landscape measured like a DEM), `compare` (basin and synthetic); where study.models has
/// growth `growth_fit` (its dials), `grow` (a network and its surface in the same outline), `grown` (that surface
/// measured like a DEM) and `compare_grown`; then manifest.json and, with figures, report.html. Returns the text of
/// manifest.json. Throws Error where study.dem is missing, or study.uplift_m_per_yr for a study by stream power.
std::string run_study(const Experiment&, Figures, const std::filesystem::path& folder, const Messages&);

}  // namespace thalweg::study
