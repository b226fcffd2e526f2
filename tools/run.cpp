// SPDX-License-Identifier: GPL-3.0-or-later
#include "thalweg/study/run.hpp"

#include "command.hpp"

namespace thalweg::tools {

void add_run(CLI::App& app) {
    add_experiment_command(
        app,
        {.name = "run",
         .help = "A whole study: measure a DEM, fit k and m, simulate with them, compare, report",
         .figures = "",
         .default_out = "study"},
        [](const study::Experiment& e, study::Figures figures, const auto& folder, const study::Messages& messages) {
            return study::run_study(e, figures, folder, messages);
        });
}

}  // namespace thalweg::tools
