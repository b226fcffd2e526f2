// SPDX-License-Identifier: GPL-3.0-or-later
// What is counted and fitted on the links, as JSON.
#include <numbers>

#include "study/report_json.hpp"

namespace thalweg::study {
namespace {

constexpr double degrees_per_radian = 180 / std::numbers::pi;

/// `name`, `name_se` and `name_ci95`.
void add_estimate(Json& json, const std::string& name, const Estimate& e) {
    json[name] = number(e.value);
    json[name + "_se"] = number(e.standard_error);
    json[name + "_ci95"] = interval(e);
}

Json tokunaga_json(const channel::Tokunaga& t) {
    Json rows = Json::array();
    for (const auto& row : t.per_stream) rows.push_back(numbers(row));
    Json json{{"T", rows}, {"T_k", numbers(t.pooled)}};
    add_estimate(json, "a", t.a);
    add_estimate(json, "c", t.c);
    return json;
}

Json power_law_json(const PowerLaw& law, const char* coefficient, const char* exponent) {
    Json json;
    add_estimate(json, coefficient, law.coefficient);
    add_estimate(json, exponent, law.exponent);
    json["r2"] = number(law.r2);
    return json;
}

Json lengths_json(const channel::LengthStatistics& lengths) {
    return {{"count", lengths.count}, {"mean_length_m", number(lengths.mean_m)}, {"sd_length_m", number(lengths.sd_m)}};
}

Json links_json(const channel::LinkLengths& links) {
    return {{"exterior", lengths_json(links.exterior)},
            {"interior", lengths_json(links.interior)},
            {"exterior_interior_ratio", number(links.exterior_interior_ratio)}};
}

Json junctions_json(const channel::JunctionAngles& angles, double reach_m) {
    return {{"count", angles.count},
            {"mean_angle_deg", number(angles.mean_rad * degrees_per_radian)},
            {"sd_angle_deg", number(angles.sd_rad * degrees_per_radian)},
            {"predicted_angle_deg", number(angles.predicted_rad * degrees_per_radian)},
            {"measured_over_m", number(reach_m)}};
}

}  // namespace

Json network_json(const NetworkStatistics& n, std::vector<std::string>& notes) {
    Json json{{"tokunaga", tokunaga_json(n.tokunaga)},
              {"hack", power_law_json(n.hack, "coefficient", "exponent")},
              {"links", links_json(n.links)},
              {"flint", power_law_json(n.flint, "p", "q")},
              {"junctions", junctions_json(n.junctions, n.junction_reach_m)}};
    const auto explain = [&](const char* key, const char* reason) { explain_null(key, json[key], reason, notes); };
    explain("tokunaga", "a and c need side tributaries of two differences of order, their errors of three");
    explain("hack", "the law needs two links, its errors three");
    explain("links", "a mean needs one link of its kind, a standard deviation two");
    explain("flint", "p and q need two classes of magnitude with a fall, their errors three");
    explain("junctions", "an angle needs a junction of exactly two rivers, its spread two, Howard's angle Flint's q");
    return json;
}

}  // namespace thalweg::study
