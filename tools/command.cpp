// SPDX-License-Identifier: GPL-3.0-or-later
#include "command.hpp"

#include <fmt/format.h>

#include <charconv>
#include <cmath>
#include <cstdio>
#include <iostream>

#include "thalweg/core/error.hpp"
#include "thalweg/core/parallel.hpp"
#include "thalweg/study/figure.hpp"
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
}

io::ReadOptions read_options(const DemOptions& options) {
    io::ReadOptions read;
    read.crs = options.crs;
    if (!options.nodata.empty()) read.nodata = parse_number("--nodata", options.nodata, Sign::any);
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

study::Messages messages(const CommonOptions& options) {
    study::Messages m;
    m.warning = [](const std::string& text) { std::cerr << "thalweg: warning: " << text << '\n'; };
    if (!options.quiet) m.progress = [](const std::string& text) { std::cerr << "thalweg: " << text << '\n'; };
    return m;
}

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

void run_into_folder(const CommonOptions& options, const std::string& figures,
                     const std::function<std::string(const std::filesystem::path&, const study::Messages&)>& work) {
    const ThreadLimit limit(options.threads);
    const study::Messages m = messages(options);
    study::OutputFolder folder(options.out,
                               options.force ? study::IfPresent::replace : study::IfPresent::refuse);
    const std::string summary = work(folder.path(), m);
    if (!figures.empty() && !options.no_figures) {
        m.progress("drawing");
        study::draw_figures(figures, folder.path());
    }
    folder.commit();
    if (options.json) std::cout << summary;
    m.progress(fmt::format("results are in {}", options.out));
}

}  // namespace thalweg::tools
