// SPDX-License-Identifier: GPL-3.0-or-later
#include "thalweg/study/fit.hpp"

#include <cstdint>
#include <memory>
#include <utility>

#include "command.hpp"
#include "thalweg/core/error.hpp"
#include "thalweg/study/fit_growth.hpp"

namespace thalweg::tools {
namespace {

/// Numbers stay text until they are parsed with our own words for what is wrong.
struct Options {
    CommonOptions common;
    DemOptions dem;
    OutletOptions outlet;
    std::string target;
    std::string uplift, uplift_sd, n, deposition_g, theta_fixed, area_min, area_max;
    std::string method = "slope-area";
    std::string from = "nodes";
    std::string heads;
    std::string seed;
};

study::FitOptions fit_options(const Options& options) {
    study::FitOptions fit;
    fit.from = options.from == "raster" ? study::FitFrom::raster : study::FitFrom::nodes;
    fit.read = read_options(options.dem);
    fit.measure = measure_options(options.dem);
    fit.outlet = outlet_request(options.outlet);
    const auto given = [](const char* name, const std::string& text, Sign sign) -> std::optional<double> {
        if (text.empty()) return std::nullopt;
        return parse_number(name, text, sign);
    };
    fit.fit.uplift_m_per_yr = given("--uplift-m-per-yr", options.uplift, Sign::positive);
    fit.fit.uplift_sd_m_per_yr = given("--uplift-sd", options.uplift_sd, Sign::not_negative).value_or(0);
    fit.fit.n = given("--n", options.n, Sign::positive).value_or(1);
    if (fit.fit.n < 0.3 || fit.fit.n > 5) throw Error("--n must lie between 0.3 and 5, not " + options.n);
    fit.fit.deposition_g = given("--deposition-g", options.deposition_g, Sign::not_negative).value_or(0);
    if (!options.theta_fixed.empty()) fit.fit.theta_fixed = parse_theta("--theta-fixed", options.theta_fixed);
    fit.fit.area_min_m2 = given("--area-min-m2", options.area_min, Sign::not_negative);
    fit.fit.area_max_m2 = given("--area-max-m2", options.area_max, Sign::positive);
    return fit;
}

/// Growth asks for none of what the erosion law is fitted by.
void refuse_options_of_erosion(const Options& options) {
    for (const auto& [name, text] : {std::pair{"--uplift-m-per-yr", options.uplift},
                                     {"--uplift-sd", options.uplift_sd},
                                     {"--n", options.n},
                                     {"--deposition-g", options.deposition_g},
                                     {"--area-min-m2", options.area_min},
                                     {"--area-max-m2", options.area_max},
                                     {"--theta-fixed", options.theta_fixed}}) {
        if (!text.empty())
            throw Error(std::string(name) + " says something of erosion: --method growth has no use for it");
    }
}

void run_growth(const Options& options) {
    refuse_options_of_erosion(options);
    study::GrowthFitOptions fit{.read = read_options(options.dem),
                                .measure = measure_options(options.dem),
                                .outlet = outlet_request(options.outlet)};
    if (!options.heads.empty()) {
        if (fit.measure.channel_area_m2) {
            throw Error("--heads and --channel-area-m2 both say where channels begin: give one of them");
        }
        fit.heads = options.heads;
    }
    if (!options.seed.empty()) fit.seed = parse_seed("--seed", options.seed);
    run_into_folder(options.common, "fit", [&](const auto& folder, const study::Messages& m) {
        return study::fit_growth(options.target, fit, folder, m);
    });
}

void run(const Options& options) {
    if (options.method == "growth") return run_growth(options);
    if (!options.seed.empty()) throw Error("--seed is for --method growth: nothing else here is random");
    if (!options.heads.empty()) throw Error("--heads is for --method growth: a slope-area curve needs no channels");
    const study::FitOptions fit = fit_options(options);
    run_into_folder(options.common, "fit", [&](const auto& folder, const study::Messages& m) {
        return study::fit(options.target, fit, folder, m).json;
    });
}

}  // namespace

void add_fit(CLI::App& app) {
    CLI::App* command = app.add_subcommand(
        "fit", "Fit k and m to the slope-area curve of a DEM or a simulation, or the dials of network growth");
    auto options = std::make_shared<Options>();
    command->add_option("TARGET", options->target, "a DEM, or the folder of an analyze, simulate or grow run")
        ->required();
    command->add_option("--uplift-m-per-yr", options->uplift,
                        "uplift rate; without it only theta, ks and k/u are told");
    command->add_option("--uplift-sd", options->uplift_sd, "its standard deviation (m/yr), carried into k's error");
    command->add_option("--n", options->n, "slope exponent [default: 1]");
    command->add_option("--deposition-g", options->deposition_g,
                        "G of rivers that lay down sediment: slopes tell k/((1 + G)*u) [default: 0]");
    command->add_option("--method", options->method, "what is matched")
        ->check(CLI::IsMember({"slope-area", "growth"}))
        ->capture_default_str();
    command->add_option("--area-min-m2", options->area_min, "smallest drainage area in the fit");
    command->add_option("--area-max-m2", options->area_max, "largest drainage area in the fit");
    command->add_option("--theta-fixed", options->theta_fixed, "hold the concavity m/n at this value, at most 2");
    command->add_option("--from", options->from, "of a simulation: its mesh nodes, or its raster measured like a DEM")
        ->check(CLI::IsMember({"nodes", "raster"}))
        ->capture_default_str();
    add_outlet_options(*command, options->outlet);
    command->add_option("--heads", options->heads,
                        "of growth: points where channels begin, instead of a drainage area");
    command->add_option("--seed", options->seed, "of growth: another seed [default: 1]");
    add_dem_options(*command, options->dem);
    add_common_options(*command, options->common, "fit");
    command->callback([options] { run(*options); });
}

}  // namespace thalweg::tools
