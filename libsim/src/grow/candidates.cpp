// SPDX-License-Identifier: GPL-3.0-or-later
#include "grow/candidates.hpp"

#include <algorithm>
#include <bit>

namespace thalweg::grow {
namespace {

constexpr int bits_below_bin = 46;  // of a double's 52 of mantissa: 64 bins to an octave
constexpr std::uint64_t bins_kept = 64 * 60;

}  // namespace

Candidates::Candidates(double largest) : bins_(bins_kept), open_(bins_kept) {
    const std::uint64_t top = std::bit_cast<std::uint64_t>(largest) >> bits_below_bin;
    lowest_bits_ = top - std::min(top, bins_kept - 1);
}

/// Positive doubles are in the order of their bits. What is below the lowest bin or above the highest goes into these.
std::size_t Candidates::bin_of(double excess) const {
    const std::uint64_t bits = std::bit_cast<std::uint64_t>(excess) >> bits_below_bin;
    return std::min(bits - std::min(bits, lowest_bits_), bins_kept - 1);
}

void Candidates::push(const Candidate& candidate) {
    const std::size_t bin = bin_of(candidate.excess);
    if (bin >= open_) {
        late_.push(candidate);
    } else {
        bins_[bin].push_back(candidate);
    }
}

bool Candidates::sort_next_bin() {
    while (open_ > 0 && bins_[open_ - 1].empty()) --open_;
    if (open_ == 0) return false;
    sorted_ = std::move(bins_[--open_]);
    bins_[open_] = {};
    std::sort(sorted_.begin(), sorted_.end());
    return true;
}

bool Candidates::pop(Candidate& largest) {
    if (sorted_.empty() && late_.empty() && !sort_next_bin()) {
        open_ = bins_.size();  // who enters now finds all bins as at first
        return false;
    }
    if (late_.empty() || (!sorted_.empty() && late_.top() < sorted_.back())) {
        largest = sorted_.back();
        sorted_.pop_back();
    } else {
        largest = late_.top();
        late_.pop();
    }
    return true;
}

}  // namespace thalweg::grow
