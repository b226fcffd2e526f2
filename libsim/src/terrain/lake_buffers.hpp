// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <span>
#include <vector>

#include "terrain/basin_graph.hpp"
#include "thalweg/core/grid.hpp"
#include "thalweg/core/mesh.hpp"

namespace thalweg::terrain {

/// For one thread's share of the basins.
struct PassBuffers {
    std::vector<Pass> passes;  ///< the lowest between each two basins
    std::vector<Index> place;  ///< per basin: where in them
};

/// Memory that finding lakes needs; kept from step to step it is allocated once.
struct LakeBuffers {
    std::vector<Index> basin;               ///< per node
    std::vector<std::vector<Index>> lists;  ///< nodes by basin, for some basins each
    std::vector<PassBuffers> search;
    std::vector<Index> receiver;  ///< per node of a mesh
};

/// `drain_lakes` with memory that is already there.
Index drain_lakes(const Grid&, std::span<const double> elevation_m, std::span<const Boundary>, FlowDirections&,
                  LakeBuffers&);
Index drain_lakes(const Mesh&, std::span<const double> elevation_m, std::span<const Boundary>, FlowDirections&,
                  LakeBuffers&);

}  // namespace thalweg::terrain
