// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <limits>
#include <span>
#include <utility>
#include <vector>

#include "thalweg/core/index.hpp"

namespace thalweg::terrain {

/// Basin 0 is the outside: every node whose water already reaches an outlet.
inline constexpr Index outside = 0;

/// A way between two basins: the edge between two neighbouring nodes, as high as the higher of them.
struct Pass {
    double height_m;
    double low_m;                   ///< height of the lower of the two nodes; -infinity outside the domain
    Index basin, node;              ///< the one side
    Index other_basin, other_node;  ///< the other; `none` as node: straight out of the domain
};

/// The edge between two neighbours of different basins.
inline Pass pass_between(std::span<const double> elevation_m, Index basin, Index node, Index other_basin, Index other) {
    const auto [low, high] = std::minmax(elevation_m[node], elevation_m[other]);
    return {high, low, basin, node, other_basin, other};
}

/// From an outlet of the domain straight out.
inline Pass pass_straight_out(std::span<const double> elevation_m, Index basin, Index node) {
    return {elevation_m[node], -std::numeric_limits<double>::infinity(), basin, node, outside, none};
}

/// Total order of passes, so that the tree below is unique: height, then the lower end's height (many edges share their
/// higher end; the lower the other end the steeper the way, and a turned terrain drains as it did), then the smaller
/// node, then the larger.
inline bool lower(const Pass& a, const Pass& b) {
    if (a.height_m != b.height_m) return a.height_m < b.height_m;
    if (a.low_m != b.low_m) return a.low_m < b.low_m;
    const auto key = [](const Pass& pass) {
        return std::pair(std::min(pass.node, pass.other_node), std::max(pass.node, pass.other_node));
    };
    return key(a) < key(b);
}

/// Basins joined to larger and larger pieces, each named by the number that `find` gives (the outside's is not fixed).
class Joined {
  public:
    explicit Joined(Index basins);
    Index find(Index basin);
    /// False if they were joined already.
    bool join(Index a, Index b);
    Index size() const { return static_cast<Index>(parent_.size()); }

  private:
    std::vector<Index> parent_;
    std::vector<Index> size_;
};

/// The passes of the minimum spanning forest, and `joined` over them. By Borůvka's rounds: every piece is joined over
/// its lowest pass, which at least halves their number, and passes within a piece are forgotten, so that in the end
/// none is left. Lists of passes are gone through by several threads; which list a pass stands in does not matter.
std::vector<Pass> spanning_passes(std::span<std::vector<Pass>* const> lists, Joined& joined);

/// How each basin drains: over `node` (its own) into `other_node` of `other_basin`, at `height_m`.
struct SpillTree {
    std::vector<Pass> way_out;  ///< per basin; that of the outside is not used
    std::vector<Index> order;   ///< basins, each after the one it spills into; begins with the outside
    Index lakes;                ///< basins that hold water; a flat pit counts once, however many basins it makes
};

/// Roots the tree at the outside. `pit` is the lowest node of each basin. Pieces that no pass joins to the outside
/// drain at the lowest of their pits (ties: the lower node).
SpillTree spill_tree(std::vector<Pass> tree, Joined& joined, std::span<const Index> pit,
                     std::span<const double> elevation_m);

}  // namespace thalweg::terrain
