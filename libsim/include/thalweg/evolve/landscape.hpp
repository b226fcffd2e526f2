// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "thalweg/core/topology.hpp"

namespace thalweg::evolve {

/// The state of a simulation, and nothing that can be derived from it.
struct Landscape {
    double time_yr = 0;
    std::vector<double> elevation_m;
};

/// What surrounds the landscape and drives it: one value per node.
struct Setting {
    std::vector<double> uplift_m_per_yr;            ///< ≥ 0; base-level nodes are not uplifted
    std::vector<double> rainfall;                   ///< relative, ≥ 0; multiplies the cell area in the drainage area
    std::vector<Boundary> boundary;                 ///< `base_level` at the outlets, `interior` elsewhere
    std::vector<double> relative_erodibility = {};  ///< ≥ 0; multiplies the river's k; empty: 1 everywhere
};

}  // namespace thalweg::evolve
