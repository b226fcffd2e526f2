// SPDX-License-Identifier: GPL-3.0-or-later
#include "thalweg/study/simulate.hpp"

#include <memory>

#include "command.hpp"

namespace thalweg::tools {
namespace {

struct Options {
    CommonOptions common;
    ExperimentOptions experiment;
    bool resume = false;
};

study::StoppedRun stopped_run(const Options& options) {
    if (options.resume) return study::StoppedRun::resume;
    return options.common.force ? study::StoppedRun::forget : study::StoppedRun::refuse;
}

void run(const Options& options) {
    const study::Experiment e = experiment(options.experiment);
    study::CheckpointFolder checkpoints(options.common.out, stopped_run(options));
    run_into_folder(
        options.common, "simulate",
        [&](const auto& folder, const study::Messages& m) { return study::simulate(e, folder, m, &checkpoints); },
        [&] { return checkpoints.left_behind(); });
    checkpoints.results_are_written();
}

}  // namespace

void add_simulate(CLI::App& app) {
    CLI::App* command = app.add_subcommand("simulate", "Simulate a stream-power landscape from an experiment file");
    auto options = std::make_shared<Options>();
    add_experiment_options(*command, options->experiment);
    add_common_options(*command, options->common, "simulation");
    command->add_flag("--resume", options->resume, "go on with a run that was stopped (see output.checkpoint_every)");
    command->callback([options] { run(*options); });
}

}  // namespace thalweg::tools
