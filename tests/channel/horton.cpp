// SPDX-License-Identifier: GPL-3.0-or-later
#include "thalweg/channel/horton.hpp"

#include <catch2/catch.hpp>
#include <cmath>

#include "support/flow_trees.hpp"

using namespace thalweg;
using namespace thalweg::channel;

namespace {

/// A network in which every stream of order ω > 1 is one link fed by `branching` streams of order ω − 1 at its head,
/// with lengths, areas and slopes that change by fixed ratios from order to order.
StreamNetwork hortonian(Index highest, Index branching, double length_ratio, double area_ratio, double slope_ratio) {
    StreamNetwork network;
    const auto add = [&](Index below, Index order) {
        const double length = 100 * std::pow(length_ratio, order - 1);
        network.downstream.push_back(below);
        network.strahler.push_back(order);
        network.shreve.push_back(static_cast<Index>(std::pow(branching, order - 1)));
        network.length_m.push_back(length);
        network.drop_m.push_back(length * 0.3 / std::pow(slope_ratio, order - 1));
        network.area_m2.push_back(1e4 * std::pow(area_ratio, order - 1));
    };
    add(none, highest);
    for (Index link = 0; link < network.size(); ++link) {
        if (network.strahler[link] == 1) break;
        for (Index i = 0; i < branching; ++i) add(link, network.strahler[link] - 1);
    }
    return network;
}

}  // namespace

TEST_CASE("A network built by Horton's laws gives back its ratios exactly") {
    const StreamNetwork network = hortonian(5, 4, 2.1, 4.5, 1.7);
    const auto orders = strahler_statistics(network);
    REQUIRE(orders.size() == 5);
    for (Index i = 0; i < 5; ++i) {
        CHECK(orders[i].order == i + 1);
        CHECK(orders[i].streams == static_cast<Index>(std::pow(4, 4 - i)));
        CHECK(orders[i].mean_length_m == Approx(100 * std::pow(2.1, i)));
        CHECK(orders[i].mean_area_m2 == Approx(1e4 * std::pow(4.5, i)));
        CHECK(orders[i].mean_slope == Approx(0.3 / std::pow(1.7, i)));
        CHECK(orders[i].mean_drop_m == Approx(30 * std::pow(2.1 / 1.7, i)));
    }
    const HortonRatios ratios = horton_ratios(orders);
    const auto check = [](const HortonRatio& ratio, double truth) {
        CHECK(ratio.regression == Approx(truth));
        CHECK(ratio.mean_ratio == Approx(truth));
    };
    check(ratios.bifurcation, 4);
    check(ratios.length, 2.1);
    check(ratios.area, 4.5);
    check(ratios.slope, 1.7);
    CHECK(ratios.bifurcation.regression_se == Approx(0).margin(1e-9));
}

TEST_CASE("The errors of a Horton ratio are those of the line through its three orders") {
    // Lengths 100, 200·1.1, 400: logarithms off the line by d, −2d and d, d = −ln 1.1/3.
    std::vector<OrderStatistics> orders;
    for (const auto& [order, length] : {std::pair{1u, 100.0}, {2u, 220.0}, {3u, 400.0}}) {
        orders.push_back({order, 1, length, 1, 1, 1});
    }
    const HortonRatio ratio = horton_ratios(orders).length;
    const double squares = 6 * std::pow(std::log(1.1) / 3, 2), error = std::sqrt(squares / 2);  // Σ(x − x̄)² = 2
    CHECK(ratio.regression == Approx(2));
    CHECK(ratio.regression_se == Approx(2 * error));
    CHECK(ratio.regression_ci95[0] == Approx(2 * std::exp(-12.706 * error)).epsilon(1e-4));  // t with one degree
    CHECK(ratio.regression_ci95[1] == Approx(2 * std::exp(12.706 * error)).epsilon(1e-4));
    orders.pop_back();
    CHECK(std::isnan(horton_ratios(orders).length.regression_se));
}

