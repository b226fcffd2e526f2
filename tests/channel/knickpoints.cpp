// SPDX-License-Identifier: GPL-3.0-or-later
#include "thalweg/channel/knickpoints.hpp"

#include <catch2/catch.hpp>
#include <cmath>

#include "support/flow_trees.hpp"
#include "thalweg/core/error.hpp"

using namespace thalweg;
using namespace thalweg::channel;

namespace {

constexpr double theta = 0.5, reference = 1e6;

/// One river without tributaries of `steep.size()` steps of 100 m in χ, each as steep as given (m of rise per m of χ).
struct River {
    Profile profile;
    std::vector<double> chi_m;

    explicit River(const std::vector<double>& steep) {
        std::vector<Index> receiver{none};
        std::vector<double> height{0}, area(steep.size() + 1, reference);
        for (std::size_t i = 0; i < steep.size(); ++i) {
            receiver.push_back(static_cast<Index>(i));
            height.push_back(height.back() + 100 * steep[i]);
        }
        profile = channel_profile(support::graph_of(receiver, 100), std::vector<std::uint8_t>(height.size(), 1), area,
                                  height);
        chi_m = chi(profile, theta, reference);
    }
    std::vector<Knickpoint> found(double tolerance_m) const {
        return knickpoints(profile, chi_m, theta, reference, tolerance_m);
    }
};

std::vector<double> steps(std::initializer_list<std::pair<int, double>> reaches) {
    std::vector<double> all;
    for (const auto& [count, steepness] : reaches) all.insert(all.end(), count, steepness);
    return all;
}

}  // namespace

TEST_CASE("A steep reach below a gentle one ends in one knickpoint, with the steepness on both sides") {
    const auto found = River(steps({{20, 0.06}, {30, 0.02}})).found(5);
    REQUIRE(found.size() == 1);
    CHECK(found[0].row == 20);
    // The chord from mouth to source rises 180 m over 5000 m: 72 m at the knickpoint, which stands at 120.
    CHECK(found[0].prominence_m == Approx(48));
    CHECK(found[0].ksn_below == Approx(0.06 * 1000));
    CHECK(found[0].ksn_above == Approx(0.02 * 1000));
    CHECK(River(steps({{20, 0.06}, {30, 0.02}})).found(48.001).empty());
}

TEST_CASE("A river that is straight in chi or steepens upstream has no knickpoint") {
    CHECK(River(steps({{50, 0.03}})).found(1e-6).empty());
    CHECK(River(steps({{20, 0.02}, {20, 0.03}, {20, 0.05}})).found(1e-6).empty());
    CHECK(River({0.1}).found(1).empty());
}

TEST_CASE("Two waves of steepness are two knickpoints, and a step is one at its upper edge") {
    const auto waves = River(steps({{10, 0.08}, {20, 0.05}, {30, 0.01}})).found(5);
    REQUIRE(waves.size() == 2);
    CHECK(waves[0].row == 10);
    CHECK(waves[1].row == 30);
    const auto step = River(steps({{20, 0.02}, {1, 0.5}, {30, 0.02}})).found(5);
    REQUIRE(step.size() == 1);
    CHECK(step[0].row == 21);
    CHECK(step[0].ksn_above == Approx(20));
}

TEST_CASE("A tributary's knickpoint is found on the tributary, and one at a junction on the trunk alone") {
    // Trunk 0 … 30 steep to 10; tributary of 15 nodes from node 20, steep for its first 5 steps.
    std::vector<Index> receiver{none};
    std::vector<double> height{0}, area;
    for (Index i = 0; i < 30; ++i) {
        receiver.push_back(i);
        height.push_back(height.back() + (i < 10 ? 6 : 2));
    }
    const double join = height[20];
    for (Index i = 0; i < 9; ++i) {
        receiver.push_back(i == 0 ? 20 : static_cast<Index>(receiver.size()) - 1);
        height.push_back((i == 0 ? join : height.back()) + (i < 3 ? 10 : 2));
    }
    const auto graph = support::graph_of(receiver, 100);
    area = support::upstream_counts(graph);
    const Profile profile = channel_profile(graph, std::vector<std::uint8_t>(height.size(), 1), area, height);
    const auto found = knickpoints(profile, chi(profile, 0, 1), 0, 1, 5);
    REQUIRE(found.size() == 2);
    std::vector<Index> nodes{profile.node[found[0].row], profile.node[found[1].row]};
    std::ranges::sort(nodes);
    CHECK(nodes == std::vector<Index>{10, 33});
}

TEST_CASE("Under roughness below the tolerance the only knickpoints are the ones put in") {
    for (std::uint32_t seed = 0; seed < 20; ++seed) {
        Random random(8, seed);
        auto steep = steps({{100, 0.06}, {200, 0.02}});
        for (double& s : steep) s *= 1 + 0.2 * random.uniform();
        const auto found = River(steep).found(40);
        REQUIRE(found.size() == 1);
        CHECK(std::abs(static_cast<int>(found[0].row) - 100) <= 3);
    }
}

TEST_CASE("A tolerance that is not positive is refused") { CHECK_THROWS_AS(River({0.1, 0.2}).found(0), Error); }
