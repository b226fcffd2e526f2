// SPDX-License-Identifier: GPL-3.0-or-later
#include "thalweg/study/fit.hpp"

#include <fmt/format.h>

#include <cmath>

#include "study/report_json.hpp"
#include "study/results.hpp"
#include "thalweg/core/error.hpp"
#include "thalweg/io/table_file.hpp"
#include "thalweg/study/output_folder.hpp"

namespace thalweg::study {
namespace {

namespace fs = std::filesystem;

/// The curve to be fitted, and whether the landscape is known to be steady.
struct Target {
    std::vector<channel::SlopeAreaBin> bins;
    std::string measured_on;
    Json steady_check;
    std::string covers{};                 ///< the ground and the channels behind it, in words
    std::vector<std::string> warnings{};  ///< of reading it
};

/// Fits of one DEM differ by this: `run` takes its largest complete catchment alone, with channels from a share of
/// that.
std::string words_of_cover(double basin_area_m2, double threshold_m2, terrain::EdgeBasins rule) {
    const char* which =
        rule == terrain::EdgeBasins::keep ? "all catchments, those that the edge cuts too" : "the complete catchments";
    const std::string from =
        std::isnan(threshold_m2) ? "" : fmt::format(", channels from {:.4g} km2 on", threshold_m2 / 1e6);
    return fmt::format("{} ({:.4g} km2 in all{})", which, basin_area_m2 / 1e6, from);
}

double number_or_nan(const Json& json) { return json.is_number() ? json.get<double>() : std::nan(""); }

/// The same of an analyze folder; nothing where its summary does not tell.
std::string cover_of(const fs::path& folder) {
    if (!fs::is_regular_file(folder / "summary.json")) return "";
    const Json channels = read_json(folder / "summary.json").value("channels", Json::object());
    const double area = number_or_nan(channels.value("basin_area_m2", Json()));
    if (std::isnan(area)) return "";
    const bool keep = channels.value("edge_basins", Json()) == edge_basins_name(terrain::EdgeBasins::keep);
    return words_of_cover(area, number_or_nan(channels.value("threshold_area_m2", Json())),
                          keep ? terrain::EdgeBasins::keep : terrain::EdgeBasins::drop);
}

/// Nodes of a simulation whose slope the river made, not the talus limit.
Target node_target(const fs::path& folder) {
    const Table table = io::read_csv(folder / "slope_area_nodes.csv");
    const auto& area = numbers_of(table, "area_m2");
    const auto& slope = numbers_of(table, "slope");
    const auto& limited = numbers_of(table, "talus_limited");
    std::vector<channel::SlopeAreaPoint> points;
    for (std::size_t i = 0; i < area.size(); ++i) {
        if (limited[i] == 0) points.push_back({area[i], slope[i]});
    }
    const Json summary = read_json(folder / "summary.json");
    return {.bins = channel::slope_area_bins(points),
            .measured_on = "nodes",
            .steady_check = {{"converged", summary.value("converged", Json())},
                             {"mean_rate_m_per_yr", summary.value("mean_rate_m_per_yr", Json())}},
            .covers = "the simulation's nodes but those at the talus limit"};
}

Target analyzed_target(const fs::path& folder) {
    const Table table = io::read_csv(folder / "slope_area.csv");
    const auto& area = numbers_of(table, "area_m2");
    const auto& slope = numbers_of(table, "slope");
    const auto& slope_se = numbers_of(table, "slope_se");
    const auto& count = numbers_of(table, "count");
    Target target{
        .bins = {}, .measured_on = "analyze folder", .steady_check = Json::object(), .covers = cover_of(folder)};
    for (std::size_t i = 0; i < area.size(); ++i) {
        const bool counted = count[i] >= 1 && count[i] < none && count[i] == std::floor(count[i]);
        if (!counted || (count[i] > 1 && !(slope_se[i] >= 0))) {
            throw Error(
                fmt::format("'{}': line {}: a bin needs a count of at least 1, and a standard error where it "
                            "counts more than one; analyze the DEM anew",
                            (folder / "slope_area.csv").string(), i + 2));
        }
        target.bins.push_back({area[i], slope[i], slope_se[i], static_cast<Index>(count[i])});
    }
    return target;
}

Target raster_target(const fs::path& file, const FitOptions& options, const Messages& messages) {
    NamedRaster dem = read_dem(file, options.read, messages);
    MeasureOptions measure = options.measure;
    if (options.outlet) dem = cut_to_outlet(dem, *options.outlet, measure, messages);
    messages.progress("routing flow and measuring");
    const Statistics s = measure_raster(dem.raster, measure).statistics;
    return {.bins = s.slope_area.bins,
            .measured_on = "raster",
            .steady_check = Json::object(),
            .covers = words_of_cover(s.channels.basin_area_m2, s.channels.threshold_area_m2, s.channels.edge_basins),
            .warnings = dem.warnings};
}

Target grown_target(const fs::path& folder, FitOptions options, const Messages& messages) {
    const fs::path file = folder / "elevation.tif";
    const Raster raster = read_dem(file, options.read, {}).raster;
    if (!options.outlet) options.measure.catchment_outlet = grown_outlet(folder, raster);
    return raster_target(file, options, {.progress = messages.progress});
}

void refuse_outlet(const fs::path& folder, const FitOptions& options) {
    if (!options.outlet) return;
    throw Error(
        fmt::format("'{}' was measured before: --outlet applies to DEMs; give the DEM, or analyze it anew with "
                    "--outlet",
                    folder.string()));
}

Target target_of(const fs::path& path, const FitOptions& options, const Messages& messages) {
    switch (kind_of(path)) {
        case ResultKind::analyzed:
            refuse_outlet(path, options);
            refuse_dem_options(path, options.read, options.measure);
            return analyzed_target(path);
        case ResultKind::simulated:
            if (options.from == FitFrom::nodes) {
                refuse_outlet(path, options);
                refuse_dem_options(path, options.read, options.measure);
                return node_target(path);
            }
            return raster_target(path / "elevation.tif", options, {.progress = messages.progress});
        case ResultKind::grown:
            return grown_target(path, options, messages);
        case ResultKind::file:
            break;
    }
    return raster_target(path, options, messages);
}

Json value_or_null(const std::optional<Estimate>& e) { return e ? number(e->value) : Json(nullptr); }
Json se_or_null(const std::optional<Estimate>& e) { return e ? number(e->standard_error) : Json(nullptr); }

Json fit_json(const infer::SlopeAreaFit& f, const FitOptions& options, const Target& target) {
    Json steady = target.steady_check;
    steady["curvature"] = number(f.curvature.value);
    steady["curvature_se"] = number(f.curvature.standard_error);
    std::vector<std::string> notes = f.notes;
    notes.insert(notes.end(), target.warnings.begin(), target.warnings.end());
    if (!std::isfinite(f.curvature.value)) notes.push_back("steady_check: the curvature needs at least four bins");
    if (f.k && !std::isfinite(f.k->interval95[0])) notes.push_back("k_ci95: too wide to be told in numbers");
    if (f.area_range_m2[1] < 20 * f.area_range_m2[0]) {
        notes.push_back(
            fmt::format("area_range_m2: the areas fitted span a factor of {:.0f} only, so what holds beyond "
                        "them is a guess",
                        f.area_range_m2[1] / f.area_range_m2[0]));
    }
    const auto& u = options.fit.uplift_m_per_yr;
    return {{"method", "slope-area"},
            {"measured_on", target.measured_on},
            {"covers", target.covers},
            {"n", f.n},
            {"uplift_m_per_yr", u ? Json(*u) : Json(nullptr)},
            {"uplift_sd_m_per_yr", options.fit.uplift_sd_m_per_yr},
            {"deposition_g", options.fit.deposition_g},
            {"k", value_or_null(f.k)},
            {"k_unit", f.k_unit},
            {"k_se", se_or_null(f.k)},
            {"k_ci95", f.k ? interval(*f.k) : Json(nullptr)},
            {"k_over_uplift", number(f.k_over_uplift.value)},
            {"k_over_uplift_se", number(f.k_over_uplift.standard_error)},
            {"reference_area_m2", f.reference_area_m2},
            {"k_at_reference_area", number(f.k_at_reference_area.value)},
            {"k_at_reference_area_se", number(f.k_at_reference_area.standard_error)},
            {"k_at_reference_area_ci95", interval(f.k_at_reference_area)},
            {"m", number(f.m.value)},
            {"m_se", number(f.m.standard_error)},
            {"m_ci95", interval(f.m)},
            {"area_range_m2", numbers(f.area_range_m2)},
            {"steady_check", steady},
            {"theta", number(f.theta.value)},
            {"theta_se", number(f.theta.standard_error)},
            {"theta_ci95", interval(f.theta)},
            {"ks", number(f.ks.value)},
            {"ks_se", number(f.ks.standard_error)},
            {"correlation_log_k_m", number(f.correlation_log_k_m)},
            {"reduced_chi2", number(f.reduced_chi2)},
            {"degrees_of_freedom", f.degrees_of_freedom},
            {"iterations", f.iterations},
            {"converged", f.converged},
            {"message", f.message},
            {"identifiable", f.identifiable},
            {"notes", notes}};
}

Table curve_table(const infer::SlopeAreaFit& f) {
    Table table = slope_area_table("slope_area", f.bins);
    table.columns.push_back({"fitted_slope", f.fitted_slope});
    return table;
}

/// What to remember, in a line: k by itself is hardly a number.
std::string fit_line(const infer::SlopeAreaFit& f, const Target& target) {
    const std::string where = target.covers.empty() ? target.measured_on : target.covers;
    if (!f.k) {
        return fmt::format("{}: theta {:.3g}, ks {:.3g} m^{:.3g}; k needs an uplift rate", where, f.theta.value,
                           f.ks.value, 2 * f.theta.value);
    }
    const double area = f.reference_area_m2 / 1e6;
    return fmt::format(
        "{}: m {:.3g}, k*A0^m = {:.3g} m/yr at A0 = {:.3g} km2 (compare k*A^m at one area, not k = {:.3g} {})", where,
        f.m.value, f.k_at_reference_area.value, area, f.k->value, f.k_unit);
}

/// Where all that the interval holds is no river's: a note, or nothing. Of rivers the quartiles of theta are 0.225 and
/// 0.575 (Gailleton et al. 2021).
std::string note_of_odd_theta(const infer::SlopeAreaFit& f) {
    constexpr double least = 0.2, most = 0.8;
    const auto& [low, high] = f.theta.interval95;
    if (!(high < least || low > most)) return "";
    return fmt::format(
        "theta is {:.3g} (95 %: {:.3g} to {:.3g}), and of rivers mostly 0.2 to 0.6: where channels begin, at "
        "{:.3g} m2 here, may still be hillslope; fit rivers alone with --area-min-m2",
        f.theta.value, low, high, f.area_range_m2[0]);
}

}  // namespace

FitOutcome fit(const fs::path& path, const FitOptions& options, const fs::path& folder, const Messages& messages) {
    Target target = target_of(path, options, messages);
    messages.progress("fitting");
    FitOutcome outcome{infer::fit_slope_area(target.bins, options.fit), ""};
    const std::string odd = target.measured_on == "nodes" ? "" : note_of_odd_theta(outcome.fit);
    if (!odd.empty()) {
        messages.warning(odd);
        target.warnings.push_back(odd);
    }
    messages.report(fit_line(outcome.fit, target));
    outcome.json = text_of(fit_json(outcome.fit, options, target));
    io::write_csv(folder / "fit.csv", curve_table(outcome.fit));
    write_text(folder / "fit.json", outcome.json);
    return outcome;
}

}  // namespace thalweg::study
