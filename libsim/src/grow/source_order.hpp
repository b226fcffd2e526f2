// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <vector>

#include "thalweg/core/index.hpp"

namespace thalweg::grow {

/// The sources in an order in which those upstream of any link stand together, so that a link's magnitude is a
/// difference of two ranks; walking to the outlet at every junction would cost N^1.5.
///
/// The row of a stream is: its opening mark, the rows of its tributaries from the mouth up, its source. A tree search
/// structure with random priorities (treap; Seidel & Aragon 1996) in flat arrays: log N per insertion and rank.
class SourceOrder {
  public:
    /// The trunk alone.
    SourceOrder();

    /// Mark that opens a stream, and its source.
    static Index opening(Index stream) { return 2 * stream; }
    static Index source(Index stream) { return 2 * stream + 1; }

    /// Puts the row of a new stream right behind a mark; streams are numbered as they come.
    void add_stream(Index behind);

    /// Number of sources behind `mark`, up to and with the last one, `source`.
    Index count(Index mark, Index source) const { return rank(source) - rank(mark); }

  private:
    void insert(Index behind);
    void rotate_up(Index mark);
    Index rank(Index mark) const;  ///< number of sources up to and with this mark

    struct Node {
        Index left, right, parent;
        Index sources;  ///< in the subtree
    };

    std::vector<Node> nodes_;  ///< per mark
    std::vector<std::uint64_t> priority_;
};

}  // namespace thalweg::grow
