// SPDX-License-Identifier: GPL-3.0-or-later
#include "thalweg/study/script.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <signal.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <atomic>
#include <cstdlib>

#include "thalweg/core/error.hpp"

extern char** environ;

namespace thalweg::study {
namespace {

namespace fs = std::filesystem;

/// Process group of the script that is under way, 0 for none: the one thing a stopped program must know of it.
std::atomic<pid_t> running{0};

std::string read_all(int descriptor) {
    std::string text;
    std::array<char, 4096> block;
    for (ssize_t got; (got = ::read(descriptor, block.data(), block.size())) > 0;) {
        text.append(block.data(), static_cast<std::size_t>(got));
    }
    return text;
}

std::string last_line(std::string text) {
    while (!text.empty() && text.back() == '\n') text.pop_back();
    const std::size_t newline = text.rfind('\n');
    return newline == std::string::npos ? text : text.substr(newline + 1);
}

/// The interpreter, the script and its words. -I: nothing of the user's own Python gets in.
std::vector<std::string> command_line(const fs::path& script, const std::vector<std::string>& words) {
    const char* named = std::getenv("THALWEG_PYTHON");
    std::vector<std::string> command{named != nullptr ? named : "/usr/bin/python3", "-I", script.string()};
    command.insert(command.end(), words.begin(), words.end());
    return command;
}

std::vector<char*> as_arguments(const std::vector<std::string>& command) {
    std::vector<char*> arguments;
    for (const std::string& word : command) arguments.push_back(const_cast<char*>(word.c_str()));
    arguments.push_back(nullptr);
    return arguments;
}

/// The child's process id, or 0 if it does not start; its standard error goes to `error_end`.
pid_t start(const std::vector<std::string>& command, int error_end) {
    posix_spawn_file_actions_t actions;
    posix_spawn_file_actions_init(&actions);
    posix_spawn_file_actions_addopen(&actions, STDOUT_FILENO, "/dev/null", O_WRONLY, 0);
    posix_spawn_file_actions_adddup2(&actions, error_end, STDERR_FILENO);
    // The program may hold back signals; a child of its own must hear them.
    posix_spawnattr_t attributes;
    posix_spawnattr_init(&attributes);
    sigset_t no_signals;
    sigemptyset(&no_signals);
    posix_spawnattr_setsigmask(&attributes, &no_signals);
    posix_spawnattr_setpgroup(&attributes, 0);
    posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETSIGMASK | POSIX_SPAWN_SETPGROUP);
    std::vector<char*> arguments = as_arguments(command);
    pid_t child = 0;
    const int problem = ::posix_spawn(&child, arguments[0], &actions, &attributes, arguments.data(), environ);
    posix_spawn_file_actions_destroy(&actions);
    posix_spawnattr_destroy(&attributes);
    return problem == 0 ? child : 0;
}

}  // namespace

fs::path script(const std::string& name, const std::string& instead) {
    const fs::path program = fs::read_symlink("/proc/self/exe");
    const fs::path file = program.parent_path().parent_path() / "share/thalweg" / name;
    if (!fs::is_regular_file(file)) {
        throw Error(fmt::format("'{}' is missing; install thalweg whole{}", file.string(), instead));
    }
    return file;
}

ScriptResult run_script(const fs::path& script, const std::vector<std::string>& words) {
    std::array<int, 2> ends{};
    if (::pipe2(ends.data(), O_CLOEXEC) != 0) return {-1, "no pipe"};
    const pid_t child = start(command_line(script, words), ends[1]);
    running = child;
    ::close(ends[1]);
    ScriptResult result{-1, child != 0 ? last_line(read_all(ends[0])) : "python does not start"};
    ::close(ends[0]);
    int status = 0;
    if (child != 0 && ::waitpid(child, &status, 0) == child && WIFEXITED(status)) {
        result.exit_code = WEXITSTATUS(status);
    }
    running = 0;
    return result;
}

void stop_script() {
    const pid_t group = running;
    if (group > 0) ::kill(-group, SIGKILL);
}

void become_script(const fs::path& script, const std::vector<std::string>& words) {
    const std::vector<std::string> command = command_line(script, words);
    std::vector<char*> arguments = as_arguments(command);
    ::execv(arguments[0], arguments.data());
}

}  // namespace thalweg::study
