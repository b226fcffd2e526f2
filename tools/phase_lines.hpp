// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <chrono>
#include <condition_variable>
#include <mutex>
#include <string>
#include <thread>

namespace thalweg::tools {

/// Where no terminal shows a status line: a line on standard error for each phase of long work, so that a log tells
/// what is under way. Nothing of what is over within seconds, as errors of the user's are: those stay one line. A phase
/// is what its text says before the first number.
class PhaseLines {
  public:
    PhaseLines() : last_(Clock::now()), teller_([this] { tell(); }) {}
    ~PhaseLines();
    PhaseLines(const PhaseLines&) = delete;
    PhaseLines& operator=(const PhaseLines&) = delete;

    void status(const std::string& text);

  private:
    using Clock = std::chrono::steady_clock;
    static constexpr std::chrono::seconds between_phases{5}, within_a_phase{60};

    void tell();

    std::mutex mutex_;
    std::condition_variable changed_;
    std::string text_, told_;
    bool done_ = false;
    Clock::time_point last_;  ///< when a line was last written, or the work began
    std::thread teller_;
};

}  // namespace thalweg::tools
