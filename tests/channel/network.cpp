// SPDX-License-Identifier: GPL-3.0-or-later
#include "thalweg/channel/network.hpp"

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <map>
#include <numeric>
#include <set>

#include "support/flow_trees.hpp"
#include "thalweg/terrain/accumulate.hpp"

using namespace thalweg;
using namespace thalweg::channel;
using support::graph_of;
using terrain::FlowGraph;

namespace {

std::vector<std::uint8_t> everywhere(const FlowGraph& graph) { return std::vector<std::uint8_t>(graph.size(), 1); }

std::vector<double> heights(const FlowGraph& graph) {  // metres above the mouth along the flow, 1 in 10
    std::vector<double> height(graph.size(), 0);
    for (const Index node : graph.order) {
        if (graph.receiver[node] != none) height[node] = height[graph.receiver[node]] + 0.1 * graph.length[node];
    }
    return height;
}

StreamNetwork network_of(const FlowGraph& graph, const std::vector<std::uint8_t>& channel) {
    return stream_network(graph, channel, support::upstream_counts(graph), heights(graph));
}

StreamNetwork network_of(const FlowGraph& graph) { return network_of(graph, everywhere(graph)); }

Index count_of_order(const StreamNetwork& network, Index order) {  // streams: links that do not go on in their order
    Index streams = 0;
    for (Index link = 0; link < network.size(); ++link) {
        const Index below = network.downstream[link];
        streams += network.strahler[link] == order && (below == none || network.strahler[below] != order);
    }
    return streams;
}

/// Strahler's orders by pruning, his own definition read backwards: streams of order 1 are the tips with the unbranched
/// channel below them; take them away, and what are tips now is order 2; and so on. Works on sets of links only.
std::vector<Index> orders_by_pruning(const StreamNetwork& network) {
    std::vector<Index> order(network.size(), 0);
    std::set<Index> left;
    for (Index link = 0; link < network.size(); ++link) left.insert(link);
    for (Index current = 1; !left.empty(); ++current) {
        std::map<Index, int> inflows;
        for (const Index link : left) ++inflows[network.downstream[link]];
        std::set<Index> pruned;
        for (const Index tip : left) {
            if (inflows.count(tip)) continue;
            for (Index at = tip; at != none; at = network.downstream[at]) {
                pruned.insert(at);
                if (inflows[network.downstream[at]] > 1) break;
            }
        }
        for (const Index link : pruned) {
            order[link] = current;
            left.erase(link);
        }
    }
    return order;
}

void check_invariants(const FlowGraph& graph, const StreamNetwork& network) {
    REQUIRE(network.offset.size() == network.size() + 1);
    REQUIRE(network.offset.back() == network.nodes.size());
    std::set<Index> upper_ends;
    for (Index link = 0; link < network.size(); ++link) {
        const auto nodes = network.nodes_of(link);
        REQUIRE(nodes.size() >= 2);
        for (std::size_t i = 0; i + 1 < nodes.size(); ++i) REQUIRE(graph.receiver[nodes[i]] == nodes[i + 1]);
        CHECK(upper_ends.insert(nodes[0]).second);
        const Index below = network.downstream[link];
        if (below == none) continue;
        CHECK(below < link);
        CHECK(network.nodes_of(below).front() == nodes.back());
        CHECK(network.shreve[below] > network.shreve[link]);
    }
}

}  // namespace

