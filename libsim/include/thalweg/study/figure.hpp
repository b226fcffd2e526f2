// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <string>

namespace thalweg::study {

/// Draws the figures of a command's folder (`what`: analyze, simulate, fit, compare), or the report of a study
/// (`report`), by running the plotting scripts beside the program in Debian's Python (THALWEG_PYTHON names another).
/// Throws Error if they cannot run, with what they said.
void draw_figures(const std::string& what, const std::filesystem::path& folder);

}  // namespace thalweg::study
