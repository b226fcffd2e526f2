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

Json power_law_json(const PowerLawFit& law, const char* coefficient, const char* exponent) {
    Json json;
    add_estimate(json, coefficient, law.coefficient);
    add_estimate(json, exponent, law.exponent);
    json["r2"] = number(law.r2);
    return json;
}

Json lengths_json(const channel::LengthStatistics& lengths) {
    return {{"count", lengths.count}, {"mean_length_m", number(lengths.mean_m)}, {"sd_length_m", number(lengths.sd_m)}};
}

Json links_json(const channel::LinkLengths& links, const channel::CisTrans& sides) {
    return {{"exterior", lengths_json(links.exterior)},
            {"interior", lengths_json(links.interior)},
            {"exterior_interior_ratio", number(links.exterior_interior_ratio)},
            {"cis", lengths_json(sides.cis)},
            {"trans", lengths_json(sides.trans)},
            {"cis_share", number(sides.cis_share)}};
}

Json junctions_json(const channel::JunctionAngles& angles, double reach_m) {
    return {{"count", angles.count},
            {"mean_angle_deg", number(angles.mean_rad * degrees_per_radian)},
            {"sd_angle_deg", number(angles.sd_rad * degrees_per_radian)},
            {"predicted_angle_deg", number(angles.predicted_rad * degrees_per_radian)},
            {"measured_over_m", number(reach_m)}};
}

/// As β of P(A ≥ a) ∝ a^(−β).
Json exceedance_json(const PowerLawFit& law) {
    const auto& [exponent, error, ends] = law.exponent;
    Json json;
    add_estimate(json, "exponent", {-exponent, error, {-ends[1], -ends[0]}});
    json["r2"] = number(law.r2);
    return json;
}

}  // namespace

Json network_json(const NetworkStatistics& n, std::vector<std::string>& notes) {
    Json json{{"tokunaga", tokunaga_json(n.tokunaga)},
              {"hack", power_law_json(n.hack, "coefficient", "exponent")},
              {"links", links_json(n.links, n.cis_trans)},
              {"flint", power_law_json(n.flint, "p", "q")},
              {"junctions", junctions_json(n.junctions, n.junction_reach_m)},
              {"area_exceedance", exceedance_json(n.area_exceedance)},
              {"width_function", {{"distance_m", numbers(n.width.distance_m)}, {"links", numbers(n.width.links)}}}};
    const auto explain = [&](const char* key, const char* reason) { explain_null(key, json[key], reason, notes); };
    explain("tokunaga", "a and c need side tributaries of two differences of order, their errors of three");
    explain("hack", "the law needs two links, its errors three");
    explain("links", "a mean needs one link of its kind, a standard deviation two, cis_share one that is cis or trans");
    explain("flint", "p and q need two classes of magnitude with a fall, their errors three");
    explain("junctions", "an angle needs a junction of exactly two rivers, its spread two, Howard's angle Flint's q");
    explain("area_exceedance",
            "the law needs a basin ten times as large as the channel threshold, and two steps of area above it");
    if (n.width.links.empty()) notes.push_back("width_function: there is no river");
    return json;
}

Json chi_json(const ChiStatistics& c, std::vector<std::string>& notes) {
    Json json{{"theta", c.theta}, {"reference_area_m2", c.reference_area_m2}, {"ksn_median", number(c.ksn_median)}};
    add_estimate(json, "theta_best", c.concavity.linearity);
    add_estimate(json, "theta_collinearity", c.concavity.collinearity);
    add_estimate(json, "theta_disorder", c.concavity.disorder);
    explain_null("chi", json,
                 "ksn needs a river that falls by a segment's drop; each theta a river of at least 20 nodes whose best "
                 "value lies within 0 to 1.5 (collinearity and disorder: with tributaries), and its errors at least "
                 "five such rivers or tributaries and an interval within 0 to 1.5 that has the value well inside",
                 notes);
    json["knickpoints"] = c.knickpoints.size();
    json["knickpoint_prominence_m"] = c.knickpoint_prominence_m;
    return json;
}

}  // namespace thalweg::study
