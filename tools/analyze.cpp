// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include <map>
#include <memory>

#include "command.hpp"
#include "thalweg/core/error.hpp"
#include "thalweg/study/channel_heads.hpp"
#include "thalweg/study/outlet.hpp"

namespace thalweg::tools {
namespace {

const std::map<std::string, study::Conditioning> conditionings{{"fill", study::Conditioning::fill},
                                                               {"carve", study::Conditioning::carve},
                                                               {"none", study::Conditioning::none},
                                                               {"breach", study::Conditioning::breach}};

const std::map<std::string, study::Routing> routings{
    {"d8", study::Routing::d8}, {"dinf", study::Routing::dinf}, {"mfd", study::Routing::mfd}};

const std::map<std::string, study::ChannelRule> channel_rules{{"area", study::ChannelRule::area},
                                                              {"slope-area", study::ChannelRule::slope_area},
                                                              {"drop", study::ChannelRule::drop}};

struct Options {
    CommonOptions common;
    DemOptions dem;
    OutletOptions outlet;
    std::string file, theta, knickpoint_prominence, heads, heads_snap, channels, slope_area;
    std::string breach_depth, breach_length, endorheic_depth, endorheic_area, endorheic_points;
    bool derivatives = false;
    std::string relief_radius;
    std::string conditioning = "fill";
    std::string routing = "d8";
};

/// Where channels begin: one rule, and only the numbers that it takes.
void choose_channels(const Options& options, study::MeasureOptions& measure) {
    const std::string rule = !options.heads.empty() ? "heads" : options.channels.empty() ? "area" : options.channels;
    if (rule == "heads" && !options.channels.empty()) {
        throw Error("--heads and --channels both say where channels begin: give one of them");
    }
    if (rule != "area" && !options.dem.channel_area_m2.empty()) {
        throw Error(fmt::format("--channel-area-m2 is for channels by area, and --{} asks for others: give one of them",
                                rule == "heads" ? rule : "channels " + rule));
    }
    if (rule != "heads" && !options.heads_snap.empty())
        throw Error("--heads-snap-m moves --heads, which are not given");
    if (rule != "slope-area" && !options.slope_area.empty()) {
        throw Error("--slope-area-m2 is for --channels slope-area only");
    }
    measure.channels = rule == "heads" ? study::ChannelRule::heads : channel_rules.at(rule);
    if (!options.slope_area.empty()) {
        measure.slope_area_m2 = parse_number("--slope-area-m2", options.slope_area, Sign::positive);
    }
}

void choose_conditioning(const Options& options, study::MeasureOptions& measure) {
    measure.conditioning = conditionings.at(options.conditioning);
    const auto given = [](const char* name, const std::string& text) -> std::optional<double> {
        if (text.empty()) return std::nullopt;
        return parse_number(name, text, Sign::positive);
    };
    const auto depth = given("--breach-depth-m", options.breach_depth);
    const auto length = given("--breach-length-m", options.breach_length);
    if ((depth || length) && measure.conditioning != study::Conditioning::breach) {
        throw Error("--breach-depth-m and --breach-length-m limit --condition breach, which is not asked for");
    }
    if (depth) measure.breach_limits.depth_m = *depth;
    if (length) measure.breach_limits.length_m = *length;
    measure.endorheic.depth_m = given("--endorheic-depth-m", options.endorheic_depth);
    measure.endorheic.area_m2 = given("--endorheic-area-m2", options.endorheic_area);
}

void choose_derivatives(const Options& options, study::MeasureOptions& measure) {
    if (options.derivatives) measure.derivatives.emplace();
    if (options.relief_radius.empty()) return;
    if (!options.derivatives) throw Error("--relief-radius-m is for --derivatives, which is not asked for");
    measure.derivatives->relief_radius_m = parse_number("--relief-radius-m", options.relief_radius, Sign::positive);
}

void run(const Options& options) {
    study::MeasureOptions measure = measure_options(options.dem);
    choose_channels(options, measure);
    choose_conditioning(options, measure);
    choose_derivatives(options, measure);
    measure.routing = routings.at(options.routing);
    if (!options.theta.empty()) measure.theta = parse_theta("--theta", options.theta);
    if (!options.knickpoint_prominence.empty()) {
        measure.knickpoint_prominence_m =
            parse_number("--knickpoint-prominence-m", options.knickpoint_prominence, Sign::positive);
    }
    const io::ReadOptions read = read_options(options.dem);
    const auto outlet = outlet_request(options.outlet);
    std::optional<double> heads_snap_m;
    if (!options.heads_snap.empty()) {
        heads_snap_m = parse_number("--heads-snap-m", options.heads_snap, Sign::positive);
    }
    run_into_folder(options.common, "analyze", [&](const auto& folder, const study::Messages& m) {
        study::NamedRaster dem = study::read_dem(options.file, read, m);
        if (!options.endorheic_points.empty()) {
            measure.endorheic.cells = study::read_cells(options.endorheic_points, {}, dem.raster, m).cells;
        }
        if (outlet) dem = study::cut_to_outlet(dem, *outlet, measure, m);
        if (!options.heads.empty()) measure.heads = study::read_channel_heads(options.heads, dem.raster, m);
        if (heads_snap_m) measure.heads = study::snapped_heads(dem.raster, *measure.heads, *heads_snap_m, measure);
        return study::analyze(dem, measure, folder, m);
    });
}

}  // namespace

void add_analyze(CLI::App& app) {
    CLI::App* command = app.add_subcommand("analyze", "Measure a DEM: flow, channels, hypsometry, slope-area, Horton");
    auto options = std::make_shared<Options>();
    command->add_option("DEM", options->file, "elevations in any format GDAL reads")->required();
    command
        ->add_option(
            "--condition", options->conditioning,
            "what becomes of pits: fill, carve (cut through at their pass), breach (led out where the least is cut "
            "away) or none (slopes are measured on carved profiles always)")
        ->check(CLI::IsMember({"fill", "carve", "breach", "none"}))
        ->capture_default_str();
    command->add_option("--breach-depth-m", options->breach_depth,
                        "with breach: pits that would need a deeper cut are filled [default: no limit]");
    command->add_option("--breach-length-m", options->breach_length,
                        "with breach: pits that would need a longer cut are filled [default: no limit]");
    command->add_option("--endorheic-depth-m", options->endorheic_depth,
                        "closed depressions at least as deep keep their water [default: none]");
    command->add_option("--endorheic-area-m2", options->endorheic_area,
                        "closed depressions whose water would cover as much keep it [default: none]");
    command->add_option("--endorheic-points", options->endorheic_points,
                        "closed depressions that hold one of these points keep their water");
    command
        ->add_option("--routing", options->routing,
                     "how water is followed for the drainage area: d8, dinf or mfd (the network follows d8 always)")
        ->check(CLI::IsMember({"d8", "dinf", "mfd"}))
        ->capture_default_str();
    command
        ->add_option("--channels", options->channels,
                     "where channels begin: area (--channel-area-m2), slope-area (area times slope squared, "
                     "--slope-area-m2) or drop (the least area from which on stream drops are constant) [default: area]")
        ->check(CLI::IsMember({"area", "slope-area", "drop"}));
    command->add_option("--slope-area-m2", options->slope_area,
                        "area times slope squared where channels begin [default: by constant stream drops]");
    command->add_option("--heads", options->heads,
                        "points where channels begin, in any vector format GDAL reads, instead of a drainage area");
    command->add_option("--heads-snap-m", options->heads_snap,
                        "how far heads may be moved to a river: to the nearest cell with at least half the drainage "
                        "area of any within [default: not at all]");
    command->add_option("--theta", options->theta, "concavity for chi and ksn, at most 2 [default: 0.45]");
    command->add_option("--knickpoint-prominence-m", options->knickpoint_prominence,
                        "height above the steepest concave profile from which a place is a knickpoint [default: 5 % of "
                        "the rivers' relief]");
    command->add_flag("--derivatives", options->derivatives,
                      "also write slope, aspect, curvatures, hillshade, roughness and local relief");
    command->add_option("--relief-radius-m", options->relief_radius,
                        "with --derivatives: radius of local relief [default: ten cells, rounded to 1, 2 or 5]");
    add_outlet_options(*command, options->outlet);
    add_dem_options(*command, options->dem);
    add_common_options(*command, options->common, "analysis");
    command->callback([options] { run(*options); });
}

}  // namespace thalweg::tools
