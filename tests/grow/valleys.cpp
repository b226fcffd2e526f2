// SPDX-License-Identifier: GPL-3.0-or-later
#include "thalweg/grow/valleys.hpp"

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <limits>
#include <map>
#include <set>

#include "support/basins.hpp"
#include "thalweg/grow/elevations.hpp"
#include "thalweg/grow/grow.hpp"

using namespace thalweg;
using namespace thalweg::grow;

namespace {

Growth grown(std::uint64_t seed, const Dials& given = {}) {
    Dials dials = given;
    dials.channel_maintenance_m = 1000;
    dials.seed = seed;
    return grow::grow(support::square_basin(10000), dials);
}

double length_of(const Network& network, const Edge& edge) {
    return support::distance(network.vertices[edge.from], network.vertices[edge.to]);
}

}  // namespace

TEST_CASE("A grown network's streams are told by their direction alone") {
    for (std::uint64_t seed = 1; seed <= 20; ++seed) {
        const Growth growth = grown(seed);
        if (growth.last_resorts > 0) continue;  // links have turned
        const Network& network = growth.network;
        const auto streams =
            channel::straightest_streams(stream_network(network, elevations(network, {}, 0)), offsets(network), 1e9);
        std::map<Index, Index> name;
        for (Index link = 0; link < network.size(); ++link) {
            REQUIRE(name.emplace(streams.stream[link], network.stream[link]).first->second == network.stream[link]);
        }
        REQUIRE(name.size() == network.junctions.size() + 1);
    }
}

TEST_CASE("Beyond every source lies its head, and nothing beyond other links") {
    for (std::uint64_t seed = 1; seed <= 20; ++seed) {
        const Network network = grown(seed).network;
        const auto beyond = beyond_sources(network);
        double heads = 0;
        for (const Edge& edge : network.edges) {
            if (edge.kind == EdgeKind::head) heads += length_of(network, edge);
        }
        double sum = 0;
        for (Index link = 0; link < network.size(); ++link) {
            CHECK((beyond[link] > 0) == network.is_exterior(link));
            sum += beyond[link];
        }
        CHECK(sum == Approx(heads));
    }
}

TEST_CASE("Every divide is the ridge of two valley sides, the outline of one, and none lies below its channel") {
    for (std::uint64_t seed = 1; seed <= 20; ++seed) {
        const Network network = grown(seed).network;
        const auto sides = channel::valley_sides(ridge_pieces(network, elevations(network, {}, 100)));
        double lines = 0;
        for (const Edge& edge : network.edges) {
            if (edge.kind == EdgeKind::divide) lines += 2 * length_of(network, edge);
            if (edge.kind == EdgeKind::outline) lines += length_of(network, edge);
        }
        double ridges = 0;
        std::set<std::pair<Index, channel::Bank>> seen;
        for (const channel::ValleySide& side : sides) {
            ridges += side.ridge_m;
            CHECK(side.rise_m >= 0);
            CHECK(side.run_m > 0);
            CHECK(seen.emplace(side.link, side.bank).second);
        }
        CHECK(ridges == Approx(lines));
    }
}

TEST_CASE("Every junction's three divides are found where they were drawn") {
    Dials dials;
    dials.divides = Divides::shares;
    dials.divide_across.mean = 0.6;
    dials.divide_below.mean = 0.3;
    dials.divide_above.mean = 0.45;
    for (std::uint64_t seed = 1; seed <= 20; ++seed) {
        const Growth growth = grown(seed, dials);
        const Network& network = growth.network;
        const auto divides = junction_divides(network);
        CHECK(divides.size() == 3 * network.junctions.size());
        if (growth.last_resorts > 0) continue;  // links have turned: streams are no longer told by their direction
        const auto m = growth_measures(network, elevations(network, dials.flint, 100)).divides;
        CHECK(m.across.share.mean.value == Approx(0.6).epsilon(1e-6));
        CHECK(m.below.share.mean.value == Approx(0.3).epsilon(1e-6));
        CHECK(m.above.share.mean.value == Approx(0.45).epsilon(1e-6));
        CHECK(m.above.share.delta.value < 1e-6);
        CHECK(m.across.sector_mean_rad == Approx(3.14159265358979));
        CHECK(m.across.mean_rad == Approx(0.6 * 3.14159265358979));
    }
}

