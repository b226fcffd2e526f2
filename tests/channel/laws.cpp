// SPDX-License-Identifier: GPL-3.0-or-later
#include "thalweg/channel/laws.hpp"

#include <catch2/catch.hpp>
#include <cmath>
#include <numbers>
#include <numeric>
#include <ranges>

#include "support/flow_trees.hpp"
#include "support/terrains.hpp"
#include "thalweg/terrain/lakes.hpp"
#include "thalweg/terrain/route.hpp"

using namespace thalweg;
using namespace thalweg::channel;
using support::graph_of;
using support::network_of;

namespace {

/// Links alone, with slopes by a law of magnitude and lengths drawn at random.
StreamNetwork with_slopes(StreamNetwork network, double p, double q, Random& random) {
    for (Index link = 0; link < network.size(); ++link) {
        network.length_m[link] = 100 * (1 + random.uniform());
        network.drop_m[link] = network.length_m[link] * p * std::pow(2.0 * network.shreve[link] - 1, q);
    }
    return network;
}

}  // namespace

TEST_CASE("The longest way up from a node is the one a walk over all its sources finds") {
    for (std::uint32_t trial = 0; trial < 20; ++trial) {
        Random random(21, trial);
        terrain::FlowGraph graph = support::random_tree(60, random);
        std::vector<double> lengths = graph.length.list();
        for (double& length : lengths) length = length > 0 ? 1 + random.uniform() : 0;
        graph.length = std::move(lengths);
        std::vector<double> brute(graph.size(), 0);
        for (Index start = 0; start < graph.size(); ++start) {
            double walked = 0;
            for (Index node = start; node != none; node = graph.receiver[node]) {
                brute[node] = std::max(brute[node], walked);
                walked += graph.length[node];
            }
        }
        const auto longest = longest_upstream_lengths(graph);
        const auto network = network_of(graph);
        const auto on_links = longest_upstream_lengths(network);
        for (Index node = 0; node < graph.size(); ++node) CHECK(longest[node] == Approx(brute[node]));
        CHECK(on_links[0] == Approx(brute[0]));
        for (Index link = 0; link < network.size(); ++link) {  // every node of the tree but the mouth begins a link
            const Index upper = network.nodes_of(link).front();
            CHECK(on_links[link] == Approx(brute[upper] + graph.length[upper]));
        }
    }
}

TEST_CASE("The longest ways up a terrain that several threads share are those of one sweep") {
    const support::TestTerrain terrain = support::noise_terrain(450, 470, 4);
    const auto boundary = terrain::data_edge(terrain.grid, terrain.elevation_m);
    FlowDirections directions = terrain::route(terrain.grid, terrain.elevation_m, boundary);
    terrain::drain_lakes(terrain.grid, terrain.elevation_m, boundary, directions);
    const terrain::FlowGraph graph = terrain::flow_graph(terrain.grid, terrain.elevation_m, directions);
    std::vector<double> longest(graph.size(), 0);
    for (const Index node : std::views::reverse(graph.order)) {
        const Index receiver = graph.receiver[node];
        if (receiver != none) longest[receiver] = std::max(longest[receiver], longest[node] + graph.length[node]);
    }
    CHECK(longest_upstream_lengths(graph) == longest);
}

TEST_CASE("Basins that obey Hack's law give back its coefficient and exponent") {
    Random random(22, 0);
    const auto graph = support::random_tree(300, random);
    const auto network = network_of(graph);
    std::vector<double> area(graph.size()), length(graph.size());
    for (Index node = 0; node < graph.size(); ++node) {
        area[node] = 1e4 * std::exp(8 * random.uniform());
        length[node] = 1.7 * std::pow(area[node], 0.57);
    }
    const PowerLawFit law = hack_law(network, area, length);
    CHECK(law.coefficient.value == Approx(1.7));
    CHECK(law.exponent.value == Approx(0.57));
    CHECK(law.r2 == Approx(1));
}

TEST_CASE("Hack's law takes each link where it has met no other river") {
    // Sources 3 and 4 meet in 2; 2 → 1 → 0. At a link's end: nodes 3 and 4 (no length above), and 1.
    const auto graph = graph_of({none, 0, 1, 2, 2, 3, 4, 4}, 10);
    const auto network = stream_network(graph, std::vector<std::uint8_t>{1, 1, 1, 1, 1, 0, 0, 0},
                                        support::upstream_counts(graph), std::vector<double>(8, 0));
    REQUIRE(network.size() == 3);
    const std::vector<double> area = support::upstream_counts(graph), length = longest_upstream_lengths(graph);
    CHECK(length == std::vector<double>{40, 30, 20, 10, 10, 0, 0, 0});
    // areas 7, 2, 3 and lengths 30, 10, 10: regression by hand
    const double x[] = {std::log(7.0), std::log(2.0), std::log(3.0)};
    const double y[] = {std::log(30.0), std::log(10.0), std::log(10.0)};
    CHECK(hack_law(network, area, length).exponent.value == Approx(fit_line(x, y).slope.value));
}

TEST_CASE("Links that fall by Flint's law give back p and q") {
    Random random(23, 0);
    const auto network = with_slopes(network_of(support::random_tree(3000, random)), 0.2, -0.6, random);
    const PowerLawFit law = flint_law(network);
    CHECK(law.coefficient.value == Approx(0.2).epsilon(1e-3));  // a class holds unlike magnitudes
    CHECK(law.exponent.value == Approx(-0.6).margin(2e-3));
    CHECK(law.r2 > 0.9999);
}

TEST_CASE("Flint's law is one of mean slopes: flat links and scatter do not bend it") {
    Random random(24, 0);
    const double sd = 0.5;
    auto network = with_slopes(network_of(support::random_tree(20000, random)), 0.2, -0.5, random);
    for (double& drop : network.drop_m) {
        drop *= std::exp(sd * random.normal());
        if (random.uniform() < 0.2) drop = 0;
    }
    const PowerLawFit law = flint_law(network);
    CHECK(law.exponent.value == Approx(-0.5).margin(0.02));
    CHECK(law.coefficient.value == Approx(0.8 * 0.2 * std::exp(sd * sd / 2)).epsilon(0.02));
}

TEST_CASE("What a law cannot be fitted to is not a number") {
    CHECK(std::isnan(flint_law(StreamNetwork{}).exponent.value));
    CHECK(std::isnan(hack_law(StreamNetwork{}, {}, {}).exponent.value));
    CHECK(std::isnan(flint_law(network_of(graph_of({none, 0, 1}))).coefficient.value));
}

TEST_CASE("Howard's angles of the published cases") {
    const double degree = std::numbers::pi / 180;
    const auto ratio = [](double below, double inflow) { return std::pow(below / inflow, -0.5); };
    CHECK(howard_angle(ratio(2, 1), ratio(2, 1)) == Approx(90 * degree));
    CHECK(howard_angle(ratio(10, 9), ratio(10, 1)) == Approx(90 * degree));
    CHECK(howard_angle(ratio(10, 9), 1) == Approx(18.4349 * degree));
    CHECK(howard_angle(1, ratio(10, 1)) == Approx(71.5651 * degree));
    CHECK(howard_angle(2, 0.5) == Approx(60 * degree));  // the slope below is the steeper
}
