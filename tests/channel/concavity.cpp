// SPDX-License-Identifier: GPL-3.0-or-later
#include "thalweg/channel/concavity.hpp"

#include <catch2/catch.hpp>
#include <cmath>

#include "support/flow_trees.hpp"
#include "support/steady_landscape.hpp"
#include "thalweg/channel/network.hpp"

using namespace thalweg;
using namespace thalweg::channel;

namespace {

/// Rivers drawn at random whose elevation is a function of χ for the given θ, but for scattered slopes.
template <class Elevation>
Profile rivers(Index count, Index sources, double theta, std::uint32_t seed, double scatter, Elevation elevation) {
    Random random(32, seed);
    std::vector<Index> receiver;
    for (Index one = 0; one < count; ++one) {
        const auto tree = support::random_tree(sources, random);
        const Index base = static_cast<Index>(receiver.size());
        for (const Index below : tree.receiver.list()) receiver.push_back(below == none ? none : below + base);
    }
    const auto graph = support::graph_of(receiver, 100);
    auto area = support::upstream_counts(graph);
    for (double& a : area) a *= 1e6;
    std::vector<double> chi_m(graph.size(), 0), height(graph.size(), 0);
    for (const Index node : graph.order) {
        const Index below = graph.receiver[node];
        if (below == none) continue;
        chi_m[node] = chi_m[below] + 100 * std::pow(1e6 / area[node], theta);
        const double rise = elevation(chi_m[node]) - elevation(chi_m[below]);
        height[node] = height[below] + rise * std::exp(scatter * random.normal());
    }
    return channel_profile(graph, std::vector<std::uint8_t>(graph.size(), 1), area, height);
}

/// Below a wave that has climbed to χ = 250 m the river is five times as steep.
double bent(double chi_m) { return chi_m < 250 ? 0.1 * chi_m : 20 + 0.02 * chi_m; }
double straight(double chi_m) { return 0.03 * chi_m; }

}  // namespace

TEST_CASE("All three rules find the concavity of a steady river") {
    for (const double theta : {0.2, 0.4375, 0.8}) {
        const Concavity best = concavity(rivers(1, 150, theta, 1, 0, straight));
        CHECK(best.linearity.value == Approx(theta).margin(2e-3));
        CHECK(best.collinearity.value == Approx(theta).margin(5e-3));
        CHECK(best.disorder.value == Approx(theta).margin(0.02));
    }
}

TEST_CASE("On a river with a transient wave collinearity and disorder still find the concavity, linearity does not") {
    double linearity_off = 0;
    for (std::uint32_t seed = 0; seed < 10; ++seed) {
        const Concavity best = concavity(rivers(1, 200, 0.45, seed, 0, bent));
        CHECK(best.collinearity.value == Approx(0.45).margin(0.01));
        CHECK(best.disorder.value == Approx(0.45).margin(0.03));
        const double off = std::abs(best.linearity.value - 0.45);
        linearity_off += std::isnan(off) ? 0.5 : off;
    }
    CHECK(linearity_off / 10 > 0.015);
}

TEST_CASE("Twenty scattered rivers have intervals that hold the truth in 9 (disorder: 3) of 10 (4) landscapes") {
    int collinear = 0, disordered = 0;
    constexpr int landscapes = 60;
    for (std::uint32_t seed = 0; seed < landscapes; ++seed) {
        const Concavity best = concavity(rivers(20, 30, 0.45, seed, 0.3, straight));
        collinear += best.collinearity.interval95[0] <= 0.45 && 0.45 <= best.collinearity.interval95[1];
        disordered += best.disorder.interval95[0] <= 0.45 && 0.45 <= best.disorder.interval95[1];
        CHECK(best.collinearity.value == Approx(0.45).margin(0.15));
        CHECK(best.disorder.value == Approx(0.45).margin(0.15));
    }
    INFO(collinear << " and " << disordered << " of " << landscapes);
    CHECK(collinear >= 0.85 * landscapes);
    CHECK(disordered >= 0.65 * landscapes);  // scatter shifts the least disorder: its interval is too small
}

TEST_CASE("A single scattered river has errors from its tributaries, the same in every run") {
    const Profile profile = rivers(1, 150, 0.45, 3, 0.3, straight);
    const Concavity best = concavity(profile), again = concavity(profile);
    CHECK(std::isnan(best.linearity.standard_error));
    for (const auto& [one, other] :
         {std::pair{best.collinearity, again.collinearity}, {best.disorder, again.disorder}}) {
        CHECK(one.value == Approx(0.45).margin(0.15));
        CHECK(one.standard_error > 0.001);
        CHECK(one.standard_error < 0.2);
        CHECK(one.standard_error == other.standard_error);
    }
}

