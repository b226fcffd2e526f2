// SPDX-License-Identifier: GPL-3.0-or-later
#include "thalweg/channel/tokunaga.hpp"

#include <catch2/catch.hpp>
#include <cmath>

#include "support/flow_trees.hpp"

using namespace thalweg;
using namespace thalweg::channel;
using support::graph_of;
using support::network_of;

TEST_CASE("A hand-drawn river has the side tributaries counted by eye") {
    //  Order 3 runs 3–2–1–0. At 3 two streams of order 2 meet (heads 4 and 5, each fed by two sources) and one source
    //  joins there; at 2 a stream of order 2 comes in (head 6, fed by three sources, of which two form it); at 1 two
    //  sources come in.
    const StreamNetwork network = network_of(graph_of({none, 0, 1, 2, 3, 3, 2, 3, 4, 4, 5, 5, 6, 6, 6, 1, 1}));
    const Tokunaga t = tokunaga(network);
    REQUIRE(t.per_stream.size() == 2);
    REQUIRE(t.per_stream[0].size() == 2);
    CHECK(t.per_stream[0][0] == Approx(1 / 3.0));  // one source too many at 6, three streams of order 2
    CHECK(t.per_stream[0][1] == 3);                // at 3 one, at 1 two
    CHECK(t.per_stream[1] == std::vector<double>{1});
    REQUIRE(t.pooled.size() == 2);
    CHECK(t.pooled[0] == Approx((1 + 1) / 4.0));  // one of order 1, one of order 2; 3 + 1 streams that could have one
    CHECK(t.pooled[1] == 3);
    CHECK(t.a.value == Approx(0.5));
    CHECK(t.c.value == Approx(6));
}

TEST_CASE("Peano's basin is Tokunaga's with a = 1 and c = 2") {
    const Tokunaga t = tokunaga(network_of(support::peano_tree(7)));
    REQUIRE(t.per_stream.size() == 6);
    for (std::size_t i = 0; i < 6; ++i) {
        for (std::size_t k = 0; k < t.per_stream[i].size(); ++k) CHECK(t.per_stream[i][k] == std::pow(2, k));
        CHECK(t.pooled[i] == std::pow(2, i));
    }
    CHECK(t.a.value == Approx(1));
    CHECK(t.c.value == Approx(2));
    CHECK(t.c.standard_error < 1e-6);
}

TEST_CASE("Shreve's random trees have 2^(k−1) side tributaries k orders below") {
    // 60 trees; the tolerance is four standard errors of the mean over the trees, from their own spread.
    constexpr int trees = 60;
    std::vector<std::vector<double>> by_k(4);
    double a = 0, c = 0;
    for (std::uint32_t trial = 0; trial < trees; ++trial) {
        Random random(11, trial);
        const Tokunaga t = tokunaga(network_of(support::random_tree(4000, random)));
        for (std::size_t k = 0; k < 4; ++k) by_k[k].push_back(t.pooled.at(k));
        a += t.a.value / trees;
        c += t.c.value / trees;
    }
    for (std::size_t k = 0; k < 4; ++k) {
        const double error = standard_deviation(by_k[k]) / std::sqrt(trees);
        INFO("k " << k + 1 << " mean " << mean(by_k[k]) << " error " << error);
        CHECK(error < 0.06 * std::pow(2, k));
        CHECK(std::abs(mean(by_k[k]) - std::pow(2, k)) < 4 * error + 0.005 * std::pow(2, k));
    }
    CHECK(a == Approx(1).margin(0.05));
    CHECK(c == Approx(2).margin(0.05));
}

TEST_CASE("Every stream either ends at a mouth, forms a larger one or is a side tributary") {
    for (std::uint32_t trial = 0; trial < 30; ++trial) {
        Random random(12, trial);
        std::vector<Index> receiver{none, 0};
        while (receiver.size() < 400) receiver.push_back(random.below(static_cast<Index>(receiver.size())));
        const StreamNetwork network = network_of(graph_of(receiver));
        const Tokunaga t = tokunaga(network);
        const std::size_t highest = t.per_stream.size() + 1;
        std::vector<double> streams(highest + 1, 0), mouths(highest + 1, 0);
        for (Index link = 0; link < network.size(); ++link) {
            const Index below = network.downstream[link], order = network.strahler[link];
            if (below == none) ++mouths[order];
            if (below == none || network.strahler[below] != order) ++streams[order];
        }
        for (std::size_t i = 1; i < highest; ++i) {
            double expected = 2 * streams[i + 1] + mouths[i];
            for (std::size_t k = 1; i + k <= highest; ++k) expected += t.per_stream[i - 1][k - 1] * streams[i + k];
            CHECK(streams[i] == Approx(expected));
        }
    }
}

TEST_CASE("Without two orders there is no Tokunaga law, and with one k no c") {
    CHECK(tokunaga(StreamNetwork{}).per_stream.empty());
    const Tokunaga one = tokunaga(network_of(graph_of({none, 0, 1})));
    CHECK(one.pooled.empty());
    CHECK(std::isnan(one.a.value));
    const Tokunaga two = tokunaga(network_of(graph_of({none, 0, 1, 1, 1})));
    CHECK(two.pooled == std::vector<double>{1});
    CHECK(std::isnan(two.c.value));
}
