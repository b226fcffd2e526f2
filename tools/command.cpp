// SPDX-License-Identifier: GPL-3.0-or-later
#include "command.hpp"

#include "interrupt.hpp"
#include "phase_lines.hpp"

#include <fmt/format.h>

#include <unistd.h>

#include <charconv>
#include <cmath>
#include <iostream>
#include <memory>
#include <optional>

#include "thalweg/core/error.hpp"
#include "thalweg/core/parallel.hpp"
#include "thalweg/study/figure.hpp"
#include "thalweg/study/output_file.hpp"
#include "thalweg/study/output_folder.hpp"

namespace thalweg::tools {

void add_common_options(CLI::App& app, CommonOptions& options, const std::string& default_out) {
    options.out = default_out;
    app.add_option("--out", options.out, "folder for the results; it appears whole or not at all")
        ->capture_default_str();
    app.add_flag("--force", options.force, "replace an existing folder of results");
    app.add_option("--threads", options.threads, "threads to use, 0 for all; results do not depend on it")
        ->check(CLI::Range(0, 4096))
        ->capture_default_str();
    app.add_flag("--quiet", options.quiet, "no progress on standard error");
    app.add_flag("--json", options.json, "print the summary on standard output, and nothing else there");
    app.add_flag("--no-figures", options.no_figures, "draw nothing");
}

void add_dem_options(CLI::App& app, DemOptions& options) {
    app.add_option("--channel-area-m2", options.channel_area_m2,
                   "drainage area where channels begin [default: 0.1 % of the area, rounded to 1-2-5]");
    app.add_flag("--keep-edge-basins", options.keep_edge_basins,
                 "count catchments that the edge of the data cuts, too");
    app.add_option("--crs", options.crs, "coordinate system to use instead of the file's, e.g. EPSG:32611");
    app.add_option("--nodata", options.nodata, "value to be taken as no data, besides what the file declares");
    app.add_option("--band", options.band, "band of the file that holds the heights [default: 1]");
    app.add_option("--crop", options.window, "use only this window of the file, in its coordinates")
        ->expected(4)
        ->type_name("W S E N");
    app.add_option("--sea-level", options.sea_level, "cells at or below this height (m) are no data");
    app.add_option("--reproject", options.reproject, "warp to this coordinate system first, e.g. EPSG:32611");
    app.add_option("--cell-m", options.cell, "warp to square cells of this size first");
}

namespace {

int parse_band(const std::string& text) {
    const double band = parse_number("--band", text, Sign::positive);
    if (band != std::floor(band) || band > 65535) throw Error("--band is a number from 1 on, not " + text);
    return static_cast<int>(band);
}

io::Window parse_window(const std::vector<std::string>& text) {
    const auto edge = [&](std::size_t i) { return parse_number("--crop", text[i], Sign::any); };
    const io::Window window{edge(0), edge(1), edge(2), edge(3)};
    if (window.west < window.east && window.south < window.north) return window;
    throw Error(
        "--crop takes west, south, east and north in this order, so that the third is larger than the first "
        "and the fourth than the second");
}

}  // namespace

io::ReadOptions read_options(const DemOptions& options) {
    io::ReadOptions read;
    read.crs = options.crs;
    if (!options.nodata.empty()) read.nodata = parse_number("--nodata", options.nodata, Sign::any);
    if (!options.band.empty()) read.band = parse_band(options.band);
    if (!options.window.empty()) read.window = parse_window(options.window);
    if (!options.sea_level.empty()) read.sea_level_m = parse_number("--sea-level", options.sea_level, Sign::any);
    read.reproject = options.reproject;
    if (!options.cell.empty()) read.cell_m = parse_number("--cell-m", options.cell, Sign::positive);
    return read;
}

study::MeasureOptions measure_options(const DemOptions& options) {
    study::MeasureOptions measure;
    if (!options.channel_area_m2.empty()) {
        measure.channel_area_m2 = parse_number("--channel-area-m2", options.channel_area_m2, Sign::positive);
    }
    if (options.keep_edge_basins) measure.edge_basins = terrain::EdgeBasins::keep;
    return measure;
}

void add_outlet_options(CLI::App& app, OutletOptions& options) {
    app.add_option("--outlet", options.at,
                   "measure only the basin above this place: X Y in the DEM's coordinates, moved to the river near it")
        ->expected(2)
        ->type_name("X Y");
    app.add_option("--snap-m", options.snap_m, "how far the outlet may be moved, 0 for not at all [default: 5 cells]");
}

std::optional<study::OutletRequest> outlet_request(const OutletOptions& options) {
    if (options.at.empty()) {
        if (!options.snap_m.empty()) throw Error("--snap-m moves the place of --outlet, which is not given");
        return std::nullopt;
    }
    study::OutletRequest request{
        {parse_number("--outlet", options.at[0], Sign::any), parse_number("--outlet", options.at[1], Sign::any)}};
    if (!options.snap_m.empty()) request.snap_m = parse_number("--snap-m", options.snap_m, Sign::not_negative);
    return request;
}

void add_experiment_options(CLI::App& app, ExperimentOptions& options) {
    app.add_option("EXPERIMENT", options.file, "experiment file (TOML)")->required();
    app.add_option("--set", options.set, "another value for a key, e.g. --set river.n=1.5 (may be repeated)")
        ->allow_extra_args(false);
    app.add_option("--seed", options.seed, "another seed");
    app.footer("Keys of the experiment file:\n" + study::experiment_reference());
}

study::Experiment experiment(const ExperimentOptions& options) {
    std::vector<std::string> overrides = options.set;
    if (!options.seed.empty()) overrides.push_back("seed=" + options.seed);
    return study::read_experiment(options.file, overrides);
}

namespace {

/// One status line that rewrites itself on a terminal (elsewhere a line per phase of work that lasts), and reports and
/// warnings kept back until the work is done: a command that fails says of them exactly one line, the error.
class Console {
  public:
    explicit Console(bool quiet) : quiet_(quiet), shows_status_(!quiet && ::isatty(STDERR_FILENO) == 1) {
        if (!quiet_ && !shows_status_) phases_.emplace();
    }
    ~Console() { clear(); }

