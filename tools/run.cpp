// SPDX-License-Identifier: GPL-3.0-or-later
#include "thalweg/study/run.hpp"

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
    const auto figures = options.common.no_figures ? study::Figures::leave_out : study::Figures::draw;
    run_into_folder(options.common, "", [&](const auto& folder, const study::Messages& m) {
        return study::run_study(experiment, figures, folder, m);
    });
}

}  // namespace

void add_run(CLI::App& app) {
    CLI::App* command =
        app.add_subcommand("run", "A whole study: measure a DEM, fit k and m, simulate with them, compare, report");
    auto options = std::make_shared<Options>();
    command->add_option("EXPERIMENT", options->file, "experiment file (TOML) with a [study] section")->required();
    command->add_option("--set", options->set, "another value for a key, e.g. --set study.uplift_m_per_yr=5e-4")
        ->allow_extra_args(false);
    command->add_option("--seed", options->seed, "another seed");
    add_common_options(*command, options->common, "study");
    command->footer("Keys of the experiment file:\n" + study::experiment_reference());
    command->callback([options] { run(*options); });
}

}  // namespace thalweg::tools
