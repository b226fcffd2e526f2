// SPDX-License-Identifier: GPL-3.0-or-later
#include "thalweg/study/grow.hpp"

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
    run_into_folder(options.common, "grow",
                    [&](const auto& folder, const study::Messages& m) { return study::grow(e, folder, m); });
}

}  // namespace

void add_grow(CLI::App& app) {
    CLI::App* command = app.add_subcommand("grow", "Grow a drainage network and its terrain from an experiment file");
    auto options = std::make_shared<Options>();
    add_experiment_options(*command, options->experiment);
    add_common_options(*command, options->common, "growth");
    command->callback([options] { run(*options); });
}

}  // namespace thalweg::tools
