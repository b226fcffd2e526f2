// SPDX-License-Identifier: GPL-3.0-or-later
#include "thalweg/channel/extent.hpp"

#include <catch2/catch.hpp>
#include <cmath>
#include <numeric>

#include "support/flow_trees.hpp"

using namespace thalweg;
using namespace thalweg::channel;
using support::graph_of;
using support::network_of;

TEST_CASE("The width function of a drawn river counts its links at each distance") {
    // Mouth 0, junction 2 at 20 m; one arm of 30 m to 5, the other of 20 m to 7 with a tributary of 10 m at its middle.
    // A second river, 9 to 11, is smaller and does not count.
    const auto network = network_of(graph_of({none, 0, 1, 2, 3, 4, 2, 6, 6, none, 9, 10}, 10));
    const WidthFunction width = width_function(network);
    REQUIRE(width.links.size() == 50);
    CHECK(width.distance_m.front() == 0.5);
    CHECK(width.distance_m.back() == 49.5);
    const auto at = [&](double distance) { return width.links[static_cast<std::size_t>(distance)]; };
    for (double d = 0.5; d < 20; ++d) CHECK(at(d) == Approx(1));
    for (double d = 20.5; d < 30; ++d) CHECK(at(d) == Approx(2));
    for (double d = 30.5; d < 40; ++d) CHECK(at(d) == Approx(3));
    for (double d = 40.5; d < 50; ++d) CHECK(at(d) == Approx(1));
    CHECK(width_function(StreamNetwork{}).links.empty());
}

TEST_CASE("A width function holds the whole length of its river") {
    for (std::uint32_t trial = 0; trial < 10; ++trial) {
        Random random(41, trial);
        auto network = network_of(support::random_tree(150, random));
        for (double& length : network.length_m) length = 50 * (0.01 + random.uniform());
        const WidthFunction width = width_function(network);
        const double sum = std::accumulate(width.links.begin(), width.links.end(), 0.0);
        const double length = std::accumulate(network.length_m.begin(), network.length_m.end(), 0.0);
        CHECK(sum * 2 * width.distance_m.front() == Approx(length));
    }
}

TEST_CASE("Areas drawn from a power law have its exponent of exceedance") {
    for (const double beta : {0.43, 0.5, 1.0}) {
        std::vector<double> area;
        constexpr int count = 100000;
        for (int i = 0; i < count; ++i) area.push_back(900 * std::pow((i + 0.5) / count, -1 / beta));
        const PowerLawFit law = area_exceedance(area, {}, 5000, 1e5);
        CHECK(law.exponent.value == Approx(-beta).epsilon(0.01));
        std::vector<std::uint8_t> used(area.size(), 1);
        area.insert(area.end(), 5000, 1e6);
        used.insert(used.end(), 5000, 0);
        CHECK(area_exceedance(area, used, 5000, 1e5).exponent.value == law.exponent.value);
    }
    CHECK(std::isnan(area_exceedance(std::vector<double>{1, 2, 3}, {}, 10, 5).exponent.value));
    CHECK(std::isfinite(area_exceedance(std::vector<double>{1, 2, 3}, {}, 1e-308, 1e9).exponent.value));
}
