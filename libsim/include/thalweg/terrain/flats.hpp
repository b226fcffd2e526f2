// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <span>

#include "thalweg/core/grid.hpp"

namespace thalweg::terrain {

/// Gives a direction to the cells of every flat that has a way out (a cell of the same height with a lower neighbour, or
/// on the edge of the data), so that water flows toward lower and away from higher terrain (Barnes, Lehman & Mulla
/// 2014) and without loops. Heights are not changed. Flats without a way out keep `no_flow`.
/// `directions` are those that `route` gives on the same heights. Ties: straight before diagonal, then the lower slot.
/// Returns the number of cells that got a direction. Linear in the number of cells.
Index resolve_flats(const Grid&, std::span<const double> elevation_m, std::span<const Boundary>, FlowDirections&);

}  // namespace thalweg::terrain
