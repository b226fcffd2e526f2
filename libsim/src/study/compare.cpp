// SPDX-License-Identifier: GPL-3.0-or-later
#include "thalweg/study/compare.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>

#include "study/ingest.hpp"
#include "study/realisations.hpp"
#include "study/report_json.hpp"
#include "study/results.hpp"
#include "thalweg/core/error.hpp"
#include "thalweg/core/statistics.hpp"
#include "thalweg/io/table_file.hpp"
#include "thalweg/study/output_folder.hpp"

namespace thalweg::study {
namespace {

namespace fs = std::filesystem;
constexpr double nan = std::numeric_limits<double>::quiet_NaN();

/// What is compared of one terrain, as the summary of `analyze` says it.
struct Side {
    fs::path path;
    std::optional<NamedRaster> raster{};  ///< still to be measured
    bool is_dem = false;                  ///< given as a file, which the options say how to read
    Json summary{};
    std::vector<double> link_length_m{}, link_area_m2{};  ///< empty where a folder does not hold them
    std::optional<Index> outlet{};                        ///< of a raster that is one catchment
    std::optional<double> brought_from_m{};               ///< size of the cells it came on, where others are used
};

Side analyzed_side(const fs::path& folder) {
    Side side{.path = folder, .summary = read_json(folder / "summary.json")};
    if (fs::is_regular_file(folder / "links.csv")) {
        const Table links = io::read_csv(folder / "links.csv");
        side.link_length_m = numbers_of(links, "length_m");
        side.link_area_m2 = numbers_of(links, "area_m2");
    }
    return side;
}

Side grown_side(const fs::path& folder, const Messages& messages) {
    Side side{.path = folder, .raster = read_dem(folder / "elevation.tif", {}, {.progress = messages.progress})};
    side.outlet = grown_outlet(folder, side.raster->raster);
    return side;
}

Side load(const fs::path& path, const CompareOptions& options, const Messages& messages) {
    switch (kind_of(path)) {
        case ResultKind::analyzed:
            return analyzed_side(path);
        case ResultKind::simulated:
            return {.path = path, .raster = read_dem(path / "elevation.tif", {}, {.progress = messages.progress})};
        case ResultKind::grown:
            return grown_side(path, messages);
        case ResultKind::file:
            break;
    }
    return {.path = path, .raster = read_dem(path, options.read, messages), .is_dem = true};
}

double at(const Json& json, const char* pointer) {
    const Json::json_pointer where(pointer);
    return json.contains(where) && json.at(where).is_number() ? json.at(where).get<double>() : nan;
}

/// Side of a square as large as a cell, on the mean, m; NaN where a summary does not tell.
double cell_size(const Side& side) {
    if (!side.raster) return std::sqrt(at(side.summary, "/input/dx_m") * at(side.summary, "/input/dy_m"));
    const Grid& grid = side.raster->raster.grid;
    return std::sqrt(mean(grid.east_west) * mean(grid.north_south));
}

/// Within a few per cent nothing that is compared changes by more than terrain's own scatter.
bool of_one_size(double a_m, double b_m) { return !(std::abs(std::log(a_m / b_m)) > std::log(1.05)); }

/// Slopes, lengths and channels depend on the size of the cells: the finer raster takes that of the coarser one's.
void bring_to_one_size(Side& a, Side& b, const Messages& messages) {
    const double in_a = cell_size(a), in_b = cell_size(b);
    Side& finer = in_a < in_b ? a : b;
    if (of_one_size(in_a, in_b) || !finer.raster) return;
    messages.progress(fmt::format("bringing '{}' to larger cells", finer.path.filename().string()));
    finer.brought_from_m = std::min(in_a, in_b);
    Raster& raster = finer.raster->raster;
    raster = io::on_larger_cells(raster, std::max(in_a, in_b) / std::min(in_a, in_b));
    if (finer.outlet) finer.outlet = grown_outlet(finer.path, raster);
    constexpr Index few = 30;
    if (std::min(raster.grid.rows, raster.grid.cols) >= few) return;
    messages.warning(
        fmt::format("'{}' has {} rows x {} columns left on cells as large as the other side's: too few for "
                    "rivers to be compared; take a finer DEM of the other, or --cells own",
                    finer.path.filename().string(), raster.grid.rows, raster.grid.cols));
}

/// One threshold for both: the user's, that of a side measured before, or the larger of the two defaults. Throws Error
/// where a side was measured with another one.
double common_threshold(const Side& a, const Side& b, const CompareOptions& options) {
    std::optional<double> common = options.measure.channel_area_m2;
    for (const Side* side : {&a, &b}) {
        if (side->raster) continue;
        if (!side->summary.contains(Json::json_pointer("/channels/threshold_area_m2"))) {
            throw Error(
                fmt::format("'{}' holds a summary.json of another kind than analyze writes", side->path.string()));
        }
        const double measured = at(side->summary, "/channels/threshold_area_m2");
        if (std::isnan(measured)) {
            throw Error(
                fmt::format("'{}' was measured with channels that do not begin at a drainage area: both sides "
                            "need one ruler; give the DEMs, or analyze them with --channel-area-m2",
                            side->path.string()));
        }
        if (common && *common != measured) {
            throw Error(
                fmt::format("'{}' was measured with channels from {} m2, not {} m2: both sides need one ruler; "
                            "give the DEMs, or analyze them with the same --channel-area-m2",
                            side->path.string(), measured, *common));
        }
        common = measured;
    }
    if (common) return *common;
    return std::max(default_channel_area(data_area(a.raster->raster)),
                    default_channel_area(data_area(b.raster->raster)));
}

void measure_side(Side& side, MeasureOptions options, double threshold_m2) {
    if (!side.raster) return;
    options.channel_area_m2 = threshold_m2;
    if (side.outlet) options.catchment_outlet = side.outlet;
    const RasterMeasurement m = measure_raster(side.raster->raster, options);
    std::vector<std::string> notes = side.raster->warnings;
    side.summary = terrain_json(input_of(*side.raster, m), m.statistics, positions(side.raster->raster),
                                conditioning_json(m.conditioning, options.conditioning), notes);
    side.summary["routing"] = routing_name(options.routing);
    side.summary["notes"] = notes;
    side.link_length_m = m.statistics.network.length_m;
    side.link_area_m2 = m.statistics.network.area_m2;
}

/// A word or a number of a summary; nothing where it is neither.
std::string shown(const Json& value) {
    if (value.is_string()) return value.get<std::string>();
    return value.is_number() ? fmt::format("{:g}", value.get<double>()) : "";
}

/// Cells along the longer side of b on which they are as large as those of a.
double resolution_like_a(const Side& a, const Side& b) {
    return std::fmax(at(b.summary, "/input/rows"), at(b.summary, "/input/cols")) * cell_size(b) / cell_size(a);
}

/// What to do about cells of two sizes: an analyze folder has the numbers of its own cells and no more. Where a study
/// made both, its experiment says how large those of the model are.
std::string unlike_cells(const Side& a, const Side& b, const CompareOptions& options) {
    const double in_a = cell_size(a), in_b = cell_size(b);
    const Side& finer = in_a < in_b ? a : b;
    const std::string what = fmt::format(
        "cells of {:.4g} m in a, of {:.4g} m in b: slopes, lengths and channels depend on their size", in_a, in_b);
    if (options.cells == CompareCells::own) return what;
    if (options.model_of_b) {
        return fmt::format("{}; ask for output.resolution = {:.0f}, with which those of b are as large", what,
                           std::round(resolution_like_a(a, b)));
    }
    return fmt::format(
        "{}; give the DEM that '{}' was measured on instead of the folder, and it is brought to the larger "
        "cells",
        what, finer.path.string());
}

/// How the two summaries differ in one thing that was asked for, and what comes of it.
struct Ruler {
    const char *pointer, *what, *consequence;
};

constexpr const char* in_distances = "so that distances are not of the terrain alone";
constexpr std::array rulers{
    Ruler{"/routing", "routing", in_distances}, Ruler{"/conditioning/method", "conditioning", in_distances},
    Ruler{"/channels/edge_basins", "basins that the edge cuts", in_distances},
    Ruler{"/channels/rule", "rule that says where channels begin", "at the same drainage area nevertheless"},
    Ruler{"/chi/theta", "theta of chi and ksn", "which no distance looks at: set neither chi nor ksn side by side"}};

/// By what both sides were measured differently, besides the terrain: then part of every distance comes of that.
std::vector<std::string> unlike_rulers(const Side& a, const Side& b, const CompareOptions& options) {
    std::vector<std::string> unlike;
    for (const Ruler& ruler : rulers) {
        const Json::json_pointer where(ruler.pointer);
        if (!a.summary.contains(where) || !b.summary.contains(where)) continue;
        const std::string in_a = shown(a.summary.at(where)), in_b = shown(b.summary.at(where));
        if (in_a == in_b || in_a.empty() || in_b.empty()) continue;
        unlike.push_back(fmt::format("{}: {} in a, {} in b, {}", ruler.what, in_a, in_b, ruler.consequence));
    }
    if (!of_one_size(cell_size(a), cell_size(b))) unlike.push_back(unlike_cells(a, b, options));
    return unlike;
}

/// Where channels begin at a few cells, hillslopes count as rivers on both sides: a note, or nothing.
std::string note_of_few_cells(const Side& a, const Side& b, double threshold_m2) {
    constexpr double enough = 10;
    const double larger_m = std::fmax(cell_size(a), cell_size(b));
    const double cells = threshold_m2 / (larger_m * larger_m);
    if (!(cells < enough)) return "";
    return fmt::format(
        "channels begin at {:.4g} m2, where {:.2g} cells of {:.4g} m come together, so that hillslopes count "
        "as rivers: give a larger --channel-area-m2",
        threshold_m2, std::max(cells, 1.0), larger_m);
}

/// On cells of which size both sides came and were measured.
Json cells_json(const Side& a, const Side& b, const CompareOptions& options) {
    const char* resampled = a.brought_from_m ? "a" : b.brought_from_m ? "b" : "neither";
    return {{"rule", options.cells == CompareCells::own ? "own" : "common"},
            {"resampled", resampled},
            {"a_m", number(cell_size(a))},
            {"b_m", number(cell_size(b))},
            {"a_before_m", number(a.brought_from_m.value_or(cell_size(a)))},
            {"b_before_m", number(b.brought_from_m.value_or(cell_size(b)))}};
}

/// A curve of a summary as two rows of numbers; pairs with a null are left out.
struct Curve {
    std::vector<double> x, y;
};

Curve slope_area_curve(const Json& summary) {
    Curve curve;
    for (const Json& bin : summary.at("slope_area").at("bins")) {
        curve.x.push_back(std::log10(bin.at("area_m2").get<double>()));
        curve.y.push_back(std::log10(bin.at("slope").get<double>()));
    }
    return curve;
}

Curve hypsometric_curve(const Json& summary) {
    Curve curve;
    const Json& h = summary.at("hypsometry");
    for (std::size_t i = 0; i < h.at("relative_height").size(); ++i) {
        const Json &height = h.at("relative_height").at(i), &area = h.at("relative_area").at(i);
        if (!height.is_number() || !area.is_number()) continue;
        curve.x.push_back(height);
        curve.y.push_back(area);
    }
    return curve;
}

double interpolated(const Curve& curve, double x) {
    const auto right = std::upper_bound(curve.x.begin(), curve.x.end(), x);
    if (right == curve.x.begin() || curve.x.empty()) return nan;
    if (right == curve.x.end()) return x == curve.x.back() ? curve.y.back() : nan;
    const auto i = static_cast<std::size_t>(right - curve.x.begin());
    const double share = (x - curve.x[i - 1]) / (curve.x[i] - curve.x[i - 1]);
    return curve.y[i - 1] + share * (curve.y[i] - curve.y[i - 1]);
}

/// Root mean square vertical distance where both curves are known, taken at the abscissae of both, so that exchanging
/// the sides changes nothing.
double rms_distance(const Curve& a, const Curve& b) {
    double squares = 0;
    int count = 0;
    for (const auto& [from, to] : {std::pair{&a, &b}, std::pair{&b, &a}}) {
        for (std::size_t i = 0; i < from->x.size(); ++i) {
            const double difference = interpolated(*to, from->x[i]) - from->y[i];
            if (std::isnan(difference)) continue;
            squares += difference * difference;
            ++count;
        }
    }
    return count > 0 ? std::sqrt(squares / count) : nan;
}

/// Area between two curves over [0, 1] by the trapezoidal rule at a thousand places.
double area_between(const Curve& a, const Curve& b) {
    constexpr int steps = 1000;
    double area = 0;
    for (int i = 0; i <= steps; ++i) {
        const double x = static_cast<double>(i) / steps;
        const double gap = std::abs(interpolated(a, x) - interpolated(b, x));
        area += gap / steps * (i == 0 || i == steps ? 0.5 : 1.0);
    }
    return area;
}

Json aspect(const char* name, const char* quantity, double a, double b, double distance, const char* definition) {
    return {{"name", name},          {"quantity", quantity},         {"a", number(a)},
            {"b", number(b)},        {"distance", number(distance)}, {"distance_definition", definition},
            {"scale", nullptr},      {"scale_q95", nullptr},         {"share_as_far", nullptr},
            {"model_mean", nullptr}, {"model_sd", nullptr},          {"verdict", "not judged"}};
}

Json slope_area_aspect(const Json& a, const Json& b) {
    return aspect(
        "slope_area", "theta", at(a, "/slope_area/theta"), at(b, "/slope_area/theta"),
        rms_distance(slope_area_curve(a), slope_area_curve(b)),
        "root mean square difference of log10 slope between the binned curves over the areas both have (dex)");
}

Json hypsometry_aspect(const Json& a, const Json& b) {
    return aspect("hypsometry", "integral", at(a, "/hypsometry/integral"), at(b, "/hypsometry/integral"),
                  area_between(hypsometric_curve(a), hypsometric_curve(b)),
                  "area between the two hypsometric curves (share of the unit square)");
}

Json relief_aspect(const Json& a, const Json& b) {
    const auto relief = [](const Json& side) {
        return at(side, "/input/elevation_max_m") - at(side, "/input/elevation_min_m");
    };
    return aspect("relief", "relief_m", relief(a), relief(b), std::abs(std::log(relief(a)) - std::log(relief(b))),
                  "|ln(relief of a / relief of b)|, relief being the highest minus the lowest elevation (m)");
}

Json horton_aspect(const Json& a, const Json& b) {
    double squares = 0;
    int count = 0;
    for (const char* ratio :
         {"/horton/RB/regression", "/horton/RL/regression", "/horton/RA/regression", "/horton/RS/regression"}) {
        const double difference = std::log(at(a, ratio)) - std::log(at(b, ratio));
        if (!std::isfinite(difference)) continue;
        squares += difference * difference;
        ++count;
    }
    return aspect("horton", "RB", at(a, "/horton/RB/regression"), at(b, "/horton/RB/regression"),
                  count > 0 ? std::sqrt(squares / count) : nan,
                  "root mean square of ln(ratio of a / ratio of b) over RB, RL, RA, RS by regression");
}

/// The list at a place of a summary, NaN for null; empty where there is none.
std::vector<double> list_at(const Json& json, const char* pointer) {
    const Json::json_pointer where(pointer);
    std::vector<double> values;
    if (!json.contains(where)) return values;
    for (const Json& value : json.at(where)) values.push_back(value.is_number() ? value.get<double>() : nan);
    return values;
}

Json tokunaga_aspect(const Json& a, const Json& b) {
    const auto in_a = list_at(a, "/tokunaga/T_k"), in_b = list_at(b, "/tokunaga/T_k");
    double squares = 0;
    int count = 0;
    for (std::size_t k = 0; k < std::min(in_a.size(), in_b.size()); ++k) {
        const double difference = std::log(in_a[k] / in_b[k]);
        if (!std::isfinite(difference)) continue;
        squares += difference * difference;
        ++count;
    }
    return aspect("tokunaga", "c", at(a, "/tokunaga/c"), at(b, "/tokunaga/c"),
                  count > 0 ? std::sqrt(squares / count) : nan,
                  "root mean square of ln(T_k of a / T_k of b) over the k for which both are above 0");
}

Json link_lengths_aspect(const Side& a, const Side& b) {
    const auto average = [](const std::vector<double>& lengths) { return lengths.empty() ? nan : mean(lengths); };
    return aspect("link_lengths", "mean length of all links (m)", average(a.link_length_m), average(b.link_length_m),
                  kolmogorov_distance(a.link_length_m, b.link_length_m),
                  "largest difference between the shares of links up to any length (Kolmogorov-Smirnov)");
}

Json drainage_area_aspect(const Side& a, const Side& b) {
    return aspect("drainage_area", "area exceedance exponent", at(a.summary, "/area_exceedance/exponent"),
                  at(b.summary, "/area_exceedance/exponent"), kolmogorov_distance(a.link_area_m2, b.link_area_m2),
                  "largest difference between the shares of links up to any drainage area (Kolmogorov-Smirnov)");
}

/// Shares of a river's length in the classes of distance.
std::vector<double> width_shares(const Json& summary) {
    std::vector<double> links = list_at(summary, "/width_function/links");
    double sum = 0;
    for (const double each : links) sum += each;
    for (double& each : links) each /= sum;
    return links;
}

Json width_function_aspect(const Json& a, const Json& b) {
    const auto in_a = width_shares(a), in_b = width_shares(b);
    const auto middle = [](const std::vector<double>& shares) {
        double sum = 0;
        for (std::size_t i = 0; i < shares.size(); ++i) sum += shares[i] * (static_cast<double>(i) + 0.5);
        return shares.empty() ? nan : sum / static_cast<double>(shares.size());
    };
    double difference = in_a.empty() || in_a.size() != in_b.size() ? nan : 0;
    for (std::size_t i = 0; i < std::min(in_a.size(), in_b.size()); ++i) difference += std::abs(in_a[i] - in_b[i]) / 2;
    return aspect("width_function", "mean distance of the channels from the mouth over the greatest", middle(in_a),
                  middle(in_b), difference,
                  "half the area between the width functions over distance relative to the farthest source, each of "
                  "area one");
}

/// An aspect that is one number, and its distance the difference.
Json number_aspect(const char* name, const char* quantity, const char* pointer, const Json& a, const Json& b) {
    return aspect(name, quantity, at(a, pointer), at(b, pointer), std::abs(at(a, pointer) - at(b, pointer)),
                  "absolute difference");
}

Json all_aspects(const Side& a, const Side& b) {
    const Json &in_a = a.summary, &in_b = b.summary;
    return {slope_area_aspect(in_a, in_b),
            hypsometry_aspect(in_a, in_b),
            relief_aspect(in_a, in_b),
            horton_aspect(in_a, in_b),
            tokunaga_aspect(in_a, in_b),
            link_lengths_aspect(a, b),
            drainage_area_aspect(a, b),
            width_function_aspect(in_a, in_b),
            number_aspect("junction_angles", "mean angle (deg)", "/junctions/mean_angle_deg", in_a, in_b),
            number_aspect("flint", "q", "/flint/q", in_a, in_b),
            number_aspect("hack", "exponent", "/hack/exponent", in_a, in_b)};
}

/// A model behind one of the sides, which can be run with other seeds.
struct Model {
    fs::path folder;
    double times = 1;  ///< by which its cells are larger where it is measured
};

std::vector<Model> models_of(const Side& a, const Side& b, const CompareOptions& options) {
    std::vector<Model> models;
    for (const Side* side : {&a, &b}) {
        if (!side->raster || side->is_dem) continue;
        models.push_back({side->path, side->brought_from_m ? cell_size(*side) / *side->brought_from_m : 1});
    }
    if (options.model_of_b) models.push_back({*options.model_of_b});
    if (options.realisations == 1) {
        throw Error("one realisation has no distance from another: ask for at least 2, or better for 20");
    }
    if (models.empty() && options.realisations > 0) {
        throw Error(
            "--realisations runs a model with other seeds, and neither side is the folder of a simulate or grow run");
    }
    return models;
}

/// What the model makes with another seed, measured as the model's own terrain is.
Side measured_realisation(const Model& model, Index number, const MeasureOptions& options, double threshold_m2,
                          const fs::path& scratch) {
    Side side{.path = model.folder, .raster = realisation(model.folder, number, scratch)};
    Raster& raster = side.raster->raster;
    if (model.times > 1) raster = io::on_larger_cells(raster, model.times);
    if (kind_of(model.folder) == ResultKind::grown) side.outlet = grown_outlet(model.folder, raster);
    measure_side(side, options, threshold_m2);
    side.raster.reset();
    return side;
}

/// What the realisations of a model measure in one aspect, and the distances between any two of them; what is not known
/// is left out.
struct AspectSpread {
    std::vector<double> values, distances;
};
using Spread = std::vector<AspectSpread>;

void add_known(const Json& value, std::vector<double>& values) {
    if (value.is_number()) values.push_back(value.get<double>());
}

Spread spread_of(const Model& model, const CompareOptions& options, double threshold_m2, const fs::path& folder,
                 const Messages& messages) {
    std::vector<Side> made;
    Spread spread;
    for (Index i = 1; i <= options.realisations; ++i) {
        messages.progress(
            fmt::format("'{}' with other seeds: {} of {}", model.folder.filename().string(), i, options.realisations));
        made.push_back(measured_realisation(model, i, options.measure, threshold_m2, folder / ".realisation"));
        for (std::size_t j = 0; j < made.size(); ++j) {
            const Json aspects = all_aspects(made[j], made.back());
            spread.resize(aspects.size());
            for (std::size_t k = 0; k < aspects.size(); ++k) {
                if (j + 1 < made.size()) add_known(aspects[k].at("distance"), spread[k].distances);
                if (j + 1 == made.size()) add_known(aspects[k].at("b"), spread[k].values);
            }
        }
    }
    return spread;
}

/// Judges one aspect by the distances between realisations: were the sides two of them, theirs would be one of these.
/// With fewer than 20 of them a rare distance cannot be told from chance, and none is judged.
void judge(Json& aspect, const AspectSpread& model, Index realisations) {
    constexpr double rare = 0.05;
    constexpr Index enough = 20;
    const std::vector<double>& distances = model.distances;
    if (!aspect.at("distance").is_number() || distances.empty()) return;
    const double distance = aspect.at("distance").get<double>();
    const auto as_far = std::ranges::count_if(distances, [&](double each) { return each >= distance; });
    const double share = static_cast<double>(as_far) / static_cast<double>(distances.size());
    aspect["scale"] = quantile(distances, 0.5);
    aspect["scale_q95"] = quantile(distances, 1 - rare);
    aspect["share_as_far"] = share;
    aspect["model_mean"] = number(mean(model.values));
    aspect["model_sd"] = number(standard_deviation(model.values));
    if (realisations < enough) return;
    aspect["verdict"] = share < rare ? "beyond the model's own scatter" : "within the model's own scatter";
}

void judge_all(Json& aspects, const std::vector<Spread>& spreads, Index realisations) {
    for (std::size_t k = 0; k < aspects.size(); ++k) {
        AspectSpread widest;
        for (const Spread& spread : spreads) {
            if (spread.empty() || spread[k].distances.empty()) continue;
            const bool is_wider =
                widest.distances.empty() || quantile(spread[k].distances, 0.5) > quantile(widest.distances, 0.5);
            if (is_wider) widest = spread[k];
        }
        judge(aspects[k], widest, realisations);
    }
}

/// On what the verdicts rest.
std::string note_of_scale(const std::vector<Model>& models, Index realisations) {
    if (realisations == 0 || models.empty()) {
        return "scale: the spread between realisations of a model (with scale_q95 and share_as_far) is not computed, "
               "so no "
               "difference is judged; --realisations 20 does where a side is the folder of a simulate or grow run";
    }
    std::string names;
    for (const Model& model : models) names += (names.empty() ? "'" : ", '") + model.folder.filename().string() + "'";
    return fmt::format(
        "realisations: {} of {} with the seeds that follow; scale is the median distance between two of them; null "
        "where they have nothing in common by which to measure it",
        realisations, names);
}

/// What of a side the figures need: its name, and the measures compared.
Json side_json(const Side& side) {
    Json json{{"name", side.path.filename().string()}};
    for (const char* key : {"input", "hypsometry", "channels", "strahler", "horton", "slope_area"}) {
        json[key] = side.summary.at(key);
    }
    for (const char* key : {"tokunaga", "hack", "links", "flint", "junctions", "area_exceedance", "width_function"}) {
        json[key] = side.summary.value(key, Json());
    }
    return json;
}

std::vector<std::string> notes_of(const Side& a, const Side& b, const Json& aspects) {
    std::vector<std::string> notes;
    for (const Side* side : {&a, &b}) {
        if (!side->brought_from_m) continue;
        notes.push_back(fmt::format("cells: '{}' was brought from cells of {:.4g} m to the other side's, of {:.4g} m",
                                    side->path.filename().string(), *side->brought_from_m, cell_size(*side)));
    }
    for (const Json& aspect : aspects) {
        if (!aspect.at("distance").is_null()) continue;
        notes.push_back(fmt::format("{}: the sides have nothing in common by which to measure a distance",
                                    aspect.at("name").get<std::string>()));
    }
    for (const Side* side : {&a, &b}) {
        if (side->link_length_m.empty()) {
            notes.push_back(fmt::format("link_lengths, drainage_area: '{}' holds no links, or no links.csv",
                                        side->path.filename().string()));
        }
        for (const Json& note : side->summary.value("notes", Json::array())) {
            notes.push_back(fmt::format("{}: {}", side->path.filename().string(), note.get<std::string>()));
        }
    }
    return notes;
}

/// Throws Error for options that no side would heed.
void refuse_idle_options(const Side& a, const Side& b, const CompareOptions& options) {
    if (a.is_dem || b.is_dem) return;
    MeasureOptions other = options.measure;
    other.channel_area_m2.reset();
    if (a.raster || b.raster) other.edge_basins = terrain::EdgeBasins::drop;  // a raster is measured now
    refuse_dem_options(a.path, options.read, other);
}

}  // namespace

std::string compare(const fs::path& a_path, const fs::path& b_path, const CompareOptions& options,
                    const fs::path& folder, const Messages& messages) {
    Side a = load(a_path, options, messages), b = load(b_path, options, messages);
    const double threshold = common_threshold(a, b, options);
    refuse_idle_options(a, b, options);
    if (options.cells == CompareCells::common) bring_to_one_size(a, b, messages);
    const std::vector<Model> models = models_of(a, b, options);
    messages.progress("measuring both sides");
    measure_side(a, options.measure, threshold);
    measure_side(b, options.measure, threshold);
    try {
        Json aspects = all_aspects(a, b);
        std::vector<Spread> spreads;
        if (options.realisations > 0) {
            for (const Model& model : models) {
                spreads.push_back(spread_of(model, options, threshold, folder, messages));
            }
        }
        judge_all(aspects, spreads, options.realisations);
        std::vector<std::string> notes = unlike_rulers(a, b, options);
        const std::string few_cells = note_of_few_cells(a, b, threshold);
        if (!few_cells.empty()) notes.push_back(few_cells);
        for (const std::string& note : notes) messages.warning(note);
        notes.push_back(note_of_scale(models, options.realisations));
        const auto of_sides = notes_of(a, b, aspects);
        notes.insert(notes.end(), of_sides.begin(), of_sides.end());
        const Json comparison{{"a", side_json(a)},
                              {"b", side_json(b)},
                              {"channel_threshold_area_m2", threshold},
                              {"cells", cells_json(a, b, options)},
                              {"realisations", options.realisations},
                              {"aspects", aspects},
                              {"notes", notes}};
        std::string text = text_of(comparison);
        write_text(folder / "comparison.json", text);
        return text;
    } catch (const Json::exception&) {
        throw Error(fmt::format("'{}' or '{}' holds a summary.json of another kind than analyze writes",
                                a_path.string(), b_path.string()));
    }
}

}  // namespace thalweg::study
