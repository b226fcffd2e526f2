// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <functional>
#include <memory>

#include "thalweg/core/index.hpp"

namespace thalweg {

/// While it lives, at most `threads` threads work (0: as many as the machine has).
class ThreadLimit {
  public:
    explicit ThreadLimit(int threads);
    ~ThreadLimit();
    ThreadLimit(const ThreadLimit&) = delete;
    ThreadLimit& operator=(const ThreadLimit&) = delete;

  private:
    struct Control;
    std::unique_ptr<Control> control_;
};

/// Threads that may work now.
int thread_limit();

/// Calls body(first, last) on disjoint pieces that together cover [begin, end), in any order and on several threads.
/// `body` must write only what belongs to its own piece, so the result does not depend on the number of threads.
void parallel_for(Index begin, Index end, const std::function<void(Index, Index)>& body, Index grain = 16384);

}  // namespace thalweg
