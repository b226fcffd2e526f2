// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <cstdint>
#include <queue>
#include <span>
#include <vector>

#include "thalweg/core/index.hpp"

namespace thalweg::grow {

/// A link that may grow, with the excess it had when it was entered.
struct Candidate {
    double excess;  ///< m², above 0
    Index link;
    bool operator<(const Candidate& other) const {
        return excess != other.excess ? excess < other.excess : link > other.link;
    }
};

/// Candidates, the largest first; the smaller number on ties.
///
/// A queue that knows what comes next, so that memory can be asked for it ahead. Candidates lie unsorted in bins of
/// excess (64 to an octave) until theirs is the highest; then the bin is sorted. Those that come into a bin already
/// sorted wait in a heap, which stays small: what grows leaves smaller excesses behind. N log N as a heap has it, but
/// all but the highest bin is only written to, one end at a time.
class Candidates {
  public:
    /// `largest`: no candidate's excess is far above it. More is allowed, and slow.
    explicit Candidates(double largest);

    void push(const Candidate&);

    /// Takes the largest; false if there is none.
    bool pop(Candidate&);

    /// Up to `count` that come next, the first of them last, but for those that wait in the heap or are yet to enter.
    std::span<const Candidate> upcoming(std::size_t count) const {
        return std::span(sorted_).last(std::min(count, sorted_.size()));
    }

  private:
    std::size_t bin_of(double excess) const;
    bool sort_next_bin();

    std::uint64_t lowest_bits_;
    std::vector<std::vector<Candidate>> bins_;
    std::size_t open_;               ///< bins from this one on are not used any more
    std::vector<Candidate> sorted_;  ///< what lay in the open bin, the largest last
    std::priority_queue<Candidate> late_;
};

}  // namespace thalweg::grow
