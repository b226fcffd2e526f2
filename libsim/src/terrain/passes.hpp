// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <span>
#include <vector>

#include "terrain/basin_graph.hpp"
#include "terrain/terrain_view.hpp"
#include "thalweg/core/grid.hpp"
#include "thalweg/core/mesh.hpp"

namespace thalweg::terrain {

inline void keep_lower(Pass& best, const Pass& offered) {
    if (lower(offered, best)) best = offered;
}

/// Offers `best` every way out of the basin of `node` that begins there: the edges to other basins, and at an open node
/// the way straight out.
template <Topology T>
void offer_ways_out(const Terrain<T>& terrain, std::span<const Index> basin, Index node, Pass& best) {
    const Index here = basin[node];
    if (terrain.boundary[node] == Boundary::open) keep_lower(best, pass_straight_out(terrain.elevation_m, here, node));
    terrain.topology.neighbors(node, [&](Index neighbor, double, Slot) {
        const Index there = basin[neighbor];
        if (there == none || there == here) return;
        keep_lower(best, pass_between(terrain.elevation_m, here, node, there, neighbor));
    });
}

/// Lowest pass of every basin but the outside: one round of Borůvka's algorithm. `no_pass` where there is none. `pit`
/// is a node of each basin.
std::vector<Pass> lowest_pass_of_each_basin(const Terrain<Grid>&, std::span<const Index> basin,
                                            std::span<const Index> pit);
std::vector<Pass> lowest_pass_of_each_basin(const Terrain<Mesh>&, std::span<const Index> basin,
                                            std::span<const Index> pit);

/// Lowest pass between each two pieces, for each block of nodes that has any; `piece` gives the piece of each basin,
/// and the outside is piece 0. The passes name basins.
std::vector<Pass> passes_between_pieces(const Terrain<Grid>&, std::span<const Index> basin,
                                        std::span<const Index> piece, Index pieces);
std::vector<Pass> passes_between_pieces(const Terrain<Mesh>&, std::span<const Index> basin,
                                        std::span<const Index> piece, Index pieces);

}  // namespace thalweg::terrain
