// SPDX-License-Identifier: GPL-3.0-or-later
#include "thalweg/channel/divides.hpp"

#include <catch2/catch.hpp>
#include <cmath>
#include <numbers>

#include "thalweg/core/random.hpp"

using namespace thalweg;
using namespace thalweg::channel;

namespace {

using std::numbers::pi;

constexpr Index side = 61, middle = side / 2;

Index cell(Index row, Index col) { return row * side + col; }

/// A river from the south edge to the middle, where one from the north and one from the east meet (or, mirrored, from
/// the west), and valleys that straight lines from there part: their directions, counter-clockwise from the south.
struct Meeting {
    std::array<double, 3> divides;
    bool mirrored = false;
    double cell_m = 10;
};

struct Drawn {
    Grid grid;
    terrain::FlowGraph graph;
    StreamNetwork network;
};

/// Water goes straight to a channel cell of the valley's link: only where it arrives counts.
Drawn drawn(const Meeting& m) {
    Drawn d{.grid = plane_grid(side, side, m.cell_m, m.cell_m), .graph = {}, .network = {}};
    std::vector<Index> receiver(side * side, none);
    std::vector<double> length(side * side, 0);
    std::vector<std::uint8_t> channel(side * side, 0);
    std::vector<Index> along;  // receivers first
    const auto flows = [&](Index from, Index to) {
        channel[from] = 1;
        receiver[from] = to;
        length[from] = m.cell_m;
        along.push_back(from);
    };
    channel[cell(side - 1, middle)] = 1;
    along.push_back(cell(side - 1, middle));
    for (Index row = side - 1; row-- > 0;) flows(cell(row, middle), cell(row + 1, middle));
    for (Index col = middle + 1; col < side; ++col) {
        const auto at = [&](Index c) { return cell(middle, m.mirrored ? side - 1 - c : c); };
        flows(at(col), at(col - 1));
    }
    const std::array feet{cell(middle + 5, middle), cell(middle, m.mirrored ? middle - 5 : middle + 5),
                          cell(middle - 5, middle)};
    for (Index row = 0; row < side; ++row) {
        for (Index col = 0; col < side; ++col) {
            if (channel[cell(row, col)]) continue;
            double x = static_cast<double>(col) - middle;
            const double y = static_cast<double>(middle) - row;
            if (m.mirrored) x = -x;
            double angle = std::atan2(x, -y);  // counter-clockwise from the south
            if (angle < 0) angle += 2 * pi;
            std::size_t valley = 0;
            if (angle > m.divides[0] && angle <= m.divides[1]) valley = 1;
            if (angle > m.divides[1] && angle <= m.divides[2]) valley = 2;
            receiver[cell(row, col)] = feet[valley];
            along.push_back(cell(row, col));
        }
    }
    d.graph.receiver = std::move(receiver);
    d.graph.length = std::move(length);
    d.graph.order = along;
    std::vector<double> area(side * side, 1), elevation(side * side, 0);
    d.network = stream_network(d.graph, channel, area, elevation);
    return d;
}

DividesByPlace measured(const Meeting& m, double reach_m = 200) {
    const Drawn d = drawn(m);
    REQUIRE(d.network.size() == 3);
    return divide_angles(junction_divides(d.grid, d.graph, d.network, reach_m),
                         straightest_streams(d.network, offsets(d.grid), reach_m));
}

}  // namespace

TEST_CASE("Divides between valleys that straight lines part run along those lines") {
    Random random(1, 0);
    double squares = 0;
    constexpr int trials = 200;
    for (int trial = 0; trial < trials; ++trial) {
        const std::array at{(0.1 + 0.8 * random.uniform()) * pi / 2, (1.1 + 0.8 * random.uniform()) * pi / 2,
                            (1.1 + 0.8 * random.uniform()) * pi};
        const DividesByPlace m = measured({.divides = at});
        REQUIRE(m.below.share.count == 1);
        REQUIRE(m.above.share.count == 1);
        REQUIRE(m.across.share.count == 1);
        // In a disc of 20 cells' radius cells lie every degree or two around any direction.
        CHECK(m.below.mean_rad == Approx(at[0]).margin(0.03));
        CHECK(m.above.mean_rad == Approx(at[1] - pi / 2).margin(0.03));
        CHECK(m.across.mean_rad == Approx(2 * pi - at[2]).margin(0.03));
        CHECK(m.below.sector_mean_rad == Approx(pi / 2));
        CHECK(m.across.share.mean.value == Approx(m.across.mean_rad / pi));
        squares += std::pow(m.below.mean_rad - at[0], 2) + std::pow(m.above.mean_rad - at[1] + pi / 2, 2);
    }
    CHECK(std::sqrt(squares / 2 / trials) < 0.01);
}

TEST_CASE("Mirrored, and in other units, the divides of a junction are the same") {
    Random random(2, 0);
    for (int trial = 0; trial < 50; ++trial) {
        Meeting m{.divides = {(0.1 + 0.8 * random.uniform()) * pi / 2, (1.1 + 0.8 * random.uniform()) * pi / 2,
                              (1.1 + 0.8 * random.uniform()) * pi}};
        const DividesByPlace one = measured(m);
        m.mirrored = true;
        const DividesByPlace other = measured(m);
        m = {.divides = m.divides, .cell_m = 3};
        const DividesByPlace small = measured(m, 60);
        CHECK(one.below.mean_rad == Approx(other.below.mean_rad).epsilon(1e-9));
        CHECK(one.above.mean_rad == Approx(other.above.mean_rad).epsilon(1e-9));
        CHECK(one.across.mean_rad == Approx(other.across.mean_rad).epsilon(1e-9));
        CHECK(one.across.mean_rad == Approx(small.across.mean_rad).epsilon(1e-9));
    }
}

TEST_CASE("A few cells on the wrong side of a divide do not turn it") {
    const Meeting m{.divides = {0.8, 2.3, 4.9}};
    Drawn d = drawn(m);
    Random random(3, 0);
    std::vector<Index> receiver = d.graph.receiver.list();
    for (int i = 0; i < 60; ++i) {  // of 1256 in the disc
        const Index row = middle - 20 + random.below(41), col = middle - 20 + random.below(41);
        if (row == middle || col == middle) continue;
        receiver[cell(row, col)] = cell(middle - 5, middle);
    }
    d.graph.receiver = std::move(receiver);
    const auto divides = divide_angles(junction_divides(d.grid, d.graph, d.network, 200),
                                       straightest_streams(d.network, offsets(d.grid), 200));
    CHECK(divides.above.mean_rad == Approx(2.3 - pi / 2).margin(0.05));
    CHECK(divides.across.mean_rad == Approx(2 * pi - 4.9).margin(0.05));
}

TEST_CASE("Where a junction has too few cells around it, its divides are left out") {
    const Drawn d = drawn({.divides = {0.8, 2.3, 4.9}});
    CHECK(junction_divides(d.grid, d.graph, d.network, 200).size() == 3);
    CHECK(junction_divides(d.grid, d.graph, d.network, 14).empty());
    CHECK(junction_divides(d.grid, d.graph, {}, 200).empty());
    const DividesByPlace nothing = divide_angles({}, {});
    CHECK(nothing.above.share.count == 0);
    CHECK(std::isnan(nothing.above.mean_rad));
    CHECK(std::isnan(nothing.above.share.mean.value));
}
