// SPDX-License-Identifier: GPL-3.0-or-later
#include "thalweg/study/tables.hpp"

#include <cpl_minixml.h>

#include <algorithm>
#include <catch2/catch.hpp>
#include <string>

#include "support/flow_trees.hpp"

using namespace thalweg;
using namespace thalweg::study;

namespace {

using Doubles = std::vector<double>;
using Wholes = std::vector<std::int64_t>;
using Texts = std::vector<std::string>;

template <class Values>
Values column(const Table& table, const std::string& name) {
    for (const Column& c : table.columns) {
        if (c.name == name) return std::get<Values>(c.values);
    }
    throw std::out_of_range(name);
}

Point drawn_position(Index node) { return {100.0 + node, 200.0 - 2.0 * node}; }

/// Links of 5 m between nodes, heights in brackets:
///
///   6 (36) - 5 (33)
///                  \.
///   4 (70) --------- 3 (30) ---- 1 (10) ---- 0 (0) mouth
///                               /
///                     2 (15) --
Statistics drawn_statistics() {
    const terrain::FlowGraph graph = support::graph_of({none, 0, 1, 1, 3, 3, 5}, 5);
    const std::vector<std::uint8_t> channel(7, 1);
    Statistics s{};
    s.strahler_of = channel::strahler_orders(graph, channel);
    s.shreve_of = channel::shreve_magnitudes(graph, channel);
    s.network =
        channel::stream_network(graph, channel, support::upstream_counts(graph), Doubles{0, 10, 15, 30, 70, 33, 36});
    s.network_laws.main_streams = channel::main_streams(s.network);
    s.network_laws.pfafstetter = channel::pfafstetter_codes(s.network);
    s.chi.theta = 0;
    s.chi.reference_area_m2 = 1e6;
    s.chi.profile =
        channel::channel_profile(graph, channel, support::upstream_counts(graph), Doubles{0, 10, 15, 30, 70, 33, 36});
    s.chi.chi_m = channel::chi(s.chi.profile, 0, 1e6);
    s.chi.knickpoints = channel::knickpoints(s.chi.profile, s.chi.chi_m, 0, 1e6, 5);
    return s;
}

}  // namespace

TEST_CASE(
    "The table of knickpoints holds the place where the main stream is convex, with the steepness on both sides") {
    // The main stream 0, 10, 30, 33, 36 at distances 0, 5, 10, 15, 20: 30 stands 12 above the line from 0 to 36.
    const Table points = knickpoints_table(drawn_statistics(), drawn_position);
    CHECK(points.kind == GeometryKind::point);
    CHECK(column<Doubles>(points, "elevation_m") == Doubles{30});
    CHECK(column<Doubles>(points, "prominence_m") == Doubles{12});
    CHECK(column<Doubles>(points, "ksn_below") == Doubles{3});
    CHECK(column<Doubles>(points, "ksn_above") == Doubles{0.6});
    CHECK(column<Doubles>(points, "chi_m") == Doubles{10});
    REQUIRE(points.geometry.size() == 1);
    CHECK(points.geometry[0].front().x == drawn_position(3).x);
}

TEST_CASE("The table of links holds every link with its own numbers") {
    const Table links = links_table(drawn_statistics(), drawn_position);
    CHECK(links.kind == GeometryKind::line);
    // 1-0, 2-1, 3-1, 4-3, 6-5-3
    CHECK(column<Wholes>(links, "id") == Wholes{0, 1, 2, 3, 4});
    CHECK(column<Wholes>(links, "downstream") == Wholes{-1, 0, 0, 2, 2});
    CHECK(column<Wholes>(links, "strahler") == Wholes{2, 1, 2, 1, 1});
    CHECK(column<Wholes>(links, "shreve") == Wholes{3, 1, 2, 1, 1});
    CHECK(column<Doubles>(links, "length_m") == Doubles{5, 5, 5, 5, 10});
    CHECK(column<Doubles>(links, "drop_m") == Doubles{10, 5, 20, 40, 6});
    CHECK(column<Doubles>(links, "slope") == Doubles{2, 1, 4, 8, 0.6});
    CHECK(column<Doubles>(links, "area_m2") == Doubles{7, 1, 4, 1, 2});
    CHECK(column<Wholes>(links, "hack") == Wholes{1, 2, 1, 2, 1});
    CHECK(column<Wholes>(links, "pfafstetter") == Wholes{1, 2, 3, 4, 5});
    CHECK(column<Doubles>(links, "ksn") == Doubles{2, 1, 4, 8, 0.6});
    REQUIRE(links.geometry[4].size() == 3);
    CHECK(links.geometry[4][0].x == 106);
    CHECK(links.geometry[4][1].y == 190);
    CHECK(links.geometry[4][2].x == 103);
}

