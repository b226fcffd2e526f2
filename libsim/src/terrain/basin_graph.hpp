// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <span>
#include <vector>

#include "thalweg/core/index.hpp"

namespace thalweg::terrain {

/// Basin 0 is the outside: every node whose water already reaches an outlet.
inline constexpr Index outside = 0;

/// A way between two basins: the edge between two neighbouring nodes, as high as the higher of them.
struct Pass {
    double height_m;
    Index basin, node;              ///< the one side
    Index other_basin, other_node;  ///< the other; `none` as node: straight out of the domain
};

/// Total order of passes, so that the tree below is unique: height, then the smaller node, then the larger.
bool lower(const Pass&, const Pass&);

/// The lowest pass between each pair of basins, as they are offered: a hash table with open addressing.
class LowestPasses {
  public:
    explicit LowestPasses(Index expected);
    void offer(const Pass&);
    std::vector<Pass> take() { return std::move(passes_); }

  private:
    std::size_t find_slot(Index basin, Index other_basin) const;
    void grow();

    std::vector<Pass> passes_;
    std::vector<Index> table_;  // positions in passes_, `none` where free; a power of two long
};

/// How each basin drains: over `node` (its own) into `other_node` of `other_basin`, at `height_m`.
struct SpillTree {
    std::vector<Pass> way_out;  ///< per basin; that of the outside is not used
    std::vector<Index> order;   ///< basins, each after the one it spills into; begins with the outside
    Index lakes;                ///< basins that hold water; a flat pit counts once, however many basins it makes
};

/// Kruskal's algorithm from the outside. `pit` is the lowest node of each basin. Pieces that no pass joins to the
/// outside drain at the lowest of their pits (ties: the lower node).
SpillTree spill_tree(std::vector<Pass> passes, std::span<const Index> pit, std::span<const double> elevation_m);

}  // namespace thalweg::terrain
