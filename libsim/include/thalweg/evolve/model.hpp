// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "thalweg/evolve/hillslope.hpp"
#include "thalweg/evolve/river.hpp"

namespace thalweg::evolve {

/// The processes that act on a landscape, each a plain struct of parameters whose defaults switch it off. Who adds a
/// process appends a member here and its line to `step` in src/evolve/simulate.cpp.
struct Model {
    River river = {};          ///< uplift, incision and the talus limit, in one sweep
    Hillslope hillslope = {};  ///< then creep, on what the rivers left
};

}  // namespace thalweg::evolve
