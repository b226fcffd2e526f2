// SPDX-License-Identifier: GPL-3.0-or-later
#include "study/report_json.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "thalweg/core/error.hpp"
#include "thalweg/study/output_folder.hpp"

namespace thalweg::study {
namespace {

Json whole_or_null(Index value) { return value > 0 ? Json(value) : Json(nullptr); }
Json text_or_null(const std::string& text) { return text.empty() ? Json(nullptr) : Json(text); }

Json input_json(const TerrainInput& input, const terrain::Hypsometry& h) {
    Json json{{"file", text_or_null(input.file)},
              {"sha256", text_or_null(input.sha256)},
              {"crs", text_or_null(input.crs)},
              {"geographic", input.geographic},
              {"rows", whole_or_null(input.rows)},
              {"cols", whole_or_null(input.cols)},
              {"dx_m", input.dx_m > 0 ? Json(input.dx_m) : Json(nullptr)},
              {"dy_m", input.dy_m > 0 ? Json(input.dy_m) : Json(nullptr)},
              {"valid_cells", input.valid_cells},
              {"nodata_cells", input.nodata_cells},
              {"area_m2", input.area_m2},
              {"elevation_min_m", number(h.minimum_m)},
              {"elevation_max_m", number(h.maximum_m)},
              {"elevation_mean_m", number(h.mean_m)}};
    if (input.origin) json["provenance"] = origin_json(*input.origin);
    return json;
}

Json hypsometry_json(const terrain::Hypsometry& h) {
    return {{"integral", number(h.integral)},
            {"integral_by_curve", number(h.integral_by_curve)},
            {"skewness", number(h.skewness)},
            {"kurtosis", number(h.kurtosis)},
            {"density_skewness", number(h.density_skewness)},
            {"density_kurtosis", number(h.density_kurtosis)},
            {"relative_area", numbers(h.relative_area)},
            {"relative_height", numbers(h.relative_height)}};
}

const char* rule_name(ChannelRule rule) {
    constexpr std::array names{"area", "heads", "slope-area", "drop"};
    return names[static_cast<std::size_t>(rule)];
}

Json channels_json(const ChannelStatistics& c) {
    return {{"rule", rule_name(c.rule)},
            {"threshold_area_m2", number(c.threshold_area_m2)},
            {"source_area_m2", numbers(c.source_area_m2)},
            {"basin_area_m2", c.basin_area_m2},
            {"edge_basins", edge_basins_name(c.edge_basins)},
            {"share_used", number(c.share_used)},
            {"cells", c.nodes},
            {"sources", c.sources},
            {"links", c.links},
            {"junctions", c.junctions},
            {"outlets", c.outlets},
            {"total_length_m", c.total_length_m},
            {"drainage_density_per_m", number(c.drainage_density_per_m)},
            {"constant_of_channel_maintenance_m", number(1 / c.drainage_density_per_m)},
            {"max_strahler", c.max_strahler},
            {"max_shreve", c.max_shreve}};
}

Json strahler_json(const std::vector<channel::OrderStatistics>& orders) {
    Json list = Json::array();
    for (const auto& o : orders) {
        list.push_back({{"order", o.order},
                        {"streams", o.streams},
                        {"mean_length_m", number(o.mean_length_m)},
                        {"mean_area_m2", number(o.mean_area_m2)},
                        {"mean_slope", number(o.mean_slope)},
                        {"mean_drop_m", number(o.mean_drop_m)}});
    }
    return list;
}

Json ratio_json(const channel::HortonRatio& ratio) {
    return {{"regression", number(ratio.regression)},
            {"mean_ratio", number(ratio.mean_ratio)},
            {"regression_se", number(ratio.regression_se)},
            {"regression_ci95", interval({ratio.regression, ratio.regression_se, ratio.regression_ci95})}};
}

Json horton_json(const channel::HortonRatios& h) {
    return {{"RB", ratio_json(h.bifurcation)},
            {"RL", ratio_json(h.length)},
            {"RA", ratio_json(h.area)},
            {"RS", ratio_json(h.slope)}};
}

Json slope_area_json(const channel::SlopeArea& s) {
    Json bins = Json::array();
    for (const auto& bin : s.bins) {
        bins.push_back(
            {{"area_m2", bin.area_m2}, {"slope", bin.slope}, {"slope_se", number(bin.slope_se)}, {"count", bin.count}});
    }
    return {{"theta", number(s.theta.value)},
            {"theta_se", number(s.theta.standard_error)},
            {"theta_ci95", interval(s.theta)},
            {"ks", number(s.ks.value)},
            {"ks_se", number(s.ks.standard_error)},
            {"r2", number(s.r2)},
            {"bins", bins}};
}

Json nodes_json(const SlopeAreaByNodes& s) {
    Json json = slope_area_json(s.law);
    json["fitted_from_m2"] = number(s.fitted_from_m2);
    json["cells"] = s.looked_at;
    json["cells_left_out"] = s.left_out;
    json["level_share"] = number(s.level_share);
    json["turnover_area_m2"] = number(s.turnover.area_m2);
    json["turnover_range_m2"] = numbers(s.turnover.range_m2);
    return json;
}

Json links_json(const SlopeAreaByLinks& s) {
    Json json = slope_area_json(s.law);
    json["level_share"] = number(s.level_share);
    return json;
}

Json value_json(double value) { return number(value); }
Json value_json(std::int64_t value) { return value; }
Json value_json(const std::string& value) { return value; }

/// The columns of the table of basins, one object per row.
Json basins_json(const Statistics& s, const PositionOf& position) {
    Json list = Json::array();
    for (std::size_t row = 0; row < s.basins.size(); ++row) list.push_back(Json::object());
    for (const Column& column : basin_values(s, position).columns) {
        std::visit(
            [&](const auto& values) {
                for (std::size_t row = 0; row < values.size(); ++row) list[row][column.name] = value_json(values[row]);
            },
            column.values);
    }
    for (std::size_t row = 0; row < s.basins.size(); ++row) list[row]["complete"] = s.basins[row].basin.complete;
    return list;
}

void explain_nulls(const Statistics& s, std::vector<std::string>& notes) {
    if (!std::isfinite(s.hypsometry.integral)) notes.push_back("hypsometry: the terrain has no relief");
    const bool begins_by_area = s.channels.rule == ChannelRule::area || s.channels.rule == ChannelRule::drop;
    if (!begins_by_area) {
        notes.push_back("channels: they do not begin at a drainage area, so there is no threshold_area_m2");
        if (s.basins.empty()) {
            notes.push_back(
                "channels: no complete catchment holds a channel, so there are no network statistics; use "
                "--keep-edge-basins to count cut catchments too");
        }
    } else if (s.basins.empty()) {
        notes.push_back(
            "channels: no catchment of at least the channel threshold lies wholly within the data, so there are no "
            "network statistics; lower --channel-area-m2, or use --keep-edge-basins to count cut catchments too");
    }
    if (!s.basins.empty() && s.channels.max_strahler < 3) {
        notes.push_back(s.channels.max_strahler < 2 ? "horton: the ratios need at least two Strahler orders"
                                                    : "horton: the ratios rest on two Strahler orders only");
    }
    if (s.channels.share_used < 0.5) {
        notes.push_back(fmt::format(
            "channels: only {:.0f} % of the channel cells lie in complete catchments and are used (also in "
            "network.gpkg "
            "and the rasters of orders); the edge of the data and holes in it cut the rest, which --keep-edge-basins "
            "counts too",
            100 * s.channels.share_used));
    }
    if (s.basins.empty()) notes.push_back("horton, strahler: there are no streams");
    if (s.channels.total_length_m == 0) notes.push_back("channels: without links there is no drainage density");
    if (s.slope_area.bins.size() < 3) {
        notes.push_back("slope_area: fewer than three bins of drainage area, so no line was fitted");
    }
    const auto single = std::ranges::count_if(s.slope_area.bins, [](const auto& bin) { return bin.count < 2; });
    if (single > 0) {
        notes.push_back(
            fmt::format("slope_area: {} of {} bins hold one piece of river alone, as is usual at large areas: their "
                        "slope_se is null, and lines weigh them by the scatter of the other bins",
                        single, s.slope_area.bins.size()));
    }
}

/// Anywhere within. (Json's own flatten would make null of an empty list, such as that of hints, too.)
bool holds_null(const Json& json) {
    return json.is_structured() ? std::ranges::any_of(json, holds_null) : json.is_null();
}

}  // namespace

const char* routing_name(Routing routing) {
    constexpr std::array names{"d8", "dinf", "mfd"};
    return names[static_cast<std::size_t>(routing)];
}

const char* edge_basins_name(terrain::EdgeBasins rule) { return rule == terrain::EdgeBasins::keep ? "keep" : "drop"; }

Json numbers(std::span<const double> values) {
    Json list = Json::array();
    for (const double value : values) list.push_back(number(value));
    return list;
}

Json origin_json(const Origin& origin) {
    return {{"title", origin.title},
            {"obtained_from", origin.obtained_from},
            {"vertical", origin.vertical},
            {"licence", origin.licence},
            {"citation", origin.citation}};
}

Json interval(const Estimate& estimate) {
    if (!std::isfinite(estimate.interval95[0]) || !std::isfinite(estimate.interval95[1])) return nullptr;
    return numbers(estimate.interval95);
}

Json conditioning_json(const ConditioningReport& c, Conditioning method) {
    constexpr std::array names{"fill", "carve", "none", "breach"};
    return {{"method", names[static_cast<std::size_t>(method)]},
            {"pits", c.pits},
            {"cells_changed", c.cells_changed},
            {"volume_m3", c.volume_m3},
            {"filled_m3", c.filled_m3},
            {"cut_m3", c.cut_m3},
            {"endorheic_basins", c.endorheic_basins},
            {"flat_cells", c.flat_cells}};
}

Json tree_json(const TreeStatistics& t, std::vector<std::string>& notes) {
    Json channels = channels_json(t.channels);
    for (const char* only_of_terrains :
         {"rule", "threshold_area_m2", "source_area_m2", "edge_basins", "share_used", "cells"}) {
        channels.erase(only_of_terrains);
    }
    Json tree{
        {"channels", std::move(channels)}, {"strahler", strahler_json(t.strahler)}, {"horton", horton_json(t.horton)}};
    std::vector<std::string> of_laws;
    tree.update(network_json(t.laws, of_laws));
    tree.erase("area_exceedance");
    tree["flint_links"] = {{"p", number(t.flint_links.coefficient.value)}, {"q", number(t.flint_links.exponent.value)}};
    for (const std::string& note : of_laws) {
        if (!note.starts_with("area_exceedance")) notes.push_back("tree." + note);
    }
    explain_null("tree.horton", tree["horton"], "the ratios need at least two Strahler orders", notes);
    explain_null("tree.flint_links", tree["flint_links"], "a law needs links of two magnitudes", notes);
    return tree;
}

Json terrain_json(const TerrainInput& input, const Statistics& s, const PositionOf& position, Json conditioning,
                  std::vector<std::string>& notes) {
    explain_nulls(s, notes);
    Json summary{{"input", input_json(input, s.hypsometry)},    {"conditioning", std::move(conditioning)},
                 {"hypsometry", hypsometry_json(s.hypsometry)}, {"channels", channels_json(s.channels)},
                 {"strahler", strahler_json(s.strahler)},       {"horton", horton_json(s.horton)}};
    summary.update(network_json(s.network_laws, notes));
    summary["slope_area"] = slope_area_json(s.slope_area);
    summary["slope_area_cells"] = nodes_json(s.slope_area_nodes);
    explain_null("slope_area_cells", summary["slope_area_cells"],
                 "a line needs three bins of channels; the turnover is seen where slopes first rise and then fall with "
                 "area; a bin of one cell has no standard error",
                 notes);
    summary["slope_area_links"] = links_json(s.slope_area_links);
    explain_null("slope_area_links", summary["slope_area_links"],
                 "a line needs three bins of links that fall; a bin of one link has no standard error", notes);
    summary["chi"] = chi_json(s.chi, notes);
    summary["basins"] = basins_json(s, position);
    if (!s.basins.empty()) {
        explain_null(
            "basins", summary["basins"],
            "nulls belong to basins that are too small for the number: one without relief has no hypsometry; a length, a perimeter and what is made of them need a "
            "basin of more than one cell (on a mesh the raster drawn of it), the asymmetry a trunk with "
            "inflows; theta and ks need three bins of drainage area, their errors four, ksn a river that falls "
            "by a segment's drop",
            notes);
    }
    return summary;
}

void explain_null(const char* key, const Json& json, const char* reason, std::vector<std::string>& notes) {
    if (holds_null(json)) notes.push_back(fmt::format("{}: {}", key, reason));
}

std::string text_of(const Json& json) { return json.dump(2) + "\n"; }

Json read_json(const std::filesystem::path& path) {
    Json json;
    try {
        json = Json::parse(read_text(path));
    } catch (const Json::parse_error&) {
        throw Error(fmt::format("'{}' is not JSON; was it written by thalweg?", path.string()));
    }
    if (!json.is_object()) {
        throw Error(fmt::format("'{}' holds no JSON object; was it written by thalweg?", path.string()));
    }
    return json;
}

}  // namespace thalweg::study
