// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <span>
#include <vector>

#include "thalweg/core/grid.hpp"
#include "thalweg/core/mesh.hpp"

namespace thalweg::terrain {

/// Which of its lower neighbours a node gives its water to.
enum class Receiver {
    steepest,  ///< steepest descent by slope: D8 on a grid (O'Callaghan & Mark 1984), Braun & Willett 2013 on a mesh
    lowest     ///< the lowest neighbour (Bell 2024)
};

/// Single flow direction of every node: the neighbour of steepest descent, drop × (1 / length), or the lowest; ties to the
/// lower slot (on a mesh the lower index). `no_flow` where none is strictly lower, at base level and without data (NaN).
FlowDirections route(const Grid&, std::span<const double> elevation_m, std::span<const Boundary>,
                     Receiver = Receiver::steepest);
FlowDirections route(const Mesh&, std::span<const double> elevation_m, std::span<const Boundary>,
                     Receiver = Receiver::steepest);

/// The same into memory that is already there.
void route(const Grid&, std::span<const double> elevation_m, std::span<const Boundary>, Receiver, FlowDirections& into);
void route(const Mesh&, std::span<const double> elevation_m, std::span<const Boundary>, Receiver, FlowDirections& into);

/// `open` at cells with data on the grid's edge or beside a cell without data, else `interior`.
std::vector<Boundary> data_edge(const Grid&, std::span<const double> elevation_m);

}  // namespace thalweg::terrain
