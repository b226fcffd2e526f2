// SPDX-License-Identifier: GPL-3.0-or-later
#include "thalweg/study/simulate.hpp"

#include <memory>

#include "command.hpp"

namespace thalweg::tools {
namespace {

struct Options {
    CommonOptions common;
    std::string file;
    std::vector<std::string> set;
    std::string seed;
};

void run(const Options& options) {
    std::vector<std::string> overrides = options.set;
    if (!options.seed.empty()) overrides.push_back("seed=" + options.seed);
    const study::Experiment experiment = study::read_experiment(options.file, overrides);
    run_into_folder(options.common, "simulate", [&](const auto& folder, const study::Messages& m) {
        return study::simulate(experiment, folder, m);
    });
}

}  // namespace

void add_simulate(CLI::App& app) {
    CLI::App* command = app.add_subcommand("simulate", "Simulate a stream-power landscape from an experiment file");
    auto options = std::make_shared<Options>();
    command->add_option("EXPERIMENT", options->file, "experiment file (TOML)")->required();
    command->add_option("--set", options->set, "another value for a key, e.g. --set river.k=2e-5")
        ->allow_extra_args(false);
    command->add_option("--seed", options->seed, "another seed");
    add_common_options(*command, options->common, "simulation");
    command->footer("Keys of the experiment file:\n" + study::experiment_reference());
    command->callback([options] { run(*options); });
}

}  // namespace thalweg::tools
