// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

namespace thalweg::evolve {

/// Sum whose rounding error is carried along (the two-sum of Knuth), so that volumes of 1e8 nodes over 1e4 steps keep
/// all but the last digit.
class CompensatedSum {
  public:
    void add(double term) {
        const double next = sum_ + term;
        const double kept = next - sum_;
        lost_ += (sum_ - (next - kept)) + (term - kept);
        sum_ = next;
    }
    double value() const { return sum_ + lost_; }

  private:
    double sum_ = 0;
    double lost_ = 0;
};

}  // namespace thalweg::evolve
