// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <span>
#include <vector>

#include "thalweg/terrain/route.hpp"

namespace thalweg::terrain {

/// Lakes seen as basins joined at their passes (Cordonnier, Bovy & Braun 2019). Every node is labelled with the pit or
/// outlet that its water reaches; one round of Borůvka's algorithm and then Kruskal's, on (height, node numbers), join
/// every basin to the outside over the lowest possible way. The two uses below walk that tree.
/// Cost: linear in the nodes, plus sorting of the passes that the first round leaves; no heap.
///
/// Where a connected piece of the domain has no outlet at all, its lowest node becomes one.

/// Level to which water fills every node: the smallest height h such that some path to an outlet never rises above h,
/// never below the ground. The surface is unique, so any correct filler gives the same numbers. NaN stays NaN.
std::vector<double> fill(const Grid&, std::span<const double> elevation_m, std::span<const Boundary>);
std::vector<double> fill(const Mesh&, std::span<const double> elevation_m, std::span<const Boundary>);

/// Leads the water of every lake over its pass: the path from the pass down to the pit is reversed in `directions`, so
/// that afterwards every node but the outlets has a neighbour as receiver and there are no loops. Returns the number of
/// lakes (pits that drained nowhere; a flat counts as one pit).
Index drain_lakes(const Grid&, std::span<const double> elevation_m, std::span<const Boundary>, FlowDirections&);
Index drain_lakes(const Mesh&, std::span<const double> elevation_m, std::span<const Boundary>, FlowDirections&);

/// `drain_lakes` and, of the same lakes, the surface that `fill` gives: finding them is what takes most of either.
struct DrainedAndFilled {
    Index lakes;
    std::vector<double> filled_m;
};
DrainedAndFilled drain_and_fill(const Grid&, std::span<const double> elevation_m, std::span<const Boundary>,
                                FlowDirections&);

}  // namespace thalweg::terrain