TEST_CASE("The table of junctions tells sources, junctions and outlets apart") {
    const Table junctions = junctions_table(drawn_statistics(), drawn_position);
    CHECK(junctions.kind == GeometryKind::point);
    // nodes 0, 1, 2, 3, 4, 6; node 5 lies inside a link
    CHECK(column<Texts>(junctions, "kind") == Texts{"outlet", "junction", "source", "junction", "source", "source"});
    CHECK(column<Wholes>(junctions, "inflows") == Wholes{1, 2, 0, 2, 0, 0});
    CHECK(column<Wholes>(junctions, "downstream") == Wholes{-1, 0, 1, 2, 3, 4});
    CHECK(column<Wholes>(junctions, "strahler") == Wholes{2, 2, 1, 2, 1, 1});
    CHECK(column<Wholes>(junctions, "shreve") == Wholes{3, 3, 1, 2, 1, 1});
    REQUIRE(junctions.geometry.size() == 6);
    CHECK(junctions.geometry[5].at(0).x == 106);
    CHECK(junctions.geometry[5].at(0).y == 188);
}

TEST_CASE("A mouth where two rivers meet counts both in its order and its magnitude") {
    const terrain::FlowGraph graph = support::graph_of({none, 0, 0});
    const std::vector<std::uint8_t> channel(3, 1);
    Statistics s{};
    s.strahler_of = channel::strahler_orders(graph, channel);
    s.shreve_of = channel::shreve_magnitudes(graph, channel);
    s.network = channel::stream_network(graph, channel, support::upstream_counts(graph), Doubles{0, 1, 2});
    const Table junctions = junctions_table(s, drawn_position);
    CHECK(column<Texts>(junctions, "kind") == Texts{"outlet", "source", "source"});
    CHECK(column<Wholes>(junctions, "inflows") == Wholes{2, 0, 0});
    CHECK(column<Wholes>(junctions, "strahler") == Wholes{2, 1, 1});
    CHECK(column<Wholes>(junctions, "shreve") == Wholes{2, 1, 1});
}

TEST_CASE("The table of basins holds every basin with its outline and its own numbers") {
    Statistics s{};
    terrain::Hypsometry low{}, high{};
    low.integral = 0.25;
    low.density_kurtosis = 1.7;
    low.relative_height = high.relative_height = {0, 1};
    low.relative_area = {1, 0.1};
    high.integral = 0.75;
    high.density_kurtosis = 1.9;
    high.relative_area = {1, 0.3};
    s.basins = {{.basin = {.outlet = 3, .area_m2 = 900, .complete = true},
                 .relief_m = 40,
                 .hypsometry = low,
                 .length_m = 45,
                 .max_strahler = 4},
                {.basin = {.outlet = 8, .area_m2 = 500, .complete = false},
                 .relief_m = 70,
                 .hypsometry = high,
                 .length_m = 32,
                 .max_strahler = 2}};
    const Polygon first{{0, 0}, {1, 0}, {1, 1}}, second{{5, 5}, {6, 5}, {6, 6}, {5, 6}};
    const Table basins = basins_table(s, drawn_position, {MultiPolygon{{first, {}}}, MultiPolygon{{second, {}}}});
    CHECK(basins.kind == GeometryKind::polygon);
    CHECK(column<Wholes>(basins, "id") == Wholes{0, 1});
    CHECK(column<Doubles>(basins, "outlet_x") == Doubles{103, 108});
    CHECK(column<Doubles>(basins, "outlet_y") == Doubles{194, 184});
    CHECK(column<Doubles>(basins, "area_m2") == Doubles{900, 500});
    CHECK(column<Wholes>(basins, "complete") == Wholes{1, 0});
    CHECK(column<Doubles>(basins, "relief_m") == Doubles{40, 70});
    CHECK(column<Doubles>(basins, "hypsometric_integral") == Doubles{0.25, 0.75});
    CHECK(column<Wholes>(basins, "max_strahler") == Wholes{4, 2});
    CHECK(column<Doubles>(basins, "density_kurtosis") == Doubles{1.7, 1.9});
    CHECK(column<Doubles>(basins, "length_m") == Doubles{45, 32});
    CHECK(basins.polygons.at(1).at(0).outer.size() == 4);
    CHECK(basin_values(s, drawn_position).columns.size() == basins.columns.size());
    const Table curves = basin_hypsometry_table(s);
    CHECK(column<Wholes>(curves, "basin") == Wholes{0, 0, 1, 1});
    CHECK(column<Doubles>(curves, "relative_height") == Doubles{0, 1, 0, 1});
    CHECK(column<Doubles>(curves, "relative_area") == Doubles{1, 0.1, 1, 0.3});
}

TEST_CASE("Points become rows with their coordinates") {
    const Table junctions = with_coordinates(junctions_table(drawn_statistics(), drawn_position));
    CHECK(junctions.kind == GeometryKind::no_geometry);
    CHECK(row_count(junctions) == 6);
    CHECK(column<Doubles>(junctions, "x").at(5) == 106);
    CHECK(column<Doubles>(junctions, "y").at(5) == 188);
}

