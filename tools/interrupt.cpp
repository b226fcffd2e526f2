// SPDX-License-Identifier: GPL-3.0-or-later
#include "interrupt.hpp"

#include "thalweg/study/script.hpp"

#include <pthread.h>
#include <signal.h>
#include <unistd.h>

#include <iostream>

namespace thalweg::tools {
namespace {

constexpr int leave = SIGUSR1;  // the guard's own word to its watcher

sigset_t watched_signals() {
    sigset_t set;
    sigemptyset(&set);
    for (const int sign : {SIGINT, SIGTERM, SIGHUP, leave}) sigaddset(&set, sign);
    return set;
}

void watch(const std::function<void()>& discard, const std::function<std::string()>& left_behind) {
    const sigset_t set = watched_signals();
    int sign = 0;
    sigwait(&set, &sign);
    if (sign == leave) return;
    study::stop_script();
    discard();
    const std::string rest = left_behind ? left_behind() : "";
    std::cerr << "thalweg: error: stopped by a signal; nothing was written" + rest + "\n" << std::flush;
    ::_exit(128 + sign);
}

}  // namespace

void hold_back_signals() {
    const sigset_t set = watched_signals();
    pthread_sigmask(SIG_BLOCK, &set, nullptr);
    ::signal(SIGXFSZ, SIG_IGN);
    ::signal(SIGPIPE, SIG_IGN);
}

void let_signals_through() {
    const sigset_t set = watched_signals();
    pthread_sigmask(SIG_UNBLOCK, &set, nullptr);
    ::signal(SIGXFSZ, SIG_DFL);
    ::signal(SIGPIPE, SIG_DFL);
}

InterruptGuard::InterruptGuard(std::function<void()> discard, std::function<std::string()> left_behind)
    : watcher_([discard = std::move(discard), left_behind = std::move(left_behind)] { watch(discard, left_behind); }) {}

InterruptGuard::~InterruptGuard() {
    pthread_kill(watcher_.native_handle(), leave);
    watcher_.join();
}

}  // namespace thalweg::tools
