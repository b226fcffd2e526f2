// SPDX-License-Identifier: GPL-3.0-or-later
#include "thalweg/study/simulate.hpp"

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
    run_into_folder(options.common, "simulate",
                    [&](const auto& folder, const study::Messages& m) { return study::simulate(e, folder, m); });
}

}  // namespace

void add_simulate(CLI::App& app) {
    CLI::App* command = app.add_subcommand("simulate", "Simulate a stream-power landscape from an experiment file");
    auto options = std::make_shared<Options>();
    add_experiment_options(*command, options->experiment);
    add_common_options(*command, options->common, "simulation");
    command->callback([options] { run(*options); });
}

}  // namespace thalweg::tools
