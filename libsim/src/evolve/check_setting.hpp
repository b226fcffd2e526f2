// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "thalweg/evolve/model.hpp"

namespace thalweg::evolve {

/// Throws Error unless landscape and setting hold one value per node.
void check_setting(Index nodes, const Landscape&, const Setting&);

/// Throws Error unless k, m ≥ 0, n is in [0.3, 5] and the talus slope is positive.
void check_river(const River&);

/// Throws Error unless diffusivity and critical slope are zero or more.
void check_hillslope(const Hillslope&);

/// Throws Error unless the time step is a positive number.
void check_step(double dt_yr);

/// Throws Error unless `frozen` is empty or holds one direction per node.
void check_frozen(Index nodes, const FlowDirections& frozen);

}  // namespace thalweg::evolve