    study::Messages messages() {
        return {.progress = [this](const std::string& text) { status(text); },
                .warning = [this](const std::string& text) { warnings_.push_back(text); },
                .report = [this](const std::string& text) { reports_.push_back(text); }};
    }

    void finish() {
        clear();
        phases_.reset();
        for (const std::string& text : reports_) {
            if (!quiet_) std::cerr << "thalweg: " << text << '\n';
        }
        for (const std::string& text : warnings_) std::cerr << "thalweg: warning: " << text << '\n';
    }

  private:
    static constexpr const char* start_of_line = "\r\033[K";

    void status(const std::string& text) {
        if (phases_) phases_->status(text);
        if (shows_status_) std::cerr << start_of_line << "thalweg: " << text << std::flush;
    }
    void clear() const {
        if (shows_status_) std::cerr << start_of_line << std::flush;
    }

    bool quiet_;
    bool shows_status_;
    std::optional<PhaseLines> phases_;
    std::vector<std::string> reports_, warnings_;
};

}  // namespace

double parse_number(const std::string& option, const std::string& text, Sign sign) {
    double value = 0;
    const auto [end, problem] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (problem != std::errc() || end != text.data() + text.size() || !std::isfinite(value)) {
        throw Error(fmt::format("{} needs a finite number, not '{}'", option, text));
    }
    if (sign == Sign::positive && !(value > 0)) throw Error(fmt::format("{} must be above 0, not {}", option, text));
    if (sign == Sign::not_negative && value < 0) {
        throw Error(fmt::format("{} must be at least 0, not {}", option, text));
    }
    return value;
}

double parse_theta(const std::string& option, const std::string& text) {
    constexpr double largest = 2;
    const double theta = parse_number(option, text, Sign::positive);
    if (theta <= largest) return theta;
    throw Error(
        fmt::format("{} must be at most {}, not {}: rivers have a concavity of about 0.45", option, largest, text));
}

std::uint64_t parse_seed(const std::string& option, const std::string& text) {
    constexpr double largest = 9007199254740992;
    const double value = parse_number(option, text, Sign::not_negative);
    if (value != std::floor(value)) throw Error(fmt::format("{} must be a whole number, not {}", option, text));
    if (value > largest) throw Error(fmt::format("{} must be at most 2^53, not {}", option, text));
    return static_cast<std::uint64_t>(value);
}

void run_into_folder(const CommonOptions& options, const std::string& figures,
                     const std::function<std::string(const std::filesystem::path&, const study::Messages&)>& work,
                     const std::function<std::string()>& left_behind) {
    const ThreadLimit limit(options.threads);
    Console console(options.quiet);
    const study::Messages m = console.messages();
    study::OutputFolder folder(options.out, options.force ? study::IfPresent::replace : study::IfPresent::refuse);
    for (const std::string& left : study::remove_abandoned(options.out)) {
        m.report("removed " + left + ", which a run that was killed had left");
    }
    std::string summary;
    {
        const InterruptGuard guard([&folder] { folder.discard(); }, left_behind);
        summary = work(folder.path(), m);
        if (!figures.empty() && !options.no_figures) {
            m.progress("drawing");
            study::draw_figures(figures, folder.path());
        }
    }
    folder.commit();
    console.finish();
    if (options.json && !(std::cout << summary << std::flush)) {
        throw Error("the summary cannot be written to standard output; the results are in " + options.out);
    }
    if (!options.json && !options.quiet) std::cerr << "thalweg: results are in " << options.out << '\n';
}

void add_experiment_command(CLI::App& app, const ExperimentCommand& command, const ExperimentWork& work) {
    struct Options {
        CommonOptions common;
        ExperimentOptions experiment;
    };
    auto options = std::make_shared<Options>();
    CLI::App* added = app.add_subcommand(command.name, command.help);
    add_experiment_options(*added, options->experiment);
    add_common_options(*added, options->common, command.default_out);
    added->callback([options, work, figures = std::string(command.figures)] {
        const study::Experiment e = experiment(options->experiment);
        const auto draws = options->common.no_figures ? study::Figures::leave_out : study::Figures::draw;
        run_into_folder(options->common, figures, [&](const auto& folder, const study::Messages& messages) {
            return work(e, draws, folder, messages);
        });
    });
}

void run_to_file(const FileOptions& options, const std::function<std::string(const study::Messages&)>& work,
                 const std::string& summary) {
    const ThreadLimit limit(options.threads);
    Console console(options.quiet);
    study::OutputFile file(options.out, options.force ? study::IfPresent::replace : study::IfPresent::refuse);
    {
        const InterruptGuard guard([&file] { file.discard(); });
        file.write(work(console.messages()));
    }
    console.finish();
    if (options.json && !(std::cout << summary << std::flush)) {
        throw Error("the summary cannot be written to standard output; the result is in " + options.out);
    }
    if (!options.json && !options.quiet) std::cerr << "thalweg: the result is in " << options.out << '\n';
}

}  // namespace thalweg::tools