TEST_CASE("Drawn shares of divides have the mean and spread that was asked for") {
    Dials dials;
    dials.divides = Divides::shares;
    dials.divide_across = {.mean = 0.55, .delta = 0.1};
    dials.divide_below = {.mean = 0.35, .delta = 0.2};
    dials.divide_above = {.mean = 0.5, .delta = 0.3};
    std::array<std::array<double, 2>, 3> sum{};
    int networks = 0;
    for (std::uint64_t seed = 1; seed <= 40; ++seed) {
        const Growth growth = grown(seed, dials);
        if (growth.last_resorts > 0) continue;
        ++networks;
        const auto m = growth_measures(growth.network, elevations(growth.network, dials.flint, 100)).divides;
        for (std::size_t i = 0; const auto* divide : {&m.across, &m.below, &m.above}) {
            sum[i][0] += divide->share.mean.value;
            sum[i++][1] += divide->share.delta.value;
        }
    }
    REQUIRE(networks >= 10);
    for (std::size_t i = 0; const auto* dial : {&dials.divide_across, &dials.divide_below, &dials.divide_above}) {
        INFO(i);
        CHECK(sum[i][0] / networks == Approx(dial->mean).margin(0.01));
        CHECK(sum[i++][1] / networks == Approx(dial->delta).margin(0.02));
    }
}

namespace {

/// One link along the middle of a long basin, with head lines to its corners and sides of 100 m to the east and west.
Network tray() {
    Network network;
    network.vertices = {{0, 0}, {0, 1000}, {100, 0}, {100, 1000}, {-100, 1000}, {-100, 0}};
    network.edges = {{0, 1, EdgeKind::channel}, {0, 2, EdgeKind::head}, {2, 3, EdgeKind::divide},
                     {3, 1, EdgeKind::head},    {1, 4, EdgeKind::head}, {4, 5, EdgeKind::outline},
                     {5, 0, EdgeKind::head}};
    network.downstream = {none};
    network.upstream = {{none, none}};
    network.lower = {0};
    network.upper = {1};
    network.polygon_vertices = {0, 1, 4, 5, 1, 0, 2, 3};
    network.polygon_offset = {0, 4, 8};
    return network;
}

}  // namespace

TEST_CASE("A ditch through a tray has the slopes that its corners say") {
    // Level, with sides of 30° to the east and 45° to the west that reach the outline at their full height: along the
    // two long sides the slope is the tangent.
    const Network network = tray();
    const double tall = 100 * std::tan(0.7), low = 100 * std::tan(0.3);
    const auto sides = channel::valley_sides(ridge_pieces(network, std::vector<double>{0, 0, low, low, tall, tall}));
    REQUIRE(sides.size() == 2);
    CHECK(sides[0].bank == channel::Bank::left);  // looking south, that is east
    CHECK(sides[0].rise_m == Approx(low));
    CHECK(sides[0].run_m == Approx(100));
    CHECK(sides[1].rise_m == Approx(tall));
    CHECK(sides[1].ridge_m == Approx(1000));
    const auto angles = channel::sidewall_angles(sides);
    CHECK(angles.mean.value == Approx(0.5 * 180 / 3.14159265358979));
}

