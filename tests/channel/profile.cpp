// SPDX-License-Identifier: GPL-3.0-or-later
#include "thalweg/channel/profile.hpp"

#include <catch2/catch.hpp>
#include <cmath>

#include "support/flow_trees.hpp"
#include "support/steady_landscape.hpp"
#include "thalweg/channel/concavity.hpp"
#include "thalweg/channel/network.hpp"
#include "thalweg/core/random.hpp"

using namespace thalweg;
using namespace thalweg::channel;

namespace {

struct River {
    terrain::FlowGraph graph;
    std::vector<double> area, height;

    Profile profile() const { return channel_profile(graph, std::vector<std::uint8_t>(graph.size(), 1), area, height); }
};

/// `length` m of channel in `steps` steps whose area falls from the mouth by Hack's law, A = ka·(L − x + x0)^h.
River hack_river(Index steps, double theta, double ks) {
    constexpr double length = 1e4, ka = 6.7, h = 1.7, head = 1000;
    River river;
    std::vector<Index> receiver{none};
    for (Index i = 0; i < steps; ++i) receiver.push_back(i);
    river.graph = support::graph_of(receiver, length / steps);
    for (Index i = 0; i <= steps; ++i) river.area.push_back(ka * std::pow(length + head - i * length / steps, h));
    river.height.assign(steps + 1, 0);
    for (Index i = 1; i <= steps; ++i) {
        river.height[i] = river.height[i - 1] + length / steps * ks * std::pow(river.area[i], -theta);
    }
    return river;
}

/// Trees under one outlet each, steady for θ and ks of their own.
River forest(Index trees, double theta, double scatter, std::uint32_t seed) {
    River river;
    std::vector<Index> receiver;
    Random random(31, seed);
    for (Index tree = 0; tree < trees; ++tree) {
        const auto one = support::random_tree(40, random);
        const Index base = static_cast<Index>(receiver.size());
        for (const Index below : one.receiver.list()) receiver.push_back(below == none ? none : below + base);
    }
    river.graph = support::graph_of(receiver, 100);
    river.area = support::upstream_counts(river.graph);
    for (double& area : river.area) area *= 1e4;
    river.height.assign(receiver.size(), 300);
    for (const Index node : river.graph.order) {
        const Index below = river.graph.receiver[node];
        if (below == none) continue;
        const double slope = 30 * std::pow(river.area[node], -theta) * std::exp(scatter * random.normal());
        river.height[node] = river.height[below] + 100 * slope;
    }
    return river;
}

}  // namespace

TEST_CASE("Chi of a river whose area obeys Hack's law is the integral in closed form") {
    for (const double theta : {0.0, 0.3, 0.45, 0.7}) {
        constexpr double length = 1e4, ka = 6.7, h = 1.7, head = 1000, reference = 1e6;
        const double power = 1 - h * theta;
        const double exact =
            std::pow(reference / ka, theta) * (std::pow(length + head, power) - std::pow(head, power)) / power;
        double previous = 0;
        for (const Index steps : {200u, 400u}) {  // first order: the error halves
            const Profile profile = hack_river(steps, 0.5, 1).profile();
            const double error = chi(profile, theta, reference).back() / exact - 1;
            CHECK(std::abs(error) < 0.03);
            if (previous != 0) CHECK(error == Approx(previous / 2).epsilon(0.1));
            previous = theta == 0 ? 0 : error;
        }
    }
}

TEST_CASE("Where slopes obey the law, elevation is linear in chi and the steepness is ks everywhere") {
    for (const double theta : {0.3, 0.45, 0.6}) {
        const double ks = 25, reference = 2e6;
        const Profile profile = hack_river(500, theta, ks).profile();
        const auto x = chi(profile, theta, reference);
        for (Index i = 1; i < profile.size(); ++i) {
            CHECK(profile.elevation_m[i] == Approx(x[i] * ks * std::pow(reference, -theta)));
        }
        for (const double drop : {0.0, 5.0}) {
            const auto ksn = steepness(profile, x, theta, reference, drop);
            CHECK(std::isnan(ksn[0]));
            CHECK(ksn.back() == Approx(ks));
            for (Index i = 1; i < profile.size(); ++i) {
                if (profile.elevation_m[i] >= drop) CHECK(ksn[i] == Approx(ks));
                if (profile.elevation_m[i] < drop) CHECK(std::isnan(ksn[i]));
            }
        }
    }
}

