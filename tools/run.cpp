// SPDX-License-Identifier: GPL-3.0-or-later
#include "thalweg/study/run.hpp"

#include <memory>

#include "command.hpp"

namespace thalweg::tools {
namespace {

struct Options {
    CommonOptions common;
    ExperimentOptions experiment;
};

void run(const Options& options) {
    const study::Experiment e = experiment(options.experiment);
    const auto figures = options.common.no_figures ? study::Figures::leave_out : study::Figures::draw;
    run_into_folder(options.common, "", [&](const auto& folder, const study::Messages& m) {
        return study::run_study(e, figures, folder, m);
    });
}

}  // namespace

void add_run(CLI::App& app) {
    CLI::App* command =
        app.add_subcommand("run", "A whole study: measure a DEM, fit k and m, simulate with them, compare, report");
    auto options = std::make_shared<Options>();
    add_experiment_options(*command, options->experiment);
    add_common_options(*command, options->common, "study");
    command->callback([options] { run(*options); });
}

}  // namespace thalweg::tools
