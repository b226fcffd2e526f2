// SPDX-License-Identifier: GPL-3.0-or-later
#include "thalweg/study/growth_dials.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <span>

#include "thalweg/core/error.hpp"
#include "thalweg/core/parallel.hpp"
#include "thalweg/grow/elevations.hpp"
#include "thalweg/grow/valleys.hpp"
#include "thalweg/infer/match.hpp"

namespace thalweg::study {
namespace {

constexpr double nan = std::numeric_limits<double>::quiet_NaN();
constexpr Index check_seeds = 20;
constexpr double smallest_angle_deg = 1, largest_angle_deg = 89;  // that growth takes

/// A dial that is found by growing, and the measure that tells most of it.
struct MatchedDial {
    const char* name;
    double grow::Dials::*dial;
    std::array<double, 2> range;
    const char* source;
    Index count;
    double measured;
};

/// The measures in the order of the dials that they tell of, then link lengths, which hang on several.
std::vector<double> telling_measures(const channel::GrowthMeasures& m) {
    return {m.junction_places.mean.value,     m.junction_places.delta.value,    m.headward_reach.mean.value,
            m.headward_reach.delta.value,     m.sidewall_angle_deg.mean.value,  m.sidewall_angle_deg.delta.value,
            m.side_choices.obtuse[0].value,   m.side_choices.opposite[1].value, std::log(m.links.exterior.mean_m),
            std::log(m.links.interior.mean_m)};
}

std::vector<MatchedDial> matched_dials(const channel::GrowthMeasures& m) {
    using grow::Dials;
    const double angle = std::isnan(m.sidewall_angle_deg.mean.value) ? 25 : m.sidewall_angle_deg.mean.value;
    const double least_angle = std::clamp(angle / 2, smallest_angle_deg + 0.5, 60.0);
    const double most_angle = std::clamp(2.5 * angle, least_angle + 5, largest_angle_deg - 5);
    const auto measured = telling_measures(m);
    return {
        {"mean_junction", &Dials::mean_junction, {0, 1}, "places of junctions", m.junction_places.count, measured[0]},
        {"delta_junction",
         &Dials::delta_junction,
         {0, 0.6},
         "places of junctions",
         m.junction_places.count,
         measured[1]},
        {"mean_length", &Dials::mean_length, {0.05, 1}, "ways to the divide", m.headward_reach.count, measured[2]},
        {"delta_length", &Dials::delta_length, {0, 0.6}, "ways to the divide", m.headward_reach.count, measured[3]},
        {"sidewall_angle_deg",
         &Dials::sidewall_angle_deg,
         {least_angle, most_angle},
         "valley sides",
         m.sidewall_angle_deg.count,
         measured[4]},
        {"delta_sidewall_angle_deg",
         &Dials::delta_sidewall_angle_deg,
         {0, std::clamp(2 * angle, 1.0, 30.0)},
         "valley sides",
         m.sidewall_angle_deg.count,
         measured[5]},
        {"lower_bias",
         &Dials::lower_bias,
         {0, 1},
         "tributaries in the lower thirds",
         m.side_choices.obtuse[0].count,
         measured[6]},
        {"middle_bias",
         &Dials::middle_bias,
         {0, 1},
         "tributaries in the middle thirds",
         m.side_choices.opposite[1].count,
         measured[7]}};
}

/// What growth takes: lengths above 0, angles that stay within their bounds.
grow::Dials allowed(grow::Dials d) {
    d.mean_length = std::clamp(d.mean_length, 0.05, 1.0);
    d.sidewall_angle_deg = std::clamp(d.sidewall_angle_deg, smallest_angle_deg, largest_angle_deg);
    const double room = std::min(d.sidewall_angle_deg - smallest_angle_deg, largest_angle_deg - d.sidewall_angle_deg);
    d.delta_sidewall_angle_deg = std::clamp(d.delta_sidewall_angle_deg, 0.0, room);
    return d;
}

grow::Dials with(grow::Dials d, std::span<const MatchedDial> matched, std::span<const double> values) {
    for (std::size_t i = 0; i < matched.size(); ++i) d.*matched[i].dial = values[i];
    return allowed(d);
}

channel::GrowthMeasures grown_measures(const grow::Basin& basin, grow::Dials dials, std::uint64_t seed) {
    dials.seed = seed;
    const grow::Network network = grow::grow(basin, dials).network;
    return grow::growth_measures(network, grow::elevations(network, dials.flint, basin.base_level_m));
}

/// Fewer where each takes long; never too few for the regression.
Index draws_for(Index links) { return std::clamp<Index>(300000 / std::max<Index>(links, 1), 100, 300); }

/// Flint's law within what growth takes.
grow::Flint flint_of(const PowerLawFit& fit, std::vector<std::string>& notes) {
    const double p = fit.coefficient.value, q = fit.exponent.value;
    if (!(p > 0)) {
        throw Error("the network has no slope to take Flint's law from (flint_p): all of its rivers are level");
    }
    const grow::Flint flint{.p = std::clamp(p, 1e-6, 10.0), .q = std::isnan(q) ? -0.6 : std::clamp(q, -2.0, -0.05)};
    if (std::isnan(q)) {
        notes.push_back("flint_q: too few magnitudes to tell how slopes fall; -0.6 taken (Flint 1974)");
    } else if (flint.q != q) {
        notes.push_back(fmt::format("flint_q: measured {:.3g}, and growth takes -2 to -0.05 only", q));
    }
    return flint;
}

/// A kind of divide, and the dial that draws it.
struct DivideDial {
    const char *name, *delta_name;
    const channel::DivideAngles& measured;
    grow::DrawnShare& dial;
};

std::array<DivideDial, 3> divide_dials(const channel::DividesByPlace& m, grow::Dials& d) {
    return {{{"divide_across", "delta_divide_across", m.across, d.divide_across},
             {"divide_below", "delta_divide_below", m.below, d.divide_below},
             {"divide_above", "delta_divide_above", m.above, d.divide_above}}};
}

/// Divides run as they were measured, for nothing that grows later turns them.
std::vector<FittedDial> take_divides(const channel::DividesByPlace& m, DialsFit& fit) {
    const auto dials = divide_dials(m, fit.dials);
    if (std::ranges::any_of(dials, [](const DivideDial& d) { return d.measured.share.count < 2; })) {
        fit.notes.push_back("divides: too few junctions to tell where they run; the slopes decide");
        return {};
    }
    std::vector<FittedDial> table;
    fit.dials.divides = grow::Divides::shares;
    for (const DivideDial& d : dials) {
        const channel::UniformDraw& share = d.measured.share;
        d.dial = {.mean = std::clamp(share.mean.value, 0.1, 0.9), .delta = std::clamp(share.delta.value, 0.0, 0.8)};
        table.push_back({d.name, share.mean, share.count, "divides at junctions", true});
        table.push_back({d.delta_name, share.delta, share.count, "divides at junctions", true});
    }
    return table;
}

struct NamedMeasure {
    const char* name;
    double value;
};

std::vector<NamedMeasure> checked_measures(const channel::GrowthMeasures& m) {
    return {{"links", static_cast<double>(m.links.exterior.count + m.links.interior.count)},
            {"channel_maintenance_m", m.channel_maintenance_m.value},
            {"exterior_length_m", m.links.exterior.mean_m},
            {"exterior_length_sd_m", m.links.exterior.sd_m},
            {"interior_length_m", m.links.interior.mean_m},
            {"interior_length_sd_m", m.links.interior.sd_m},
            {"junction_place", m.junction_places.mean.value},
            {"junction_place_delta", m.junction_places.delta.value},
            {"headward_reach", m.headward_reach.mean.value},
            {"headward_reach_delta", m.headward_reach.delta.value},
            {"valley_side_deg", m.sidewall_angle_deg.mean.value},
            {"valley_side_delta_deg", m.sidewall_angle_deg.delta.value},
            {"farthest_ridges_m", m.farthest_ridges_m},
            {"lower_obtuse", m.side_choices.obtuse[0].value},
            {"middle_opposite", m.side_choices.opposite[1].value},
            {"upper_obtuse", m.side_choices.obtuse[2].value},
            {"flint_p", m.flint.coefficient.value},
            {"flint_q", m.flint.exponent.value},
            {"divide_across", m.divides.across.share.mean.value},
            {"divide_across_delta", m.divides.across.share.delta.value},
            {"divide_below", m.divides.below.share.mean.value},
            {"divide_below_delta", m.divides.below.share.delta.value},
            {"divide_above", m.divides.above.share.mean.value},
            {"divide_above_delta", m.divides.above.share.delta.value},
            {"junction_angle_deg", m.junctions.mean_rad * 180 / std::numbers::pi}};
}

std::vector<MeasureCheck> check_by_growing(const grow::Basin& basin, const grow::Dials& dials,
                                           const channel::GrowthMeasures& measured, std::uint64_t seed) {
    std::vector<std::vector<NamedMeasure>> grown(check_seeds);
    parallel_for(
        0, check_seeds,
        [&](Index first, Index last) {
            for (Index i = first; i < last; ++i) {
                grown[i] = checked_measures(grown_measures(basin, dials, seed + i));
            }
        },
        1);
    std::vector<MeasureCheck> check;
    for (std::size_t k = 0; const auto& [name, value] : checked_measures(measured)) {
        std::vector<double> values;
        for (const auto& one : grown) {
            if (!std::isnan(one[k].value)) values.push_back(one[k].value);
        }
        check.push_back({name, value, mean(values), standard_deviation(values)});
        ++k;
    }
    return check;
}

/// A range of draws that the mean leaves no room for is cut to what can be drawn.
void cut_to_room(const grow::Dials& dials, FittedDial& delta) {
    const double most = dials.delta_sidewall_angle_deg;
    delta.value.value = most;
    for (double& end : delta.value.interval95) end = std::min(end, most);
}

void take_matched(const infer::Match& found, const std::vector<MatchedDial>& matched, DialsFit& fit) {
    std::vector<double> values;
    for (const Estimate& e : found.parameters) values.push_back(e.value);
    fit.dials = with(fit.dials, matched, values);
    for (std::size_t i = 0; i < matched.size(); ++i) {
        const MatchedDial& dial = matched[i];
        FittedDial fitted{dial.name, found.parameters[i], dial.count, dial.source, found.identified[i] != 0};
        if (fit.dials.*dial.dial < values[i]) {
            cut_to_room(fit.dials, fitted);
            fit.notes.push_back(
                fmt::format("{}: would be wider, but angles are at least {} degree", dial.name, smallest_angle_deg));
        }
        if (!fitted.identified) fit.notes.push_back(fmt::format("{}: the network says little about it", dial.name));
        fit.table.push_back(std::move(fitted));
    }
}

/// The reach as it was measured. Beyond the farthest ridges nothing was seen: where it is as far it has no interval,
/// and where it may be farther the interval ends there.
void take_reach(const channel::GrowthMeasures& m, DialsFit& fit) {
    if (!std::isfinite(fit.dials.sidewall_reach_m)) {
        fit.notes.push_back("sidewall_reach_m: no ridge lies above its channel; valley sides rise however far they go");
        return;
    }
    FittedDial reach{"sidewall_reach_m", m.sidewall_reach_m, m.sidewall_angle_deg.count,
                     "heights of ridges by their distance", m.sidewall_reach_m.value < m.farthest_ridges_m};
    auto& [low, high] = reach.value.interval95;
    if (!reach.identified) {
        low = high = std::numeric_limits<double>::quiet_NaN();
        fit.notes.push_back(
            "sidewall_reach_m: valley sides rise as far as ridges lie; where they end was not seen, so "
            "it is as far as the farthest 1 % and may be farther");
    } else if (high > m.farthest_ridges_m) {
        fit.notes.push_back("sidewall_reach_m: its interval goes on beyond the farthest ridges, where it is cut");
    }
    if (low < 0) low = 0;
    if (high > m.farthest_ridges_m) high = m.farthest_ridges_m;
    fit.table.push_back(std::move(reach));
}

/// The measures that what grows has not, farthest first.
std::string unmet(const DialsFit& fit) {
    constexpr double far = 3;  // standard deviations
    std::vector<std::pair<double, std::string>> measures;
    for (const MeasureCheck& c : fit.check) {
        const double apart = std::abs(c.measured - c.grown_mean) / c.grown_sd;
        if (apart > far && std::abs(c.measured - c.grown_mean) > 0.01 * std::abs(c.measured)) {
            measures.emplace_back(-apart, fmt::format("{} ({:.3g}, grown {:.3g} ± {:.2g})", c.name, c.measured,
                                                      c.grown_mean, c.grown_sd));
        }
    }
    std::ranges::sort(measures);
    std::string list;
    for (const auto& [apart, text] : measures) list += (list.empty() ? "" : ", ") + text;
    return fmt::format(
        "no dials grow networks with all that was measured here: chi2 is {:.2g} times what chance makes, and the "
        "errors are widened by its root{}{}",
        fit.reduced_chi2, list.empty() ? "" : "; farthest off: ", list);
}

}  // namespace

grow::Dials dials_as_measured(const channel::GrowthMeasures& m, const GrowthRules& rules,
                              std::vector<std::string>& notes) {
    if (!(m.channel_maintenance_m.value > 0)) {
        throw Error("the network has no channels to measure: take a smaller channel area");
    }
    grow::Dials dials;
    dials.upstream_link = rules.upstream_link;
    dials.stop = rules.stop;
    dials.channel_maintenance_m = m.channel_maintenance_m.value;
    dials.flint = flint_of(m.flint, notes);
    if (m.sidewall_reach_m.value > 0) dials.sidewall_reach_m = m.sidewall_reach_m.value;
    return dials;
}

DialsFit fit_dials(const grow::Basin& basin, const channel::GrowthMeasures& m, std::uint64_t seed,
                   const GrowthRules& rules) {
    DialsFit fit;
    fit.dials = dials_as_measured(m, rules, fit.notes);
    const auto links = m.links.exterior.count + m.links.interior.count;
    fit.table = {{"channel_maintenance_m", m.channel_maintenance_m, links, "area over channel length", true},
                 {"flint_p", m.flint.coefficient, links, "slopes of links by magnitude", true},
                 {"flint_q", m.flint.exponent, links, "slopes of links by magnitude", true}};
    const std::vector<FittedDial> divides = take_divides(m.divides, fit);
    const auto matched = matched_dials(m);
    infer::MatchOptions options{.ranges = {}, .draws = draws_for(links), .seed = seed};
    for (const MatchedDial& dial : matched) options.ranges.push_back(dial.range);
    const auto model = [&](std::span<const double> values, std::uint64_t number) {
        return telling_measures(grown_measures(basin, with(fit.dials, matched, values), number));
    };
    const infer::Match found = infer::match(model, telling_measures(m), options);
    fit.rounds = found.rounds;
    fit.last_step = found.last_step;
    fit.converged = found.has_settled;
    fit.reduced_chi2 = found.reduced_chi2;
    fit.degrees_of_freedom = found.degrees_of_freedom;
    take_matched(found, matched, fit);
    take_reach(m, fit);
    fit.table.insert(fit.table.end(), divides.begin(), divides.end());
    fit.dials.seed = seed;
    fit.check = check_by_growing(basin, fit.dials, m, seed + 1000000);
    if (fit.reduced_chi2 > 2) fit.notes.push_back(unmet(fit));
    return fit;
}

}  // namespace thalweg::study
