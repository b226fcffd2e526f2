// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <functional>
#include <string>
#include <thread>

namespace thalweg::tools {

/// Makes the program stoppable without debris: call once before any thread is started. A file size limit then becomes a
/// failed write, and Ctrl-C and its like wait for a guard.
void hold_back_signals();

/// Takes that back, for a program that is about to become another.
void let_signals_through();

/// While it lives, SIGINT, SIGTERM and SIGHUP discard what was written so far, say so in one line, and end the program
/// with 128 plus the signal's number.
class InterruptGuard {
  public:
    /// `left_behind` is called last: it may tidy up, and what it returns ends the line.
    explicit InterruptGuard(std::function<void()> discard, std::function<std::string()> left_behind = {});
    ~InterruptGuard();
    InterruptGuard(const InterruptGuard&) = delete;
    InterruptGuard& operator=(const InterruptGuard&) = delete;

  private:
    std::thread watcher_;
};

}  // namespace thalweg::tools