TEST_CASE("Orders, Horton's ratios, side tributaries and widths each have a tidy table") {
    const Statistics s = drawn_statistics();
    const Table orders = strahler_table(channel::strahler_statistics(s.network));
    CHECK(column<Wholes>(orders, "order") == Wholes{1, 2});
    CHECK(column<Wholes>(orders, "streams") == Wholes{3, 1});
    CHECK(column<Doubles>(orders, "mean_length_m") == Doubles{20.0 / 3, 10});
    const Table horton = horton_table({.bifurcation = {3, 4, 0.5, {2, 5}}, .length = {}, .area = {}, .slope = {}});
    CHECK(column<Texts>(horton, "ratio") == Texts{"RB", "RL", "RA", "RS"});
    CHECK(column<Doubles>(horton, "regression").front() == 3);
    CHECK(column<Doubles>(horton, "mean_ratio").front() == 4);
    CHECK(column<Doubles>(horton, "regression_se").front() == 0.5);
    CHECK(column<Doubles>(horton, "regression_low95").front() == 2);
    CHECK(column<Doubles>(horton, "regression_high95").front() == 5);
    channel::Tokunaga t{};
    t.per_stream = {{1, 3}, {2}};
    t.pooled = {1.5, 3};
    const Table tokunaga = tokunaga_table(t);
    CHECK(column<Wholes>(tokunaga, "order") == Wholes{1, 1, 2});
    CHECK(column<Wholes>(tokunaga, "k") == Wholes{1, 2, 1});
    CHECK(column<Doubles>(tokunaga, "T") == Doubles{1, 3, 2});
    CHECK(column<Doubles>(tokunaga, "T_k") == Doubles{1.5, 3, 1.5});
    const Table width = width_function_table({.distance_m = {5, 15}, .links = {1, 2}});
    CHECK(column<Doubles>(width, "distance_m") == Doubles{5, 15});
    CHECK(column<Doubles>(width, "links") == Doubles{1, 2});
}

TEST_CASE("The curves are written with every number in its own column") {
    const Table bins = slope_area_table("slope_area", {{.area_m2 = 1e4, .slope = 0.1, .slope_se = 0.02, .count = 7}});
    CHECK(column<Doubles>(bins, "area_m2") == Doubles{1e4});
    CHECK(column<Doubles>(bins, "slope") == Doubles{0.1});
    CHECK(column<Doubles>(bins, "slope_se") == Doubles{0.02});
    CHECK(column<Wholes>(bins, "count") == Wholes{7});
    const Table points = slope_area_points_table({{.area_m2 = 1e4, .slope = 0.1, .weight = 30}});
    CHECK(column<Doubles>(points, "area_m2") == Doubles{1e4});
    CHECK(column<Doubles>(points, "slope") == Doubles{0.1});
    CHECK(column<Doubles>(points, "length_m") == Doubles{30});
    terrain::Hypsometry h{};
    h.relative_height = {0, 0.5, 1};
    h.relative_area = {1, 0.2, 0};
    const Table curve = hypsometry_table(h);
    CHECK(column<Doubles>(curve, "relative_height") == Doubles{0, 0.5, 1});
    CHECK(column<Doubles>(curve, "relative_area") == Doubles{1, 0.2, 0});
}

TEST_CASE("Cells of a raster lie at their centres, counted from the north-west") {
    Raster raster;
    raster.grid = plane_grid(3, 4, 10, 20);
    raster.placement.west = 1000;
    raster.placement.north = 5000;
    raster.placement.cell_width = 10;
    raster.placement.cell_height = 20;
    const Point p = positions(raster)(2 * 4 + 1);
    CHECK(p.x == 1015);
    CHECK(p.y == 4950);
}

TEST_CASE("The styles of all layers are XML whose classes each have a symbol") {
    Statistics s = drawn_statistics();
    s.channels.max_strahler = 3;
    for (const Table& layer : network_layers(s, drawn_position, {})) {
        INFO(layer.name);
        CPLXMLNode* const parsed = CPLParseXMLString(layer.style.c_str());
        REQUIRE(parsed != nullptr);
        const CPLXMLNode* renderer = CPLGetXMLNode(parsed, "=qgis.renderer-v2");
        REQUIRE(renderer != nullptr);
        const std::string attribute = CPLGetXMLValue(renderer, "attr", "");
        const CPLXMLNode* symbols = CPLGetXMLNode(renderer, "symbols");
        REQUIRE(symbols != nullptr);
        int count = 0;
        for (const CPLXMLNode* symbol = symbols->psChild; symbol != nullptr; symbol = symbol->psNext) {
            CHECK(std::string(CPLGetXMLValue(symbol, "name", "")) == std::to_string(count++));
            CHECK(CPLGetXMLNode(symbol, "layer.Option") != nullptr);
        }
        if (layer.name == "links") CHECK(count == 3);
        if (layer.name == "junctions") CHECK(count == 3);
        if (attribute.empty()) {
            CHECK(count == 1);
        } else {
            CHECK(std::ranges::any_of(layer.columns, [&](const Column& c) { return c.name == attribute; }));
            const CPLXMLNode* category = CPLGetXMLNode(renderer, "categories")->psChild;
            for (int i = 0; i < count; ++i, category = category->psNext) {
                REQUIRE(category != nullptr);
                CHECK(std::string(CPLGetXMLValue(category, "symbol", "")) == std::to_string(i));
            }
            CHECK(category == nullptr);
        }
        CPLDestroyXMLNode(parsed);
    }
}