TEST_CASE("A hand-drawn river has the links, orders and magnitudes worked out by eye") {
    //   8   9
    //    \ /
    //     5   6   7   11
    //      \ /     \  |
    //       4       \ 10
    //        \       \|
    //         \       3
    //          \     /
    //           \   /
    //             2 – 1 – 0 (mouth)
    const FlowGraph graph = graph_of({none, 0, 1, 2, 2, 4, 4, 3, 5, 5, 3, 10});
    const StreamNetwork network = network_of(graph);
    check_invariants(graph, network);
    REQUIRE(network.size() == 9);
    CHECK(std::vector<Index>(network.nodes_of(0).begin(), network.nodes_of(0).end()) == std::vector<Index>{2, 1, 0});
    std::map<Index, Index> of_upper_end;
    for (Index link = 0; link < 9; ++link) of_upper_end[network.nodes_of(link).front()] = link;
    const auto order = [&](Index node) { return network.strahler[of_upper_end.at(node)]; };
    const auto magnitude = [&](Index node) { return network.shreve[of_upper_end.at(node)]; };
    for (const Index source : {6, 7, 8, 9, 11}) {
        CHECK(order(source) == 1);
        CHECK(magnitude(source) == 1);
    }
    CHECK(order(5) == 2);
    CHECK(order(4) == 2);
    CHECK(order(3) == 2);
    CHECK(order(2) == 3);
    CHECK(magnitude(5) == 2);
    CHECK(magnitude(4) == 3);
    CHECK(magnitude(3) == 2);
    CHECK(magnitude(2) == 5);
    const Index from_eleven = of_upper_end.at(11);
    CHECK(network.nodes_of(from_eleven).size() == 3);
    CHECK(network.length_m[from_eleven] == 2);
    CHECK(network.drop_m[from_eleven] == Approx(0.2));
    CHECK(network.area_m2[from_eleven] == 2);  // of node 10, the last before the junction
    CHECK(network.area_m2[0] == 12);           // of the mouth itself
    CHECK(network.drop_m[0] == Approx(0.2));
}

TEST_CASE("A single stream is one link of order and magnitude one") {
    const FlowGraph graph = graph_of({none, 0, 1, 2, 3}, 30);
    const StreamNetwork network = network_of(graph);
    check_invariants(graph, network);
    REQUIRE(network.size() == 1);
    CHECK(network.downstream[0] == none);
    CHECK(network.strahler[0] == 1);
    CHECK(network.shreve[0] == 1);
    CHECK(network.length_m[0] == 120);
    CHECK(network.drop_m[0] == Approx(12));
    CHECK(network.area_m2[0] == 5);
}

TEST_CASE("No channel and a lone channel node make no link") {
    const FlowGraph graph = graph_of({none, 0, 1});
    CHECK(network_of(graph, {0, 0, 0}).size() == 0);
    CHECK(network_of(graph, {0, 0, 0}).offset == std::vector<Index>{0});
    CHECK(network_of(graph, {0, 1, 0}).size() == 0);
    CHECK(network_of(graph, {1, 0, 0}).size() == 0);
}

TEST_CASE("Where three and more streams meet, order rises once if two share the highest") {
    const auto outflow_order = [](std::vector<Index> receiver) {
        const StreamNetwork network = network_of(graph_of(std::move(receiver)));
        return network.strahler[0];
    };
    CHECK(outflow_order({none, 0, 1, 1, 1}) == 2);                    // 1 1 1
    CHECK(outflow_order({none, 0, 1, 1, 1, 1, 1, 1, 1, 1}) == 2);     // eight sources
    CHECK(outflow_order({none, 0, 1, 1, 1, 2, 2}) == 2);              // 2 1 1
    CHECK(outflow_order({none, 0, 1, 1, 1, 2, 2, 3, 3}) == 3);        // 2 2 1
    CHECK(outflow_order({none, 0, 1, 1, 1, 3, 3, 4, 4}) == 3);        // 1 2 2
    CHECK(outflow_order({none, 0, 1, 1, 1, 2, 2, 4, 4}) == 3);        // 2 1 2
    CHECK(outflow_order({none, 0, 1, 1, 1, 2, 2, 3, 3, 4, 4}) == 3);  // 2 2 2
    const StreamNetwork eight = network_of(graph_of({none, 0, 1, 1, 1, 1, 1, 1, 1, 1}));
    CHECK(eight.shreve[0] == 8);
    CHECK(eight.size() == 9);
}

