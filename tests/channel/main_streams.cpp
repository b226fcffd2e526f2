// SPDX-License-Identifier: GPL-3.0-or-later
#include "thalweg/channel/main_streams.hpp"

#include <algorithm>
#include <catch2/catch.hpp>
#include <map>
#include <set>
#include <string>

#include "support/flow_trees.hpp"

using namespace thalweg;
using namespace thalweg::channel;
using support::graph_of;
using support::network_of;

namespace {

Profile profile_of(const terrain::FlowGraph& graph) {
    return channel_profile(graph, std::vector<std::uint8_t>(graph.size(), 1), support::upstream_counts(graph),
                           std::vector<double>(graph.size(), 0));
}

/// Code of the link whose upper end is the given node.
std::map<Index, std::int64_t> codes_by_upper_end(const terrain::FlowGraph& graph) {
    const StreamNetwork network = network_of(graph);
    const auto codes = pfafstetter_codes(network);
    std::map<Index, std::int64_t> by_node;
    for (Index link = 0; link < network.size(); ++link) by_node[network.nodes_of(link).front()] = codes[link];
    return by_node;
}

/// A trunk of `joins` junctions (nodes 1 … joins, 0 the mouth), a headwater of 40 nodes above, and at junction i a
/// tributary of size[i] nodes in a row.
terrain::FlowGraph comb(const std::vector<Index>& size, std::vector<Index>& tributary_head) {
    std::vector<Index> receiver{none};
    const auto joins = static_cast<Index>(size.size());
    for (Index i = 0; i < joins + 40; ++i) receiver.push_back(i);
    for (Index i = 0; i < joins; ++i) {
        Index below = i + 1;
        for (Index k = 0; k < size[i]; ++k) {
            receiver.push_back(below);
            below = static_cast<Index>(receiver.size()) - 1;
        }
        tributary_head.push_back(below);
    }
    return graph_of(receiver);
}

}  // namespace

TEST_CASE("At every junction the inflow with the larger area carries the main stream on") {
    // 0 ← 1 ← 2 ← 3 ← 4; 5 joins 1; 6 ← 7 join 2 (as large as 3 ← 4: the first row wins).
    const Profile profile = profile_of(graph_of({none, 0, 1, 2, 3, 1, 2, 6}));
    const MainStreams s = main_streams(profile);
    std::map<Index, Index> order;
    for (Index i = 0; i < profile.size(); ++i) order[profile.node[i]] = s.order[s.stream[i]];
    CHECK(order == std::map<Index, Index>{{0, 1}, {1, 1}, {2, 1}, {3, 1}, {4, 1}, {5, 2}, {6, 2}, {7, 2}});
    REQUIRE(s.parent.size() == 3);
    CHECK(s.parent[0] == none);
    CHECK(s.outside[0] == none);
    CHECK(profile.node[s.outside[s.stream[std::ranges::find(profile.node, 5u) - profile.node.begin()]]] == 1);
}

TEST_CASE("Main streams of random trees are chains, one for each source, with the larger area at each junction") {
    for (std::uint32_t seed = 0; seed < 30; ++seed) {
        Random random(5, seed);
        const auto graph = support::random_tree(60, random);
        const Profile profile = profile_of(graph);
        const MainStreams s = main_streams(profile);
        CHECK(s.parent.size() == 60);
        std::vector<Index> same(profile.size(), 0);
        for (Index i = 0; i < profile.size(); ++i) {
            const Index below = profile.below[i];
            if (below == none) continue;
            if (s.stream[i] == s.stream[below]) {
                ++same[below];
            } else {
                CHECK(s.parent[s.stream[i]] == s.stream[below]);
                CHECK(s.order[s.stream[i]] == s.order[s.stream[below]] + 1);
                CHECK(s.outside[s.stream[i]] == below);
                for (Index j = 0; j < profile.size(); ++j) {
                    if (profile.below[j] == below && s.stream[j] == s.stream[below]) {
                        CHECK(profile.area_m2[j] >= profile.area_m2[i]);
                    }
                }
            }
        }
        CHECK(*std::ranges::max_element(same) == 1);
    }
}

TEST_CASE("Pfafstetter's digits run up the main stream of a drawn river, even at its four largest tributaries") {
    std::vector<Index> head;
    const auto graph = comb({3, 9, 1, 7, 8, 2}, head);  // largest: 9, 8, 7 and 3, at junctions 2, 5, 4 and 1
    const auto code = codes_by_upper_end(graph);
    CHECK(code.at(head[0]) == 2);
    CHECK(code.at(head[1]) == 4);
    CHECK(code.at(head[3]) == 6);
    CHECK(code.at(head[4]) == 8);
    CHECK(code.at(1) == 1);  // mouth to junction 1
    CHECK(code.at(2) == 3);
    CHECK(code.at(3) == 51);  // from junction 2 up to 4, with the small tributary at 3
    CHECK(code.at(head[2]) == 52);
    CHECK(code.at(4) == 53);
    CHECK(code.at(5) == 7);
    CHECK(code.at(6) == 91);  // headwaters, with the tributary at 6
    CHECK(code.at(head[5]) == 92);
    CHECK(code.at(46) == 93);
}

TEST_CASE("A river of one link has code 0, and a single junction the codes 1, 2 and 3") {
    CHECK(codes_by_upper_end(graph_of({none, 0, 1})) == std::map<Index, std::int64_t>{{2, 0}});
    CHECK(codes_by_upper_end(graph_of({none, 0, 1, 1, 2})) == std::map<Index, std::int64_t>{{1, 1}, {3, 2}, {4, 3}});
}

TEST_CASE("Every link of random rivers, also with many inflows at a place, has a code of its own, and codes nest") {
    for (std::uint32_t seed = 0; seed < 40; ++seed) {
        Random random(6, seed);
        std::vector<Index> receiver{none};
        for (Index i = 1; i < 400; ++i) {  // recent nodes are preferred, so that rivers grow long
            const Index back = 1 + random.below(std::min<Index>(i, 30));
            receiver.push_back(i - back);
        }
        const auto graph = graph_of(receiver);
        const StreamNetwork network = network_of(graph);
        const auto codes = pfafstetter_codes(network);
        // Several rivers may end at node 0; each has its own codes.
        std::vector<Index> river(network.size());
        std::set<std::pair<Index, std::int64_t>> seen;
        for (Index link = 0; link < network.size(); ++link) {
            river[link] = network.downstream[link] == none ? link : river[network.downstream[link]];
            CHECK(seen.insert({river[link], codes[link]}).second);
        }
        for (const auto& [of, code] : seen) {  // no code is the beginning of another in the same river
            for (std::int64_t shorter = code / 10; shorter > 0; shorter /= 10) CHECK(!seen.contains({of, shorter}));
        }
    }
}