TEST_CASE(
    "With few tributaries the error is that of the interval, or there is none where the interval ends with the range") {
    int with_error = 0, at_an_end = 0;
    for (std::uint32_t seed = 0; seed < 40; ++seed) {
        const Concavity best = concavity(rivers(1, 14, seed % 2 ? 0.15 : 0.45, seed, 0.8, straight));
        for (const Estimate& one : {best.collinearity, best.disorder}) {
            const auto [low, high] = one.interval95;
            if (std::isnan(low)) continue;
            CAPTURE(seed, one.value, one.standard_error, low, high);
            CHECK(low >= 0);
            CHECK(high <= 1.5);
            const bool ends = low == 0 || high == 1.5;
            CHECK(std::isnan(one.standard_error) == ends);
            ++(ends ? at_an_end : with_error);
            if (!ends) CHECK(one.standard_error == Approx((high - low) / 2 / 1.96).epsilon(1e-4));
        }
    }
    CHECK(with_error > 10);
    CHECK(at_an_end > 3);
}

TEST_CASE(
    "Rivers without tributaries beside one that has some change neither collinearity and disorder nor their errors") {
    const Profile alone = rivers(1, 150, 0.45, 3, 0.3, straight);
    Profile with_rows = alone;
    for (Index river = 1; river <= 8; ++river) {
        for (Index i = 0; i < 30; ++i) {
            with_rows.below.push_back(i == 0 ? none : with_rows.size() - 1);
            with_rows.node.push_back(with_rows.size());
            with_rows.river.push_back(river);
            with_rows.length_m.push_back(i == 0 ? 0 : 100);
            with_rows.area_m2.push_back(1e6 * (30 - i));
            with_rows.elevation_m.push_back(3.0 * i + 0.02 * i * i);
        }
    }
    const Concavity one = concavity(alone), many = concavity(with_rows);
    CHECK(many.collinearity.value == one.collinearity.value);
    CHECK(many.collinearity.interval95 == one.collinearity.interval95);
    CHECK(many.disorder.value == Approx(one.disorder.value).margin(1e-9));
    CHECK(many.disorder.standard_error == Approx(one.disorder.standard_error).epsilon(1e-9));
    CHECK(std::isnan(one.linearity.standard_error));
    CHECK(many.linearity.standard_error > 0);  // each has a line of its own
}

TEST_CASE("An interval holds its estimate well inside, or there is none") {
    int known = 0;
    for (std::uint32_t seed = 0; seed < 100; ++seed) {
        const Concavity best = concavity(rivers(1, 12, 0.45, seed, 0.3, straight));
        for (const Estimate& one : {best.collinearity, best.disorder}) {
            const auto [low, high] = one.interval95;
            known += !std::isnan(low);
            CHECK((std::isnan(low) || (low < one.value && one.value < high)));
        }
    }
    CHECK(known > 150);
}

TEST_CASE("A river without tributaries, a flat one and none at all have no collinearity and no disorder") {
    const auto none_of = [](const Profile& profile) {
        const Concavity c = concavity(profile);
        return std::isnan(c.collinearity.value) && std::isnan(c.disorder.value) &&
               std::isnan(c.collinearity.standard_error) && std::isnan(c.disorder.standard_error);
    };
    std::vector<Index> row{none};
    for (Index i = 0; i < 40; ++i) row.push_back(i);
    const auto graph = support::graph_of(row, 100);
    std::vector<double> height;
    for (Index i = 0; i <= 40; ++i) height.push_back(3.0 * i);
    const auto area = support::upstream_counts(graph);
    CHECK(none_of(channel_profile(graph, std::vector<std::uint8_t>(41, 1), area, height)));
    CHECK(none_of(Profile{}));
    Profile flat = rivers(1, 60, 0.45, 1, 0, straight);
    flat.elevation_m.assign(flat.elevation_m.size(), 7);
    CHECK(std::isnan(concavity(flat).linearity.value));
}

TEST_CASE("On a steady raster all three rules find the concavity") {
    const Grid grid = plane_grid(120, 120, 90, 90);
    const auto height = support::steady_raster(grid, {.theta = 0.5}, 3);
    const auto dem = support::routed_dem(grid, height);
    const auto channels = channels_by_area(dem.area_m2, 20 * 8100.0);
    const Concavity best = concavity(channel_profile(dem.graph, channels, dem.area_m2, dem.carved_m));
    CHECK(best.linearity.value == Approx(0.5).margin(0.005));
    CHECK(best.collinearity.value == Approx(0.5).margin(0.01));
    CHECK(best.disorder.value == Approx(0.5).margin(0.03));
}
