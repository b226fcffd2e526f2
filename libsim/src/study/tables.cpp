// SPDX-License-Identifier: GPL-3.0-or-later
#include "thalweg/study/tables.hpp"

#include <map>

#include "study/columns.hpp"
#include "study/layer_styles.hpp"

namespace thalweg::study {
namespace {

/// What meets at the nodes where links begin or end.
struct Meeting {
    Index inflows = 0;
    Index downstream_link = none;
};

std::map<Index, Meeting> meetings(const channel::StreamNetwork& network) {
    std::map<Index, Meeting> all;
    for (Index link = 0; link < network.size(); ++link) {
        const auto nodes = network.nodes_of(link);
        ++all[nodes.back()].inflows;
        all[nodes.front()].downstream_link = link;
    }
    return all;
}

Doubles link_ksn(const Statistics& s) {
    return channel::link_steepness(s.network, s.chi.profile, s.chi.chi_m, s.chi.theta, s.chi.reference_area_m2);
}

}  // namespace

PositionOf positions(const Raster& raster) {
    return [placement = raster.placement, cols = raster.grid.cols](Index node) {
        return placement.center(node / cols, node % cols);
    };
}

Table link_values(const Statistics& s) {
    const channel::StreamNetwork& network = s.network;
    const channel::MainStreams& main = s.network_laws.main_streams;
    Wholes id, downstream, strahler, shreve, hack;
    Doubles slope;
    for (Index link = 0; link < network.size(); ++link) {
        id.push_back(link);
        downstream.push_back(or_minus_one(network.downstream[link]));
        strahler.push_back(network.strahler[link]);
        shreve.push_back(network.shreve[link]);
        hack.push_back(main.order[main.stream[link]]);
        slope.push_back(network.drop_m[link] / network.length_m[link]);
    }
    return {.name = "links",
            .columns = {{"id", id},
                        {"downstream", downstream},
                        {"strahler", strahler},
                        {"shreve", shreve},
                        {"length_m", network.length_m},
                        {"drop_m", network.drop_m},
                        {"slope", slope},
                        {"area_m2", network.area_m2},
                        {"hack", hack},
                        {"pfafstetter", s.network_laws.pfafstetter},
                        {"ksn", link_ksn(s)}},
            .kind = GeometryKind::no_geometry,
            .geometry = {}};
}

Table links_table(const Statistics& s, const PositionOf& position) {
    const channel::StreamNetwork& network = s.network;
    Table table = link_values(s);
    table.kind = GeometryKind::line;
    table.style = links_style(s.channels.max_strahler);
    for (Index link = 0; link < network.size(); ++link) {
        std::vector<Point>& line = table.geometry.emplace_back();
        for (const Index node : network.nodes_of(link)) line.push_back(position(node));
    }
    return table;
}

Table junctions_table(const Statistics& s, const PositionOf& position) {
    Wholes inflows, downstream, strahler, shreve;
    Texts kind;
    Table table{.name = "junctions", .columns = {}, .kind = GeometryKind::point, .geometry = {}};
    for (const auto& [node, meeting] : meetings(s.network)) {
        const bool mouth = meeting.downstream_link == none;
        kind.push_back(mouth ? "outlet" : meeting.inflows == 0 ? "source" : "junction");
        inflows.push_back(meeting.inflows);
        downstream.push_back(or_minus_one(meeting.downstream_link));
        strahler.push_back(s.strahler_of[node]);
        shreve.push_back(s.shreve_of[node]);
        table.geometry.push_back({position(node)});
    }
    table.style = junctions_style();
    table.columns = {
        {"kind", kind}, {"inflows", inflows}, {"downstream", downstream}, {"strahler", strahler}, {"shreve", shreve}};
    return table;
}

Table knickpoints_table(const Statistics& s, const PositionOf& position) {
    const auto& rows = s.chi.knickpoints;
    const channel::Profile& profile = s.chi.profile;
    Table table{.name = "knickpoints",
                .columns = {{"elevation_m", column_of(rows, [&](const auto& k) { return profile.elevation_m[k.row]; })},
                            {"area_m2", column_of(rows, [&](const auto& k) { return profile.area_m2[k.row]; })},
                            {"chi_m", column_of(rows, [&](const auto& k) { return s.chi.chi_m[k.row]; })},
                            {"prominence_m", column_of(rows, [](const auto& k) { return k.prominence_m; })},
                            {"ksn_above", column_of(rows, [](const auto& k) { return k.ksn_above; })},
                            {"ksn_below", column_of(rows, [](const auto& k) { return k.ksn_below; })}},
                .kind = GeometryKind::point,
                .geometry = {}};
    for (const auto& k : rows) table.geometry.push_back({position(profile.node[k.row])});
    table.style = knickpoints_style();
    return table;
}

std::vector<Table> network_layers(const Statistics& s, const PositionOf& position, std::vector<MultiPolygon> outlines) {
    return {links_table(s, position), junctions_table(s, position), basins_table(s, position, std::move(outlines)),
            knickpoints_table(s, position)};
}

Table hypsometry_table(const terrain::Hypsometry& h) {
    return {.name = "hypsometry",
            .columns = {{"relative_height", h.relative_height}, {"relative_area", h.relative_area}},
            .kind = GeometryKind::no_geometry,
            .geometry = {}};
}

Table slope_area_table(const char* name, const std::vector<channel::SlopeAreaBin>& bins) {
    return {.name = name,
            .columns = {{"area_m2", column_of(bins, [](const auto& bin) { return bin.area_m2; })},
                        {"slope", column_of(bins, [](const auto& bin) { return bin.slope; })},
                        {"slope_se", column_of(bins, [](const auto& bin) { return bin.slope_se; })},
                        {"count", column_of(bins, [](const auto& bin) { return std::int64_t{bin.count}; })}},
            .kind = GeometryKind::no_geometry,
            .geometry = {}};
}

Table chi_table(const Statistics& s, const PositionOf& position) {
    const channel::Profile& profile = s.chi.profile;
    Wholes basin;
    Doubles x, y;
    for (Index i = 0; i < profile.size(); ++i) {
        const Index below = profile.below[i];
        basin.push_back(below == none ? or_minus_one(s.basin_of[profile.node[i]]) : basin[below]);
        const Point at = position(profile.node[i]);
        x.push_back(at.x);
        y.push_back(at.y);
    }
    return {.name = "chi",
            .columns = {{"chi_m", s.chi.chi_m},
                        {"elevation_m", profile.elevation_m},
                        {"area_m2", profile.area_m2},
                        {"basin", basin},
                        {"ksn", s.chi.ksn},
                        {"x", x},
                        {"y", y}},
            .kind = GeometryKind::no_geometry,
            .geometry = {}};
}

Table slope_area_points_table(const std::vector<channel::SlopeAreaPoint>& points) {
    return {.name = "slope_area_points",
            .columns = {{"area_m2", column_of(points, [](const auto& point) { return point.area_m2; })},
                        {"slope", column_of(points, [](const auto& point) { return point.slope; })},
                        {"length_m", column_of(points, [](const auto& point) { return point.weight; })}},
            .kind = GeometryKind::no_geometry,
            .geometry = {}};
}

}  // namespace thalweg::study
