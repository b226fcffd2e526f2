// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <CLI/CLI.hpp>

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "thalweg/study/analyze.hpp"
#include "thalweg/study/parameters.hpp"
#include "thalweg/study/run.hpp"

namespace thalweg::tools {

/// Options that every command has.
struct CommonOptions {
    std::string out;
    bool force = false;
    bool quiet = false;
    bool json = false;
    bool no_figures = false;
    int threads = 0;
};

/// Adds them; `default_out` is where results go without --out.
void add_common_options(CLI::App&, CommonOptions&, const std::string& default_out);

/// Options about reading and measuring a DEM, shared by analyze, fit and compare.
struct DemOptions {
    std::string nodata, crs, band, sea_level, reproject, cell;
    std::vector<std::string> window;  ///< west, south, east, north
    std::string channel_area_m2;
    bool keep_edge_basins = false;
};
void add_dem_options(CLI::App&, DemOptions&);
io::ReadOptions read_options(const DemOptions&);
study::MeasureOptions measure_options(const DemOptions&);

/// The outlet of the one basin to be measured, shared by analyze and fit.
struct OutletOptions {
    std::vector<std::string> at;
    std::string snap_m;
};
void add_outlet_options(CLI::App&, OutletOptions&);
std::optional<study::OutletRequest> outlet_request(const OutletOptions&);

/// An experiment file with what the command line changes in it, shared by simulate and run.
struct ExperimentOptions {
    std::string file;
    std::vector<std::string> set;
    std::string seed;
};
void add_experiment_options(CLI::App&, ExperimentOptions&);
study::Experiment experiment(const ExperimentOptions&);

/// A number the user typed. Throws Error, naming the option, unless it is finite and, where asked, above zero.
enum class Sign { any, positive, not_negative };
double parse_number(const std::string& option, const std::string& text, Sign);

/// A concavity. Throws Error, naming the option, outside of (0, 2]: rivers have 0.1 to 1, and beyond 2 the powers of
/// drainage area tell nothing of heights any more.
double parse_theta(const std::string& option, const std::string& text);

/// A whole number from 0 to 2^53, as `seed` in an experiment file.
std::uint64_t parse_seed(const std::string& option, const std::string& text);

/// Runs `work` with progress and warnings on standard error and a folder to write into, which appears only if it
/// succeeds, and prints what it returns with --json. `left_behind`: see InterruptGuard. `figures` names the drawings to
/// be made ("" for none).
void run_into_folder(const CommonOptions&, const std::string& figures,
                     const std::function<std::string(const std::filesystem::path&, const study::Messages&)>& work,
                     const std::function<std::string()>& left_behind = {});

/// A subcommand that makes one folder of one experiment file.
struct ExperimentCommand {
    const char* name;
    const char* help;
    const char* figures;      ///< as run_into_folder takes them
    const char* default_out;  ///< where results go without --out
};
using ExperimentWork = std::function<std::string(const study::Experiment&, study::Figures, const std::filesystem::path&,
                                                 const study::Messages&)>;
void add_experiment_command(CLI::App&, const ExperimentCommand&, const ExperimentWork&);

/// The same for a command that writes one file: `work` returns its contents.
struct FileOptions {
    std::string out;
    bool force = false;
    bool quiet = false;
    bool json = false;
    int threads = 0;
};
void run_to_file(const FileOptions&, const std::function<std::string(const study::Messages&)>& work,
                 const std::string& summary);

void add_analyze(CLI::App&);
void add_simulate(CLI::App&);
void add_grow(CLI::App&);
void add_fit(CLI::App&);
void add_compare(CLI::App&);
void add_run(CLI::App&);
void add_fetch(CLI::App&);
void add_render(CLI::App&);
void add_version(CLI::App&);

}  // namespace thalweg::tools
