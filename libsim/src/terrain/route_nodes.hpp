// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <span>

#include "thalweg/core/topology.hpp"
#include "thalweg/terrain/route.hpp"

namespace thalweg::terrain {

/// Neighbour of steepest descent, by drop times the reciprocal of the length: the row loop of the grid multiplies too,
/// and both must break ties alike. Comparisons with NaN are false, so a void neither gives nor takes water.
template <Topology T>
Slot steepest_slot(const T& topology, std::span<const double> elevation_m, Index node) {
    Slot best = no_flow;
    double best_slope = 0;
    topology.neighbors(node, [&](Index neighbor, double length_m, Slot slot) {
        const double slope = (elevation_m[node] - elevation_m[neighbor]) * (1 / length_m);
        if (slope > best_slope) {
            best_slope = slope;
            best = slot;
        }
    });
    return best;
}

/// The lowest of the lower neighbours.
template <Topology T>
Slot lowest_slot(const T& topology, std::span<const double> elevation_m, Index node) {
    Slot best = no_flow;
    double lowest = elevation_m[node];
    topology.neighbors(node, [&](Index neighbor, double, Slot slot) {
        if (elevation_m[neighbor] < lowest) {
            lowest = elevation_m[neighbor];
            best = slot;
        }
    });
    return best;
}

/// Directions of the nodes [first, last), one by one: the definition, and what meshes use.
template <Topology T>
void route_nodes(const T& topology, std::span<const double> elevation_m, std::span<const Boundary> boundary,
                 Receiver receiver, Index first, Index last, FlowDirections& directions) {
    for (Index node = first; node < last; ++node) {
        if (boundary[node] == Boundary::base_level) {
            directions[node] = no_flow;
        } else if (receiver == Receiver::steepest) {
            directions[node] = steepest_slot(topology, elevation_m, node);
        } else {
            directions[node] = lowest_slot(topology, elevation_m, node);
        }
    }
}

}  // namespace thalweg::terrain
