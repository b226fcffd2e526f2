// SPDX-License-Identifier: GPL-3.0-or-later
// Private: the steps of a study that grow a network.
#pragma once

#include <filesystem>

#include "thalweg/study/analyze.hpp"
#include "thalweg/study/domain.hpp"
#include "thalweg/study/parameters.hpp"

namespace thalweg::study {

/// Finds the dials of the studied basin (`growth_fit`), grows its like there (`grow`), measures the grown surface like
/// any DEM (`grown`) and compares it with the basin (`compare_grown`), each in its folder of the study. `options` are
/// those by which the basin was measured.
void run_growth_steps(const Experiment&, const Catchment&, const MeasureOptions& options,
                      const std::filesystem::path& study, const Messages&);

}  // namespace thalweg::study
