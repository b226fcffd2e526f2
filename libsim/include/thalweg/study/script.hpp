// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace thalweg::study {

/// A Python source beside the program: `name` is "figures/thalweg_figures.py" for <prefix>/share/thalweg/figures/…, in
/// the build tree as after installing. Throws Error, with `instead` as advice, if it is not there.
std::filesystem::path script(const std::string& name, const std::string& instead);

/// What a program that was run said and returned.
struct ScriptResult {
    int exit_code;     ///< -1: it did not start, or ended by a signal
    std::string said;  ///< the last line on its standard error
};

/// Runs a script with Debian's Python (THALWEG_PYTHON names another) and waits for it. It hears signals.
ScriptResult run_script(const std::filesystem::path& script, const std::vector<std::string>& words);

/// Ends a script that is under way, for a program that is being stopped. May be called from any thread.
void stop_script();

/// Becomes the script: its output, exit code and signals are this program's. Returns only if Python cannot be started.
void become_script(const std::filesystem::path& script, const std::vector<std::string>& words);

}  // namespace thalweg::study
