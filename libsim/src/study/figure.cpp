// SPDX-License-Identifier: GPL-3.0-or-later
#include "thalweg/study/figure.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <signal.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <atomic>
#include <cstdlib>
#include <vector>

#include "thalweg/core/error.hpp"

extern char** environ;

namespace thalweg::study {
namespace {

namespace fs = std::filesystem;

/// share/thalweg/figures beside the program's bin, in the build tree as after installing.
fs::path script() {
    const fs::path program = fs::read_symlink("/proc/self/exe");
    const fs::path file = program.parent_path().parent_path() / "share/thalweg/figures/thalweg_figures.py";
    if (!fs::is_regular_file(file)) {
        throw Error(fmt::format("the plotting scripts are not at '{}'; install thalweg whole, or use --no-figures",
                                file.string()));
    }
    return file;
}

/// Process group of the drawing that is under way, 0 for none: the one thing a stopped program must know of it.
std::atomic<pid_t> drawing{0};

struct ProgramResult {
    int exit_code;     ///< -1: it did not start
    std::string said;  ///< on its standard error
};

std::string read_all(int descriptor) {
    std::string text;
    std::array<char, 4096> block;
    for (ssize_t got; (got = ::read(descriptor, block.data(), block.size())) > 0;) {
        text.append(block.data(), static_cast<std::size_t>(got));
    }
    return text;
}

ProgramResult run_program(const std::vector<std::string>& words) {
    std::array<int, 2> ends{};
    if (::pipe2(ends.data(), O_CLOEXEC) != 0) return {-1, "no pipe"};
    posix_spawn_file_actions_t actions;
    posix_spawn_file_actions_init(&actions);
    posix_spawn_file_actions_addopen(&actions, STDOUT_FILENO, "/dev/null", O_WRONLY, 0);
    posix_spawn_file_actions_adddup2(&actions, ends[1], STDERR_FILENO);
    // The program may hold back signals; a child of its own must hear them.
    posix_spawnattr_t attributes;
    posix_spawnattr_init(&attributes);
    sigset_t no_signals;
    sigemptyset(&no_signals);
    posix_spawnattr_setsigmask(&attributes, &no_signals);
    posix_spawnattr_setpgroup(&attributes, 0);
    posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETSIGMASK | POSIX_SPAWN_SETPGROUP);
    std::vector<char*> arguments;
    for (const std::string& word : words) arguments.push_back(const_cast<char*>(word.c_str()));
    arguments.push_back(nullptr);
    pid_t child = 0;
    const int problem = ::posix_spawn(&child, arguments[0], &actions, &attributes, arguments.data(), environ);
    posix_spawn_file_actions_destroy(&actions);
    posix_spawnattr_destroy(&attributes);
    if (problem == 0) drawing = child;
    ::close(ends[1]);
    ProgramResult result{-1, problem == 0 ? read_all(ends[0]) : "it does not start"};
    ::close(ends[0]);
    int status = 0;
    if (problem == 0 && ::waitpid(child, &status, 0) == child && WIFEXITED(status)) {
        result.exit_code = WEXITSTATUS(status);
    }
    drawing = 0;
    return result;
}

std::string last_line(std::string text) {
    while (!text.empty() && text.back() == '\n') text.pop_back();
    const std::size_t newline = text.rfind('\n');
    return newline == std::string::npos ? text : text.substr(newline + 1);
}

}  // namespace

void draw_figures(const std::string& what, const fs::path& folder) {
    const char* named = std::getenv("THALWEG_PYTHON");
    const std::string python = named != nullptr ? named : "/usr/bin/python3";
    const ProgramResult result = run_program({python, "-I", script().string(), what, folder.string()});
    if (result.exit_code == 0) return;
    throw Error(
        fmt::format("the figures could not be drawn: {} (they need python3-matplotlib and python3-gdal; "
                    "--no-figures leaves them out)",
                    result.said.empty() ? "python ended abnormally" : last_line(result.said)));
}

void stop_drawing() {
    const pid_t group = drawing;
    if (group > 0) ::kill(-group, SIGKILL);
}

}  // namespace thalweg::study
