// SPDX-License-Identifier: GPL-3.0-or-later
#include "thalweg/study/compare.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "study/report_json.hpp"
#include "study/results.hpp"
#include "thalweg/core/error.hpp"
#include "thalweg/study/output_folder.hpp"

namespace thalweg::study {
namespace {

namespace fs = std::filesystem;
constexpr double nan = std::numeric_limits<double>::quiet_NaN();

/// What is compared of one terrain, as the summary of `analyze` says it.
struct Side {
    fs::path path;
    std::optional<NamedRaster> raster;  ///< still to be measured
    Json summary;
};

Side load(const fs::path& path, const CompareOptions& options, const Messages& messages) {
    switch (kind_of(path)) {
        case ResultKind::analyzed:
            return {path, std::nullopt, read_json(path / "summary.json")};
        case ResultKind::simulated:
            return {path, read_dem(path / "elevation.tif", {}, {.progress = messages.progress}), nullptr};
        case ResultKind::file:
            break;
    }
    return {path, read_dem(path, options.read, messages), nullptr};
}

double at(const Json& json, const char* pointer) {
    const Json::json_pointer where(pointer);
    return json.contains(where) && json.at(where).is_number() ? json.at(where).get<double>() : nan;
}

/// One threshold for both: the user's, that of a side measured before, or the larger of the two defaults. Throws Error
/// where a side was measured with another one.
double common_threshold(const Side& a, const Side& b, const CompareOptions& options) {
    std::optional<double> common = options.measure.channel_area_m2;
    for (const Side* side : {&a, &b}) {
        if (side->raster) continue;
        const double measured = at(side->summary, "/channels/threshold_area_m2");
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
    const RasterMeasurement m = measure_raster(side.raster->raster, options);
    std::vector<std::string> notes = side.raster->warnings;
    side.summary = terrain_json({}, m.statistics, positions(side.raster->raster), nullptr, notes);
    side.summary["notes"] = notes;
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
    return {{"name", name},     {"quantity", quantity},         {"a", number(a)},
            {"b", number(b)},   {"distance", number(distance)}, {"distance_definition", definition},
            {"scale", nullptr}, {"verdict", "not judged"}};
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

/// What of a side the figures need: its name, and the measures compared.
Json side_json(const Side& side) {
    Json json{{"name", side.path.filename().string()}};
    for (const char* key : {"input", "hypsometry", "channels", "strahler", "horton", "slope_area"}) {
        json[key] = side.summary.at(key);
    }
    return json;
}

std::vector<std::string> notes_of(const Side& a, const Side& b, const Json& aspects) {
    std::vector<std::string> notes{
        "scale: the spread between realisations of a model is not computed, so no difference is judged"};
    for (const Json& aspect : aspects) {
        if (!aspect.at("distance").is_null()) continue;
        notes.push_back(fmt::format("{}: the sides have nothing in common by which to measure a distance",
                                    aspect.at("name").get<std::string>()));
    }
    for (const Side* side : {&a, &b}) {
        for (const Json& note : side->summary.value("notes", Json::array())) {
            notes.push_back(fmt::format("{}: {}", side->path.filename().string(), note.get<std::string>()));
        }
    }
    return notes;
}

}  // namespace

std::string compare(const fs::path& a_path, const fs::path& b_path, const CompareOptions& options,
                    const fs::path& folder, const Messages& messages) {
    Side a = load(a_path, options, messages), b = load(b_path, options, messages);
    const double threshold = common_threshold(a, b, options);
    if (!a.raster && !b.raster) {
        MeasureOptions other = options.measure;
        other.channel_area_m2.reset();
        refuse_dem_options(a_path, options.read, other);
    }
    messages.progress("measuring both sides");
    measure_side(a, options.measure, threshold);
    measure_side(b, options.measure, threshold);
    try {
        const Json aspects{slope_area_aspect(a.summary, b.summary), hypsometry_aspect(a.summary, b.summary),
                           horton_aspect(a.summary, b.summary), relief_aspect(a.summary, b.summary)};
        const Json comparison{{"a", side_json(a)},
                              {"b", side_json(b)},
                              {"channel_threshold_area_m2", threshold},
                              {"aspects", aspects},
                              {"notes", notes_of(a, b, aspects)}};
        std::string text = text_of(comparison);
        write_text(folder / "comparison.json", text);
        return text;
    } catch (const Json::exception&) {
        throw Error(fmt::format("'{}' or '{}' holds a summary.json of another kind than analyze writes",
                                a_path.string(), b_path.string()));
    }
}

}  // namespace thalweg::study
