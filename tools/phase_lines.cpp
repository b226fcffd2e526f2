// SPDX-License-Identifier: GPL-3.0-or-later
#include "phase_lines.hpp"

#include <iostream>

namespace thalweg::tools {
namespace {

std::string phase_of(const std::string& text) { return text.substr(0, text.find_first_of("0123456789")); }

}  // namespace

PhaseLines::~PhaseLines() {
    {
        const std::lock_guard lock(mutex_);
        done_ = true;
    }
    changed_.notify_one();
    teller_.join();
}

void PhaseLines::status(const std::string& text) {
    {
        const std::lock_guard lock(mutex_);
        text_ = text;
    }
    changed_.notify_one();
}

void PhaseLines::tell() {
    std::unique_lock lock(mutex_);
    while (!done_) {
        if (text_ == told_) {
            changed_.wait(lock);
            continue;
        }
        const auto pause = phase_of(text_) == phase_of(told_) ? within_a_phase : between_phases;
        if (Clock::now() < last_ + pause) {
            changed_.wait_until(lock, last_ + pause);
            continue;
        }
        std::cerr << "thalweg: " + text_ + '\n' << std::flush;
        told_ = text_;
        last_ = Clock::now();
    }
}

}  // namespace thalweg::tools
