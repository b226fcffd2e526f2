// SPDX-License-Identifier: GPL-3.0-or-later
#include "thalweg/channel/drop_analysis.hpp"

#include <catch2/catch.hpp>
#include <cmath>

#include "support/flow_trees.hpp"
#include "thalweg/channel/network.hpp"

using namespace thalweg;
using namespace thalweg::channel;

TEST_CASE("Drops of a drawn river are compared by Student's t as worked out by hand") {
    // Mouth 0 ← 1, joined by 2 and 3; 4 and 5 join 2, 6 and 7 join 3. Streams of order 1: 4, 5, 6, 7; of order 2: 2 and
    // 3; of order 3: 1.
    const auto graph = support::graph_of({none, 0, 1, 1, 2, 2, 3, 3}, 10);
    const std::vector<double> height{0, 10, 16, 22, 20, 24, 30, 25};
    const auto area = support::upstream_counts(graph);
    const auto tests = drop_analysis(graph, area, area, height, {}, std::vector<double>{1, 2, 9});
    REQUIRE(tests.size() == 3);
    CHECK(tests[0].first_order == 4);
    CHECK(tests[0].higher_order == 3);
    CHECK(tests[0].first_mean_m == Approx((4 + 8 + 8 + 3) / 4.0));
    CHECK(tests[0].higher_mean_m == Approx((6 + 12 + 10) / 3.0));
    // Σ squares about the means: 20.75 and 18.667; pooled variance 39.417/5; t = −3.5833/√(7.8833·(1/4 + 1/3))
    CHECK(tests[0].t == Approx(-3.583333 / std::sqrt(39.416667 / 5 * (1 / 4.0 + 1 / 3.0))));
    CHECK(tests[1].first_order == 2);  // threshold 2: only 1, 2 and 3 are left
    CHECK(std::isnan(tests[1].t));     // one stream of higher order has no variance
    CHECK(tests[2].first_order == 0);
}

namespace {

DropTest drop_test(double threshold, double t, Index higher_order) { return {threshold, 30, higher_order, 1, 1, t}; }

}  // namespace

TEST_CASE("The threshold is the smallest from which on the drops agree, whatever the order of the tests") {
    const double nan = std::nan("");
    const auto& t = drop_test;
    CHECK(threshold_by_drops(std::vector{t(400, 0.1, 9), t(100, -5, 9), t(200, 1.9, 9)}) == 200.0);
    CHECK(threshold_by_drops(std::vector{t(400, 1, 9), t(100, 1, 9), t(200, -1, 9)}) == 100.0);
    CHECK(!threshold_by_drops(std::vector{t(100, -5, 9), t(200, 2, 9), t(400, nan, 9)}));
    CHECK(!threshold_by_drops({}));
    // t changes its sign at 200 and is still far from 0 above.
    const std::vector crossing{t(100, 9, 9),    t(200, 1, 9),  t(400, -3, 9),
                               t(800, -2.1, 9), t(1600, 0, 9), t(3200, nan, 9)};
    CHECK(first_threshold_by_drops(crossing) == 200.0);
    CHECK(lasting_threshold_by_drops(crossing) == 1600.0);
    CHECK(threshold_by_drops(crossing) == 1600.0);
}

TEST_CASE("One larger threshold may differ as chance does, not two, nor by far") {
    const auto& t = drop_test;
    CHECK(threshold_by_drops(std::vector{t(100, -4, 9), t(200, -1, 9), t(400, 2.5, 9), t(800, 1, 9)}) == 200.0);
    CHECK(threshold_by_drops(std::vector{t(100, -4, 9), t(200, -1, 9), t(400, 3.0, 9), t(800, 1, 9)}) == 800.0);
    CHECK(threshold_by_drops(std::vector{t(200, -1, 9), t(400, 2.0, 9), t(800, 2.1, 9), t(1600, 1, 9)}) == 1600.0);
}

TEST_CASE("A threshold that leaves four streams on a side speaks neither for nor against one") {
    const auto& t = drop_test;
    const std::vector few{t(100, -1, 9), t(200, -4, 9), t(400, 0, 4)};
    CHECK(!lasting_threshold_by_drops(few));
    CHECK(threshold_by_drops(few) == 100.0);
    CHECK(threshold_by_drops(std::vector{t(100, -4, 9), t(200, -3, 5), t(400, 0, 4)}) == 400.0);
    CHECK(threshold_by_drops(std::vector{t(100, -1, 9), t(200, -4, 9), t(400, 0, 5)}) == 400.0);
    CHECK(threshold_by_drops(std::vector{t(100, 1, 9), t(200, -4, 9), t(400, 0, 9), t(800, 3.1, 4)}) == 400.0);
    CHECK(threshold_by_drops(std::vector{t(100, -4, 9), t(200, 0, 9), t(400, 2.5, 9), t(800, -2.5, 3)}) == 200.0);
}

TEST_CASE(
    "Where all streams fall alike the test agrees in 95 of 100 rivers, and where the first fall thrice it does not") {
    int alike = 0, unlike = 0;
    for (std::uint32_t seed = 0; seed < 200; ++seed) {
        Random random(9, seed);
        const auto graph = support::random_tree(200, random);
        const auto area = support::upstream_counts(graph);
        const std::vector<std::uint8_t> channel(graph.size(), 1);
        const auto order = strahler_orders(graph, channel);
        // Each stream of random_tree is a chain of links of one order: its drop, normal about 50 m, at its lower end.
        const auto t = [&](double first_order_factor) {
            Random drops(10, seed);
            std::vector<double> height(graph.size(), 0);
            for (const Index node : graph.order) {
                const Index below = graph.receiver[node];
                if (below == none) continue;
                const bool begins = order[below] != order[node] || graph.receiver[below] == none;
                const double drop = 50 + 10 * drops.normal();
                height[node] = height[below] + (begins ? drop * (order[node] == 1 ? first_order_factor : 1) : 0);
            }
            return drop_analysis(graph, area, area, height, {}, std::vector<double>{1})[0].t;
        };
        alike += std::abs(t(1)) < 2;
        unlike += std::abs(t(3)) > 2;
    }
    CHECK(alike > 180);
    CHECK(alike < 200);
    CHECK(unlike == 200);
}

TEST_CASE("The slope-area product is the largest upstream, and zero where nothing falls") {
    const auto graph = support::graph_of({none, 0, 1, 2, 1}, 10);
    const std::vector<double> height{0, 1, 6, 6, 2}, area{500, 400, 200, 100, 100};
    const auto product = slope_area_product(graph, area, height);
    CHECK(product[3] == 0);
    CHECK(product[2] == Approx(200 * 0.25));
    CHECK(product[4] == Approx(100 * 0.01));
    CHECK(product[1] == Approx(50));  // its own would be 4
    CHECK(product[0] == Approx(50));
}
