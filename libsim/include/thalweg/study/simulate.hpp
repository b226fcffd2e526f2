// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <string>

#include "thalweg/study/checkpoint.hpp"
#include "thalweg/study/domain.hpp"

namespace thalweg::study {

/// Runs the simulation that an experiment describes and writes summary.json, elevation.tif, drainage_area.tif, the
/// CSVs, network.gpkg and the resolved experiment.toml into an existing folder. Returns the text of summary.json.
/// Throws Error where river.k or river.m is missing or the domain cannot be made. With a folder of checkpoints the run
/// saves itself there as the experiment asks, and goes on from what is there if it is to: to the same bytes as if it
/// had never stopped.
std::string simulate(const Experiment&, const std::filesystem::path& folder, const Messages&,
                     CheckpointFolder* = nullptr);

/// The same on a catchment that has been cut out already.
std::string simulate(const Experiment&, const Catchment&, const std::filesystem::path& folder, const Messages&);

}  // namespace thalweg::study
