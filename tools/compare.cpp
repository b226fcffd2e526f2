// SPDX-License-Identifier: GPL-3.0-or-later
#include "thalweg/study/compare.hpp"

#include <memory>

#include "command.hpp"

namespace thalweg::tools {
namespace {

struct Options {
    CommonOptions common;
    DemOptions dem;
    std::string a, b;
    std::string cells = "common";
};

void run(const Options& options) {
    const study::CompareOptions compare{
        read_options(options.dem), measure_options(options.dem),
        options.cells == "own" ? study::CompareCells::own : study::CompareCells::common};
    run_into_folder(options.common, "compare", [&](const auto& folder, const study::Messages& m) {
        return study::compare(options.a, options.b, compare, folder, m);
    });
}

}  // namespace

void add_compare(CLI::App& app) {
    CLI::App* command = app.add_subcommand("compare", "Compare two terrains: slope-area, hypsometry, networks");
    auto options = std::make_shared<Options>();
    command->add_option("A", options->a, "a DEM, or the folder of an analyze, simulate or grow run")->required();
    command->add_option("B", options->b, "the same")->required();
    command
        ->add_option("--cells", options->cells,
                     "where cells differ in size, bring the finer terrain to the coarser one's, or leave each its own")
        ->check(CLI::IsMember({"common", "own"}))
        ->capture_default_str();
    add_dem_options(*command, options->dem);
    add_common_options(*command, options->common, "comparison");
    command->callback([options] { run(*options); });
}

}  // namespace thalweg::tools