TEST_CASE("A river ends where its receiver is no channel, and what lies outside does not count") {
    // 5 → 3, 4 → 3 → 2 → 1 → 0 with channels at 2 and above only; 6 → 1 is no channel.
    const FlowGraph graph = graph_of({none, 0, 1, 2, 3, 3, 1});
    const StreamNetwork network = network_of(graph, {0, 0, 1, 1, 1, 1, 0});
    check_invariants(graph, network);
    REQUIRE(network.size() == 3);
    CHECK(network.nodes_of(0).back() == 2);
    CHECK(network.downstream[0] == none);
    CHECK(network.strahler[0] == 2);
    CHECK(network.area_m2[0] == 4);
    CHECK(strahler_orders(graph, std::vector<std::uint8_t>{0, 0, 1, 1, 1, 1, 0}) ==
          std::vector<Index>{0, 0, 2, 2, 1, 1, 0});
    CHECK(shreve_magnitudes(graph, std::vector<std::uint8_t>{0, 0, 1, 1, 1, 1, 0}) ==
          std::vector<Index>{0, 0, 2, 2, 1, 1, 0});
}

TEST_CASE("Channels that meet in a mouth are rivers of their own") {
    const FlowGraph graph = graph_of({none, 0, 0, 1, 1});
    const StreamNetwork network = network_of(graph);
    check_invariants(graph, network);
    REQUIRE(network.size() == 4);
    CHECK(network.downstream[0] == none);
    CHECK(network.downstream[1] == none);
    CHECK(network.area_m2[0] == 3);  // node 1, not the shared mouth
    CHECK(network.area_m2[1] == 1);
    CHECK(network.shreve[0] == 2);
    CHECK(network.shreve[1] == 1);
}

TEST_CASE("A channel that is broken in the middle makes two rivers") {
    const FlowGraph graph = graph_of({none, 0, 1, 2, 3, 4});
    const StreamNetwork network = network_of(graph, {1, 1, 0, 1, 1, 1});
    REQUIRE(network.size() == 2);
    CHECK(network.length_m[0] == 1);
    CHECK(network.length_m[1] == 2);
    CHECK(network.strahler[0] == 1);
}

TEST_CASE("Random binary trees have 2·sources − 1 links and the orders that pruning gives") {
    for (std::uint32_t trial = 0; trial < 60; ++trial) {
        Random random(5, trial);
        const Index sources = 1 + random.below(200);
        const FlowGraph graph = support::random_tree(sources, random);
        const StreamNetwork network = network_of(graph);
        check_invariants(graph, network);
        CHECK(network.size() == 2 * sources - 1);
        CHECK(network.shreve[0] == sources);
        CHECK(network.strahler == orders_by_pruning(network));
    }
}

TEST_CASE("Random trees of any branching have the orders that pruning gives and magnitudes that add up") {
    for (std::uint32_t trial = 0; trial < 60; ++trial) {
        Random random(6, trial);
        std::vector<Index> receiver{none, 0};  // one river to the mouth, so that it has no junction there
        while (receiver.size() < 300) receiver.push_back(1 + random.below(static_cast<Index>(receiver.size()) - 1));
        const FlowGraph graph = graph_of(receiver);
        const StreamNetwork network = network_of(graph);
        check_invariants(graph, network);
        CHECK(network.strahler == orders_by_pruning(network));
        std::vector<Index> inflow(network.size(), 0);
        for (Index link = 0; link < network.size(); ++link) {
            if (network.downstream[link] != none) inflow[network.downstream[link]] += network.shreve[link];
        }
        for (Index link = 0; link < network.size(); ++link) {
            CHECK(network.shreve[link] == std::max<Index>(1, inflow[link]));
        }
        const double length = std::accumulate(network.length_m.begin(), network.length_m.end(), 0.0);
        CHECK(length == 299);  // every step lies on exactly one link
    }
}

TEST_CASE("Peano's basin has (2·4^(Ω−ω) + 1)/3 streams of order ω") {
    for (Index order = 1; order <= 7; ++order) {
        const StreamNetwork network = network_of(support::peano_tree(order));
        CHECK(network.strahler[0] == order);
        for (Index each = 1; each <= order; ++each) {
            const Index expected = (2 * static_cast<Index>(std::pow(4, order - each)) + 1) / 3;
            CHECK(count_of_order(network, each) == expected);
        }
    }
}