TEST_CASE("Ridges beyond the reach of their valley sides are as high as at it") {
    Network network = tray();
    network.magnitude = {1};
    network.length_m = {1000};
    network.sidewall_slope = {{0.5, 0.2}};  // west, east
    const Flint flint{.p = 0.03, .q = -0.6};
    const auto heights = [&](double reach) {
        network.sidewall_reach_m = reach;
        return elevations(network, flint, 7);
    };
    const std::vector<double> straight{7, 37, 7 + 20, 37 + 20, 37 + 50, 7 + 50};
    const std::vector<double> cut{7, 37, 7 + 12, 37 + 12, 37 + 30, 7 + 30};
    for (std::size_t i = 0; i < 6; ++i) {
        INFO(i);
        CHECK(heights(std::numeric_limits<double>::infinity())[i] == Approx(straight[i]));
        CHECK(heights(100)[i] == Approx(straight[i]));
        CHECK(heights(60)[i] == Approx(cut[i]));
    }
    // Measured up to where they rise, the sides have their own slopes again.
    const auto pieces = ridge_pieces(network, heights(60));
    CHECK(channel::ridge_distance(pieces, 0.99) == Approx(100));
    const double mean_rad = (std::atan(0.5) + std::atan(0.2)) / 2;
    const auto angles = channel::sidewall_angles(channel::valley_sides(pieces, 60));
    CHECK(angles.mean.value == Approx(mean_rad * 180 / 3.14159265358979));
}

TEST_CASE("A reach beyond all ridges changes no grown terrain, a shorter one lowers it and keeps its channels") {
    Dials dials;
    const Growth straight = grown(3);
    const auto high = elevations(straight.network, dials.flint, 0);
    dials.sidewall_reach_m = 1e6;
    CHECK(elevations(grown(3, dials).network, dials.flint, 0) == high);
    dials.sidewall_reach_m = 400;
    const Network network = grown(3, dials).network;
    const auto low = elevations(network, dials.flint, 0);
    const double steepest =
        std::tan((dials.sidewall_angle_deg + dials.delta_sidewall_angle_deg) * 3.14159265358979 / 180);
    double highest_channel = 0;
    for (const Index vertex : network.upper) {
        CHECK(low[vertex] == high[vertex]);
        highest_channel = std::max(highest_channel, low[vertex]);
    }
    double lowered = 0;
    for (std::size_t i = 0; i < low.size(); ++i) {
        CHECK(low[i] <= high[i]);
        CHECK(low[i] <= highest_channel + 400 * steepest);
        lowered = std::max(lowered, high[i] - low[i]);
    }
    CHECK(lowered > 50);
}

TEST_CASE("What is measured on a tree rises with the dial that it tells of") {
    const auto measured = [](const Dials& dials) {
        std::array<double, 8> sum{};
        for (std::uint64_t seed = 1; seed <= 30; ++seed) {
            const Network network = grown(seed, dials).network;
            const auto m = growth_measures(network, elevations(network, dials.flint, 100));
            const std::array values{m.junction_places.mean.value,    m.junction_places.delta.value,
                                    m.headward_reach.mean.value,     m.headward_reach.delta.value,
                                    m.sidewall_angle_deg.mean.value, m.sidewall_angle_deg.delta.value,
                                    m.side_choices.obtuse[0].value,  m.side_choices.opposite[1].value};
            for (std::size_t i = 0; i < values.size(); ++i) sum[i] += std::isnan(values[i]) ? 0 : values[i] / 30;
        }
        return sum;
    };
    struct Turn {
        double Dials::*dial;
        double low, high, least_gain;
    };
    const std::array<Turn, 8> turns{{{&Dials::mean_junction, 0.35, 0.65, 0.1},
                                     {&Dials::delta_junction, 0.1, 0.45, 0.03},
                                     {&Dials::mean_length, 0.4, 0.8, 0.25},
                                     {&Dials::delta_length, 0.05, 0.35, 0.05},
                                     {&Dials::sidewall_angle_deg, 15, 30, 9},
                                     {&Dials::delta_sidewall_angle_deg, 2, 15, 2},
                                     {&Dials::lower_bias, 0.1, 0.9, 0.15},
                                     {&Dials::middle_bias, 0.1, 0.9, 0.1}}};
    for (std::size_t i = 0; i < turns.size(); ++i) {
        Dials low, high;
        low.*turns[i].dial = turns[i].low;
        high.*turns[i].dial = turns[i].high;
        INFO(i);
        CHECK(measured(high)[i] - measured(low)[i] > turns[i].least_gain);
    }
}
