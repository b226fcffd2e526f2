// SPDX-License-Identifier: GPL-3.0-or-later
#include "thalweg/study/grow.hpp"

#include "command.hpp"

namespace thalweg::tools {

void add_grow(CLI::App& app) {
    add_experiment_command(app,
                           {.name = "grow",
                            .help = "Grow a drainage network and its terrain from an experiment file",
                            .figures = "grow",
                            .default_out = "growth"},
                           [](const study::Experiment& e, study::Figures, const auto& folder,
                              const study::Messages& messages) { return study::grow(e, folder, messages); });
}

}  // namespace thalweg::tools
