// SPDX-License-Identifier: GPL-3.0-or-later
// Islands to be eroded, on either topology.
#pragma once

#include "support/settings.hpp"
#include "thalweg/core/parallel.hpp"
#include "thalweg/evolve/simulate.hpp"
#include "thalweg/mesh/points.hpp"
#include "thalweg/mesh/triangulate.hpp"
#include "thalweg/terrain/graph.hpp"

namespace thalweg::validation {

constexpr double side_m = 10000;

inline Grid island_grid(Index cells_across) {
    return plane_grid(cells_across, cells_across, side_m / cells_across, side_m / cells_across);
}

inline Mesh island_mesh(Index nodes, std::uint64_t seed) {
    const Polygon square{{0, 0}, {side_m, 0}, {side_m, side_m}, {0, side_m}};
    return mesh::triangulate(square, mesh::poisson_disk_count(square, nodes, seed));
}

/// The graph of a finished landscape, drained anew from its heights.
template <class Topology>
terrain::FlowGraph graph_of_surface(const Topology& topology, const evolve::Landscape& landscape,
                                    const evolve::Drainage& drainage) {
    return terrain::flow_graph(topology, landscape.elevation_m, drainage.directions);
}

}  // namespace thalweg::validation
