// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <span>
#include <vector>

#include "terrain/basin_graph.hpp"
#include "terrain/lake_buffers.hpp"
#include "terrain/terrain_view.hpp"

namespace thalweg::terrain {

/// What drains into pits, basin by basin, found from the pits up: what no pit takes is not touched, so a few lakes in a
/// wide landscape cost little. Basin 0 is the outside and has no list.
struct LakeBasins {
    std::vector<Index> pit;                     ///< per basin; the outside has `none`
    std::vector<std::span<const Index>> nodes;  ///< per basin: the pit first, every node after its receiver
    std::span<const Index> basin;               ///< per node: the number of its basin; `outside` also without data

    Index count() const { return static_cast<Index>(pit.size()); }
};

/// The basins of the pits (`pit` begins with an entry for the outside). Good as long as the buffers are. Linear in the
/// nodes inside; on several threads, each with basins of its own.
LakeBasins lake_basins(const Grid&, const FlowDirections&, std::vector<Index> pit, LakeBuffers&);
LakeBasins lake_basins(const Mesh&, const FlowDirections&, std::vector<Index> pit, LakeBuffers&);

/// The lowest pass between each two basins, and from each basin to the outside: written to `LakeBuffers::search`.
void passes_between(const Terrain<Grid>&, const LakeBasins&, LakeBuffers&);
void passes_between(const Terrain<Mesh>&, const LakeBasins&, LakeBuffers&);

}  // namespace thalweg::terrain
