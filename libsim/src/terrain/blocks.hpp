// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <cstdint>

#include "thalweg/core/grid.hpp"
#include "thalweg/core/index.hpp"
#include "thalweg/core/parallel.hpp"

namespace thalweg::terrain {

/// Nodes cut into blocks of consecutive numbers (strips of a grid, patches of a mesh), one for a thread at a time. What
/// happens within a block is done block by block, what crosses their borders afterwards and in a fixed order. The cut
/// depends on the number of nodes alone, so that the number of threads changes nothing.
class Blocks {
  public:
    explicit Blocks(Index nodes, Index smallest = Index{1} << 16, Index most = 8)
        : nodes_(nodes), count_(std::clamp<Index>(nodes / smallest, 1, most)) {}

    Index count() const { return count_; }
    Index first(Index block) const { return static_cast<Index>(std::uint64_t{nodes_} * block / count_); }
    Index last(Index block) const { return first(block + 1); }

    /// Calls body(block) for every block, on several threads.
    template <class Body>
    void for_each(Body body) const {
        const auto some = [&](Index from, Index to) {
            for (Index block = from; block < to; ++block) body(block);
        };
        parallel_for(0, count_, some, 1);
    }

  private:
    Index nodes_;
    Index count_;
};

/// Blocks of whole rows, numbered by rows.
inline Blocks row_blocks(const Grid& grid) { return Blocks(grid.rows, std::max<Index>(1, 65536 / grid.cols)); }

}  // namespace thalweg::terrain
