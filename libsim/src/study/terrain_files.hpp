// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "study/report_json.hpp"
#include "study/simulation_outputs.hpp"

namespace thalweg::study {

/// Throws Error where output keys contradict each other: before a long run, not after it.
void check_terrain_files(const Experiment&);

/// Writes the heightmap and the meshes that an experiment asks for, and returns their keys of summary.json: `heightmap`
/// and `meshes`, each where it is asked for.
Json write_terrain_files(const Grid&, const Domain&, const Heightfield&, const Finished&, const Experiment&,
                         const std::filesystem::path& folder);
Json write_terrain_files(const Mesh&, const Domain&, const Heightfield&, const Finished&, const Experiment&,
                         const std::filesystem::path& folder);

}  // namespace thalweg::study