TEST_CASE("Shreve's random trees have four times as many streams of order 1 as of order 2") {
    // The standard deviation of one tree's N1/N2 is 4/√N1; of the mean of 100 trees a tenth of that.
    for (const Index sources : {200u, 1000u, 5000u}) {
        double sum = 0, squares = 0;
        for (std::uint32_t trial = 0; trial < 100; ++trial) {
            Random random(sources, trial);
            const StreamNetwork network = network_of(support::random_tree(sources, random));
            const double ratio = static_cast<double>(sources) / count_of_order(network, 2);
            sum += ratio;
            squares += ratio * ratio;
        }
        const double average = sum / 100;
        const double sd = std::sqrt(squares / 100 - average * average);
        const double expected_sd = 4 / std::sqrt(static_cast<double>(sources));
        CHECK(std::abs(average - 4) < 4 * expected_sd / 10 + 8.0 / sources);  // the mean of a ratio is off by O(1/N1)
        CHECK(sd == Approx(expected_sd).epsilon(0.3));
    }
}

TEST_CASE("Only nodes with enough area that may be used are channels") {
    const std::vector<double> area{5, 4, 3, 2, 1};
    CHECK(channels_by_area(area, 3) == std::vector<std::uint8_t>{1, 1, 1, 0, 0});
    CHECK(channels_by_area(area, 2, std::vector<std::uint8_t>{0, 1, 0, 1, 1}) ==
          std::vector<std::uint8_t>{0, 1, 0, 1, 0});
}

TEST_CASE("A river of a million nodes needs no stack") {
    constexpr Index count = 1'000'000;
    std::vector<Index> receiver(count, none), order(count, 0);
    std::vector<double> length(count, 0);
    for (Index node = 1; node < count; ++node) {
        receiver[node] = node - 1;
        length[node] = 1;
        order[node] = node;
    }
    const FlowGraph graph{.receiver = receiver, .length = length, .order = order};
    const StreamNetwork network = network_of(graph);
    REQUIRE(network.size() == 1);
    CHECK(network.length_m[0] == count - 1);
}

TEST_CASE("Channels from heads are the nodes with a head at or upstream of them, whatever the order of the heads",
          "[heads]") {
    for (std::uint64_t seed = 0; seed < 50; ++seed) {
        Random random(seed, 5);
        const FlowGraph graph = support::random_tree(1 + random.below(300), random);
        std::vector<Index> heads;
        std::vector<double> is_head(graph.size(), 0);
        for (Index node = 0; node < graph.size(); ++node) {
            if (random.uniform() < 0.02) heads.push_back(node), is_head[node] = 1;
        }
        const auto above = terrain::accumulate(graph, is_head);
        const auto channel = channels_from_heads(graph, heads);
        for (Index node = 0; node < graph.size(); ++node) REQUIRE(channel[node] == (above[node] > 0 ? 1 : 0));
        std::reverse(heads.begin(), heads.end());
        CHECK(channels_from_heads(graph, heads) == channel);
    }
}

TEST_CASE("The heads of channels by area give those channels again", "[heads]") {
    for (std::uint64_t seed = 0; seed < 50; ++seed) {
        Random random(seed, 6);
        const FlowGraph graph = support::random_tree(200, random);
        const auto area = support::upstream_counts(graph);
        for (const double threshold : {1.0, 2.0, 7.0, 40.0, 1e6}) {
            const auto channel = channels_by_area(area, threshold);
            CHECK(channels_from_heads(graph, channel_heads(graph, channel)) == channel);
        }
    }
}

TEST_CASE("Two heads of which one lies on the other's path make one river", "[heads]") {
    const FlowGraph graph = graph_of({none, 0, 1, 2, 3});
    const StreamNetwork network = network_of(graph, channels_from_heads(graph, std::vector<Index>{4, 2}));
    CHECK(network.size() == 1);
    CHECK(network.shreve[0] == 1);
    CHECK(network.length_m[0] == 4);
    CHECK(network_of(graph, channels_from_heads(graph, {})).size() == 0);
}
