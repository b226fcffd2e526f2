// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "thalweg/core/topology.hpp"
#include "thalweg/evolve/history.hpp"

namespace thalweg::evolve {

/// The state of a simulation, and nothing that can be derived from it.
struct Landscape {
    double time_yr = 0;
    std::vector<double> elevation_m;
};

/// What surrounds the landscape and drives it: one value per node, and what changes in time. `simulate` follows the
/// histories; functions of a single step or of the steady state take the values per node as they stand.
struct Setting {
    std::vector<double> uplift_m_per_yr;            ///< ≥ 0; base-level nodes are not uplifted
    std::vector<double> rainfall;                   ///< relative, ≥ 0; multiplies the cell area in the drainage area
    std::vector<Boundary> boundary;                 ///< `base_level` at the outlets, `interior` elsewhere
    std::vector<double> relative_erodibility = {};  ///< ≥ 0; multiplies the river's k; empty: 1 everywhere
    History uplift_factor = {};  ///< ≥ 0, multiplies the uplift of every node; empty: 1 at all times
    History base_level_m = {};   ///< elevation of every base-level node; empty: each keeps its own
};

}  // namespace thalweg::evolve
