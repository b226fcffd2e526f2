// SPDX-License-Identifier: GPL-3.0-or-later
#include "thalweg/study/compare.hpp"

#include <cmath>
#include <memory>

#include "command.hpp"
#include "thalweg/core/error.hpp"

namespace thalweg::tools {
namespace {

struct Options {
    CommonOptions common;
    DemOptions dem;
    std::string a, b;
    std::string cells = "common";
    std::string realisations;
};

/// A thousand have half a million distances between them.
Index parse_realisations(const std::string& text) {
    if (text.empty()) return 0;
    const double number = parse_number("--realisations", text, Sign::not_negative);
    if (number != std::floor(number) || number > 1000) {
        throw Error("--realisations is a whole number up to 1000, not " + text);
    }
    return static_cast<Index>(number);
}

void run(const Options& options) {
    const study::CompareOptions compare{read_options(options.dem), measure_options(options.dem),
                                        options.cells == "own" ? study::CompareCells::own : study::CompareCells::common,
                                        parse_realisations(options.realisations)};
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
    command->add_option(
        "--realisations", options->realisations,
        "run each side that is a simulation or grown with so many other seeds, and judge the distances by "
        "theirs; 20 are enough to tell [default: none]");
    add_dem_options(*command, options->dem);
    add_common_options(*command, options->common, "comparison");
    command->callback([options] { run(*options); });
}

}  // namespace thalweg::tools