TEST_CASE("A profile holds the channel nodes alone, receivers first, and numbers what flows to one base") {
    // 4 → 3 → 2 → 0 and 5 → 2, of which 2 is no channel; 1 stands alone.
    const auto graph = support::graph_of({none, none, 0, 2, 3, 2}, 7);
    const std::vector<double> area{1, 2, 3, 4, 5, 6}, height{0, 0, 1, 2, 3, 4};
    const Profile p = channel_profile(graph, std::vector<std::uint8_t>{1, 1, 0, 1, 1, 1}, area, height);
    REQUIRE(p.node == std::vector<Index>{0, 1, 3, 5, 4});
    CHECK(p.below == std::vector<Index>{none, none, none, none, 2});
    CHECK(p.river == std::vector<Index>{0, 1, 2, 3, 2});
    CHECK(p.length_m == std::vector<double>{0, 0, 0, 0, 7});
    CHECK(p.area_m2 == std::vector<double>{1, 2, 4, 6, 5});
    CHECK(chi(p, 0, 1) == std::vector<double>{0, 0, 0, 0, 7});
}

TEST_CASE("Chi's linearity finds the concavity of a steady river with tributaries, on and between the grid's values") {
    for (const double theta : {0.2, 0.35, 0.45, 0.5125, 0.8, 1.1}) {
        const Estimate best = concavity(forest(8, theta, 0, 1).profile()).linearity;
        CHECK(best.value == Approx(theta).margin(1e-3));
        CHECK(best.interval95[0] == Approx(theta).margin(2e-3));
        CHECK(best.interval95[1] == Approx(theta).margin(2e-3));
    }
}

TEST_CASE("On a steady raster chi's linearity finds the concavity as well") {
    const Grid grid = plane_grid(120, 120, 90, 90);
    for (const double theta : {0.4, 0.55}) {
        const auto height = support::steady_raster(grid, {.theta = theta}, 3);
        const auto dem = support::routed_dem(grid, height);
        const auto channels = channels_by_area(dem.area_m2, 20 * 8100.0);
        const auto profile = channel_profile(dem.graph, channels, dem.area_m2, dem.carved_m);
        CHECK(concavity(profile).linearity.value == Approx(theta).margin(0.005));
    }
}

TEST_CASE("The interval of the bootstrap holds the truth in about 95 of 100 scattered landscapes") {
    int held = 0, width = 0;
    constexpr int landscapes = 60;
    for (std::uint32_t seed = 0; seed < landscapes; ++seed) {
        const Estimate best = concavity(forest(25, 0.45, 0.3, seed).profile()).linearity;
        held += best.interval95[0] <= 0.45 && 0.45 <= best.interval95[1];
        width += best.interval95[1] - best.interval95[0] < 0.2;
        CHECK(best.value == Approx(0.45).margin(0.1));
    }
    INFO(held << " of " << landscapes);
    CHECK(held >= 0.85 * landscapes);
    CHECK(width >= 0.9 * landscapes);
}

TEST_CASE("Too few rivers give no error, and a river that is no river gives no concavity") {
    const Estimate few = concavity(forest(4, 0.45, 0, 1).profile()).linearity;
    CHECK(few.value == Approx(0.45).margin(1e-3));
    CHECK(std::isnan(few.standard_error));
    CHECK(std::isnan(concavity(Profile{}).linearity.value));
    River flat = forest(6, 0.45, 0, 1);
    flat.height.assign(flat.height.size(), 5);
    CHECK(std::isnan(concavity(flat.profile()).linearity.value));
    const Estimate again = concavity(forest(9, 0.45, 0.3, 2).profile()).linearity;
    CHECK(again.standard_error == concavity(forest(9, 0.45, 0.3, 2).profile()).linearity.standard_error);
}
