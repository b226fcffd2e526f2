// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <vector>

#include "thalweg/core/index.hpp"

namespace thalweg::grow {

/// The sources in an order in which those upstream of any link stand together, so that a link's magnitude is a
/// difference of two ranks; walking to the outlet at every junction would cost N^1.5.
///
/// The row of a stream is: its opening mark, the rows of its tributaries from the mouth up, its source. The marks lie
/// in blocks, these in blocks of blocks and so on, each member with the number of sources in it (a B-tree with counts;
/// Bayer & McCreight 1972): log N per insertion and rank, with few places in memory on the way.
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

    void reserve(Index streams);

    /// Asks memory for a mark, then for its block, then for the block's own, without waiting.
    void ask_for(Index mark) const { __builtin_prefetch(&block_of_[mark]); }
    void ask_for_block(Index mark) const { ask_for_lines(block_of_[mark]); }
    void ask_for_block_above(Index mark) const {
        const Index above = blocks_[block_of_[mark]].parent;
        if (above != none) ask_for_lines(above);
    }

  private:
    static constexpr Index most_members = 32;

    struct Block {
        Index parent = none;  ///< block
        Index size = 0;
        bool of_marks = true;  ///< and not of blocks
        std::array<Index, most_members> member;
        std::array<Index, most_members> sources;  ///< in each member
    };

    void insert(Index behind);
    void make_room(Index block);
    void split(Index block);
    void put(Index block, Index position, Index member, Index sources);
    Index position(Index block, Index member) const;
    Index rank(Index mark) const;  ///< number of sources up to and with this mark
    void ask_for_lines(Index block) const;

    std::vector<Block> blocks_;
    std::vector<Index> block_of_;  ///< per mark
};

}  // namespace thalweg::grow
