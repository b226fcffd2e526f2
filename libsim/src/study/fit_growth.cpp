// SPDX-License-Identifier: GPL-3.0-or-later
#include "thalweg/study/fit_growth.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <string_view>

#include "study/report_json.hpp"
#include "study/results.hpp"
#include "thalweg/channel/d8_length.hpp"
#include "thalweg/channel/valleys.hpp"
#include "thalweg/core/error.hpp"
#include "thalweg/io/table_file.hpp"
#include "thalweg/study/channel_heads.hpp"
#include "thalweg/study/output_folder.hpp"
#include "thalweg/study/parameters.hpp"

namespace thalweg::study {
namespace {

namespace fs = std::filesystem;

constexpr double degrees = 180 / std::numbers::pi;

Estimate scaled(const Estimate& e, double factor) {
    return {e.value * factor, e.standard_error * factor, {e.interval95[0] * factor, e.interval95[1] * factor}};
}

Json estimate_json(const Estimate& e) {
    return {{"estimate", number(e.value)}, {"standard_error", number(e.standard_error)}, {"ci95", interval(e)}};
}

Json dials_json(const DialsFit& fit) {
    Json dials;
    for (const FittedDial& dial : fit.table) {
        Json entry = estimate_json(dial.value);
        entry["count"] = dial.count;
        entry["source"] = dial.source;
        entry["identified"] = dial.identified;
        dials[dial.name] = entry;
    }
    return dials;
}

Json draw_json(const channel::UniformDraw& draw) {
    return {{"count", draw.count},
            {"mean", number(draw.mean.value)},
            {"mean_se", number(draw.mean.standard_error)},
            {"delta", number(draw.delta.value)},
            {"delta_se", number(draw.delta.standard_error)}};
}

Json shares_json(const std::array<channel::Share, 3>& shares) {
    Json thirds = Json::array();
    for (const channel::Share& share : shares) {
        thirds.push_back(
            {{"count", share.count}, {"share", number(share.value)}, {"se", number(share.standard_error)}});
    }
    return thirds;
}

Json divide_json(const channel::DivideAngles& divide) {
    Json json = draw_json(divide.share);
    json["angle_mean_deg"] = number(divide.mean_rad * degrees);
    json["angle_sd_deg"] = number(divide.sd_rad * degrees);
    json["between_mean_deg"] = number(divide.sector_mean_rad * degrees);
    return json;
}

Json lengths_json(const channel::LengthStatistics& lengths) {
    return {{"count", lengths.count}, {"mean_m", number(lengths.mean_m)}, {"sd_m", number(lengths.sd_m)}};
}

Json measures_json(const GrowthFit& fit) {
    const channel::GrowthMeasures& m = fit.measures;
    return {{"channel_area_m2", number(fit.channel_area_m2)},
            {"d8_length_factor", channel::d8_length_factor},
            {"junction_place", draw_json(m.junction_places)},
            {"headward_reach", draw_json(m.headward_reach)},
            {"valley_side_deg", draw_json(m.sidewall_angle_deg)},
            {"farthest_ridges_m", number(m.farthest_ridges_m)},
            {"obtuse_side_by_third", shares_json(m.side_choices.obtuse)},
            {"opposite_side_by_third", shares_json(m.side_choices.opposite)},
            {"exterior_links", lengths_json(m.links.exterior)},
            {"interior_links", lengths_json(m.links.interior)},
            {"divide_across", divide_json(m.divides.across)},
            {"divide_below", divide_json(m.divides.below)},
            {"divide_above", divide_json(m.divides.above)},
            {"junction_angle_deg",
             {{"count", m.junctions.count},
              {"mean", number(m.junctions.mean_rad * degrees)},
              {"sd", number(m.junctions.sd_rad * degrees)},
              {"howard", number(m.junctions.predicted_rad * degrees)}}}};
}

Json check_json(const DialsFit& fit) {
    Json list = Json::array();
    for (const MeasureCheck& check : fit.check) {
        list.push_back({{"measure", check.name},
                        {"measured", number(check.measured)},
                        {"grown_mean", number(check.grown_mean)},
                        {"grown_sd", number(check.grown_sd)}});
    }
    return list;
}

/// What other methods tell: growth knows neither time nor rock.
void add_unknown(Json& json, std::vector<std::string>& notes) {
    for (const char* key : {"n", "uplift_m_per_yr", "uplift_sd_m_per_yr", "k", "k_se", "k_ci95", "reference_area_m2",
                            "k_at_reference_area", "k_at_reference_area_se", "m", "m_se", "m_ci95", "area_range_m2",
                            "steady_check", "theta", "theta_se", "ks", "correlation_log_k_m"}) {
        json[key] = nullptr;
    }
    json["k_unit"] = "";
    notes.push_back(
        "k, m, theta, ks and what belongs to them: the method is growth, whose dials know neither time nor rock");
}

std::string fit_json(const GrowthFit& fit, const std::string& measured_on) {
    std::vector<std::string> notes = fit.notes, identifiable;
    notes.insert(notes.end(), fit.dials.notes.begin(), fit.dials.notes.end());
    for (const FittedDial& dial : fit.dials.table) {
        if (dial.identified) identifiable.push_back(dial.name);
    }
    Json json{{"method", "growth"}, {"measured_on", measured_on}};
    add_unknown(json, notes);
    json["reduced_chi2"] = number(fit.dials.reduced_chi2);
    json["degrees_of_freedom"] = number(fit.dials.degrees_of_freedom);
    json["iterations"] = fit.dials.rounds;
    json["converged"] = fit.dials.converged;
    json["message"] = fmt::format(
        "dials found by growing networks in the basin and regressing what they measure; the last of {} rounds moved "
        "the "
        "dial that it moved most by {:.2g} of its standard errors",
        fit.dials.rounds, fit.dials.last_step);
    json["identifiable"] = identifiable;
    json["growth"] = dials_json(fit.dials);
    json["measures"] = measures_json(fit);
    json["check"] = check_json(fit.dials);
    explain_null("measures, check", Json{json["measures"], json["check"]}, "too few rivers or junctions to count",
                 notes);
    json["notes"] = notes;
    return text_of(json);
}

Table check_table(const DialsFit& fit) {
    std::vector<std::string> names;
    std::vector<double> measured, grown, spread;
    for (const MeasureCheck& check : fit.check) {
        names.push_back(check.name);
        measured.push_back(check.measured);
        grown.push_back(check.grown_mean);
        spread.push_back(check.grown_sd);
    }
    return {.name = "fit",
            .columns = {{"measure", names}, {"measured", measured}, {"grown_mean", grown}, {"grown_sd", spread}},
            .kind = GeometryKind::no_geometry,
            .geometry = {}};
}

std::vector<Point> on_the_map(std::vector<Point> places, const GrowthSite& site) {
    for (Point& p : places) p = {p.x / site.unit_m, p.y / site.unit_m};
    return places;
}

void write_basin(const fs::path& file, const GrowthSite& site) {
    Table outline{.name = "outline", .columns = {}, .kind = GeometryKind::polygon, .geometry = {}};
    outline.polygons.push_back({{.outer = on_the_map(site.basin.outline, site), .holes = {}}});
    Table trunk{.name = "trunk", .columns = {}, .kind = GeometryKind::line, .geometry = {}};
    trunk.geometry.push_back(on_the_map(grow::trunk_of(site.basin), site));
    io::write_geopackage(file, {outline, trunk}, site.crs_wkt);
}

/// What is to be measured, and what of its options it brings along.
struct Target {
    fs::path file;
    MeasureOptions measure;
    std::string measured_on;
};

Target target_of(const fs::path& path, const GrowthFitOptions& options) {
    switch (kind_of(path)) {
        case ResultKind::analyzed: {
            refuse_dem_options(path, options.read, options.measure);
            if (options.outlet) throw Error("--outlet applies to DEMs: analyze the DEM anew with it");
            Target target{path / "filled.tif", options.measure, "analyze folder"};
            const Json area = read_json(path / "summary.json")["channels"]["threshold_area_m2"];
            if (options.heads) return target;
            if (!area.is_number()) {
                throw Error(fmt::format(
                    "{}: its channels do not begin at a drainage area; give the points where they do with --heads",
                    path.string()));
            }
            target.measure.channel_area_m2 = area.get<double>();
            return target;
        }
        case ResultKind::simulated:
        case ResultKind::grown:
            return {path / "elevation.tif", options.measure, "raster"};
        case ResultKind::file:
            break;
    }
    return {path, options.measure, "raster"};
}

Catchment catchment_of(NamedRaster& dem, MeasureOptions& measure, const GrowthFitOptions& options,
                       const Messages& messages) {
    if (options.outlet) dem = cut_to_outlet(dem, *options.outlet, measure, messages);
    if (options.heads) {
        measure.channels = ChannelRule::heads;
        measure.heads = read_channel_heads(*options.heads, dem.raster, messages);
    }
    Catchment catchment = measure.catchment_outlet
                              ? Catchment{.raster = dem.raster, .outlet = *measure.catchment_outlet}
                              : largest_complete_catchment(dem.raster, measure);
    // Those in other basins are beside the matter: nothing to warn of.
    if (options.heads) measure.heads = read_channel_heads(*options.heads, catchment.raster, {});
    return catchment;
}

/// A trunk that sees hardly anything of a winding basin leaves growth no room.
void check_grown(const DialsFit& fit) {
    const auto links = std::ranges::find(fit.check, "links", &MeasureCheck::name);
    const double least = links->measured < 3 ? 1 : std::max(2.0, 0.1 * links->measured);  // 1: the bare trunk
    if (links == fit.check.end() || links->grown_mean >= least) return;
    throw Error(
        fmt::format("networks grow in this basin from the trunk to {:.0f} links only, where {:.0f} were measured: "
                    "its outlet sees too little of it; choose a basin farther up with --outlet",
                    links->grown_mean, links->measured));
}

}  // namespace

channel::GrowthMeasures growth_measures(const Raster& raster, const RasterMeasurement& m) {
    const channel::StreamNetwork& network = m.statistics.network;
    const double reach_m = m.statistics.network_laws.junction_reach_m;
    channel::GrowthMeasures measures = channel::growth_measures(
        {.network = network,
         .offset_m = m.terrain.offset_m,
         .reach_m = reach_m,
         .beyond_source_m = channel::beyond_sources(raster.grid, m.terrain.graph, network, reach_m),
         .ridges = channel::ridge_pieces(raster.grid, m.terrain.graph, m.terrain.elevation_m, network),
         .divides = channel::junction_divides(raster.grid, m.terrain.graph, network, reach_m)});
    measures.channel_maintenance_m = scaled(measures.channel_maintenance_m, channel::d8_length_factor);
    return measures;
}

GrowthFit fit_growth(const Catchment& catchment, const MeasureOptions& options, std::uint64_t seed,
                     const GrowthRules& rules) {
    MeasureOptions measuring = options;
    measuring.catchment_outlet = catchment.outlet;
    if (!measuring.channel_area_m2 && !measuring.heads)
        measuring.channel_area_m2 = catchment_channel_area(catchment.raster);
    const RasterMeasurement m = measure_raster(catchment.raster, measuring);
    GrowthFit fit{.site = {},
                  .channel_area_m2 = m.statistics.channels.threshold_area_m2,
                  .measures = growth_measures(catchment.raster, m),
                  .dials = {},
                  .notes = {}};
    std::vector<std::string> told_by_the_fit;
    fit.site = growth_site(catchment, dials_as_measured(fit.measures, rules, told_by_the_fit));
    fit.notes = fit.site.warnings;
    const std::string begin = measuring.heads ? fmt::format("the {} heads given", measuring.heads->cells.size())
                                              : fmt::format("{:.4g} m2 of drainage area", fit.channel_area_m2);
    fit.notes.push_back(fmt::format(
        "channel_maintenance_m: channels are taken to begin at {}, and their length is freed of D8's {:.1f} %", begin,
        100 * (channel::d8_length_factor - 1)));
    fit.dials = fit_dials(fit.site.basin, fit.measures, seed, rules);
    check_grown(fit.dials);
    return fit;
}

Experiment growth_experiment(const GrowthFit& fit, const fs::path& basin) {
    Experiment e;
    e.seed = fit.dials.dials.seed;
    e.basin.outline = basin;
    e.basin.trunk = on_the_map(grow::trunk_of(fit.site.basin), fit.site);  // a drawn river would be simplified again
    e.basin.base_level_m = fit.site.basin.base_level_m;
    e.growth.dials = fit.dials.dials;
    e.growth.channel_maintenance_m = fit.dials.dials.channel_maintenance_m;
    if (std::isfinite(fit.dials.dials.sidewall_reach_m)) e.growth.sidewall_reach_m = fit.dials.dials.sidewall_reach_m;
    return e;
}

std::string write_growth_fit(const GrowthFit& fit, const std::string& measured_on, const fs::path& folder) {
    write_basin(folder / "basin.gpkg", fit.site);
    constexpr std::array<std::string_view, 4> read_by_grow{"", "basin", "growth", "output"};
    write_text(folder / "growth.toml", to_toml(growth_experiment(fit, "basin.gpkg"), read_by_grow));
    io::write_csv(folder / "fit.csv", check_table(fit.dials));
    std::string json = fit_json(fit, measured_on);
    write_text(folder / "fit.json", json);
    return json;
}

std::string fit_growth(const fs::path& path, const GrowthFitOptions& options, const fs::path& folder,
                       const Messages& messages) {
    Target target = target_of(path, options);
    NamedRaster dem = read_dem(target.file, options.read, messages);
    messages.progress("measuring");
    const bool is_grown = kind_of(path) == ResultKind::grown;
    if (is_grown && !options.outlet) target.measure.catchment_outlet = grown_outlet(path, dem.raster);
    const Catchment catchment = catchment_of(dem, target.measure, options, messages);
    messages.progress("growing networks to find the dials");
    GrowthFit fit = fit_growth(catchment, target.measure, options.seed);
    fit.notes.insert(fit.notes.end(), dem.warnings.begin(), dem.warnings.end());
    for (const std::string& warning : fit.site.warnings) messages.warning(warning);
    if (!fit.dials.converged) {
        fit.notes.push_back(
            fmt::format("the dials did not come to rest in {} rounds: the last moved one by {:.2g} standard errors; "
                        "another --seed shows how far they differ",
                        fit.dials.rounds, fit.dials.last_step));
        messages.warning(fit.notes.back());
    }
    return write_growth_fit(fit, target.measured_on, folder);
}

}  // namespace thalweg::study