TEST_CASE("A stream runs through the side tributaries of lower order that it takes in") {
    // Trunk of order 2: 1–2–3 (two links, a source joins at 2), sources 4, 5 at 3, source 6 at 2, mouth 0.
    //   lengths 10 m, area = nodes upstream
    const terrain::FlowGraph graph = support::graph_of({none, 0, 1, 2, 3, 3, 2}, 10);
    const std::vector<double> height{0, 1, 2, 5, 9, 10, 4};
    const auto network =
        stream_network(graph, std::vector<std::uint8_t>(7, 1), support::upstream_counts(graph), height);
    const auto orders = strahler_statistics(network);
    REQUIRE(orders.size() == 2);
    CHECK(orders[0].streams == 3);
    CHECK(orders[0].mean_length_m == 10);
    CHECK(orders[0].mean_drop_m == Approx((4 + 5 + 2) / 3.0));
    CHECK(orders[0].mean_area_m2 == 1);
    CHECK(orders[1].streams == 1);
    CHECK(orders[1].mean_length_m == 30);
    CHECK(orders[1].mean_drop_m == 5);
    CHECK(orders[1].mean_slope == Approx(5 / 30.0));
    CHECK(orders[1].mean_area_m2 == 7);
}

TEST_CASE("Regression and mean of ratios differ as the formulas say where the laws only hold roughly") {
    // N = 16, 4, 2: ratios 4 and 2, mean 3; regression: slope of log10 N on order is (log 2 − log 16)/2, so √8.
    const std::vector<OrderStatistics> orders{{1, 16, 1, 1, 0.4, 1}, {2, 4, 3, 5, 0.1, 1}, {3, 2, 6, 20, 0.05, 1}};
    const HortonRatios ratios = horton_ratios(orders);
    CHECK(ratios.bifurcation.mean_ratio == Approx(3));
    CHECK(ratios.bifurcation.regression == Approx(std::sqrt(8)));
    CHECK(ratios.length.mean_ratio == Approx(2.5));
    CHECK(ratios.length.regression == Approx(std::sqrt(6)));
    CHECK(ratios.area.mean_ratio == Approx(4.5));
    CHECK(ratios.area.regression == Approx(std::sqrt(20)));
    CHECK(ratios.slope.mean_ratio == Approx(3));
    CHECK(ratios.slope.regression == Approx(std::sqrt(8)));
}

TEST_CASE("Fewer than two orders have no ratios") {
    CHECK(strahler_statistics(StreamNetwork{}).empty());
    const HortonRatios none_at_all = horton_ratios({});
    CHECK(std::isnan(none_at_all.bifurcation.regression));
    const HortonRatios one = horton_ratios(strahler_statistics(hortonian(1, 4, 2, 4, 2)));
    CHECK(std::isnan(one.length.regression));
    CHECK(std::isnan(one.length.mean_ratio));
}

TEST_CASE("An order without slope is left out of the slope ratio only") {
    const std::vector<OrderStatistics> orders{{1, 8, 1, 1, 0.4, 1}, {2, 4, 2, 4, 0.1, 1}, {3, 2, 4, 16, 0, 0}};
    const HortonRatios ratios = horton_ratios(orders);
    CHECK(ratios.slope.regression == Approx(4));
    CHECK(ratios.slope.mean_ratio == Approx(4));
    CHECK(ratios.area.regression == Approx(4));
}

TEST_CASE("Peano's basin has an area ratio of four") {
    // Cells of equal area on every link: RA tends to 4 from order to order, here within what the mouth adds.
    const auto network = support::network_of(support::peano_tree(8));
    const auto orders = strahler_statistics(network);
    REQUIRE(orders.size() == 8);
    for (std::size_t i = 3; i + 1 < orders.size() - 1; ++i) {
        CHECK(orders[i + 1].mean_area_m2 / orders[i].mean_area_m2 == Approx(4).epsilon(0.02));
    }
}
