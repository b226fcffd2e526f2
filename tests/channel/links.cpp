// SPDX-License-Identifier: GPL-3.0-or-later
#include "thalweg/channel/links.hpp"

#include <catch2/catch.hpp>
#include <cmath>
#include <numbers>

#include "support/flow_trees.hpp"
#include "thalweg/channel/laws.hpp"

using namespace thalweg;
using namespace thalweg::channel;
using support::graph_of;
using support::network_of;

namespace {

constexpr double degree = std::numbers::pi / 180;

OffsetOf offsets_of(const std::vector<Point>& at) {
    return [&at](Index from, Index to) { return Point{at[to].x - at[from].x, at[to].y - at[from].y}; };
}

/// Nodes in a Y: 0 the mouth, 1 the junction, two arms of `steps` unit steps in the given directions (degrees).
struct Fork {
    terrain::FlowGraph graph;
    std::vector<Point> at{{0, 0}, {0, 1}};

    Fork(int steps, std::initializer_list<double> directions_deg) {
        std::vector<Index> receiver{none, 0};
        for (const double direction : directions_deg) {
            Index below = 1;
            for (int i = 1; i <= steps; ++i) {
                receiver.push_back(below);
                below = static_cast<Index>(receiver.size()) - 1;
                at.push_back({i * std::cos(direction * degree), 1 + i * std::sin(direction * degree)});
            }
        }
        graph = graph_of(receiver);
    }
};

}  // namespace

TEST_CASE("Exterior and interior links of a drawn river have the means and deviations worked out by hand") {
    // Sources 4 (two steps: 4–3–2), 5 and 6; junctions 2 and 1; mouth 0.
    const auto graph = graph_of({none, 0, 1, 2, 3, 2, 1}, 10);
    const LinkLengths lengths = link_lengths(network_of(graph));
    CHECK(lengths.exterior.count == 3);
    CHECK(lengths.exterior.mean_m == Approx(40 / 3.0));
    CHECK(lengths.exterior.sd_m == Approx(std::sqrt(100 / 3.0)));
    CHECK(lengths.interior.count == 2);
    CHECK(lengths.interior.mean_m == 10);
    CHECK(lengths.interior.sd_m == 0);
    CHECK(lengths.exterior_interior_ratio == Approx(4 / 3.0));
}

TEST_CASE("A river without tributaries has one exterior link and nothing inside") {
    const LinkLengths lengths = link_lengths(network_of(graph_of({none, 0, 1})));
    CHECK(lengths.exterior.count == 1);
    CHECK(std::isnan(lengths.exterior.sd_m));
    CHECK(lengths.interior.count == 0);
    CHECK(std::isnan(lengths.interior.mean_m));
    CHECK(std::isnan(lengths.exterior_interior_ratio));
}

TEST_CASE("Straight arms meet at the angle they were drawn at, also across the north and west") {
    for (const double turn : {0.0, 70.0, 135.0, 180.0, 265.0}) {
        for (const double angle : {10.0, 45.0, 90.0, 150.0}) {
            const Fork fork(5, {turn, turn + angle});
            const auto angles = junction_angles(network_of(fork.graph), offsets_of(fork.at), 3, -0.5);
            CHECK(angles.count == 1);
            CHECK(angles.mean_rad == Approx(angle * degree));
            CHECK(std::isnan(angles.sd_rad));
        }
    }
}

TEST_CASE("A direction is taken at the stated reach, or over the whole of a shorter link") {
    // One arm goes east, the other two steps north and then far east: only the first two tell it runs north.
    const auto graph = graph_of({none, 0, 1, 2, 3, 1, 5, 6, 7});
    const std::vector<Point> at{{0, -1}, {0, 0}, {1, 0}, {2, 0}, {3, 0}, {0, 1}, {0, 2}, {2, 2}, {4, 2}};
    const auto over = [&](double reach) {
        return junction_angles(network_of(graph), offsets_of(at), reach, -1).mean_rad;
    };
    CHECK(over(0.5) == Approx(90 * degree));
    CHECK(over(2) == Approx(90 * degree));
    CHECK(over(3) == Approx(45 * degree));
    CHECK(over(1000) == Approx(std::atan2(2, 4)));
    CHECK(junction_reach(network_of(graph)) == 10);
}

TEST_CASE("Only junctions of exactly two rivers are measured, and predicted from their magnitudes") {
    const Fork three(4, {0, 60, 120});
    CHECK(junction_angles(network_of(three.graph), offsets_of(three.at), 3, -0.5).count == 0);
    CHECK(std::isnan(junction_angles(network_of(three.graph), offsets_of(three.at), 3, -0.5).mean_rad));
    const Fork two(4, {0, 60});
    const auto angles = junction_angles(network_of(two.graph), offsets_of(two.at), 3, -0.5);
    CHECK(angles.predicted_rad == Approx(2 * std::acos(std::pow(3.0, -0.5))));  // 2u − 1: 3 below, 1 above
    const auto uphill = junction_angles(network_of(two.graph), offsets_of(two.at), 3, 0.2);
    CHECK(uphill.predicted_rad == 0);
    CHECK(std::isnan(junction_angles(network_of(two.graph), offsets_of(two.at), 3, NAN).predicted_rad));
}

TEST_CASE("Offsets on a grid are metres to the east and north, on oblong cells and where rows differ in width") {
    Grid grid = plane_grid(4, 5, 30, 20);
    CHECK(offsets(grid)(7, 7) == Point{0, 0});
    CHECK(offsets(grid)(7, 8) == Point{30, 0});
    CHECK(offsets(grid)(7, 1) == Point{-30, 20});
    CHECK(offsets(grid)(7, 17) == Point{0, -40});
    grid.east_west = {28, 29, 31, 32};
    grid.north_south = {20, 21, 22};
    CHECK(offsets(grid)(5, 19) == Point{4 * 30.5, -43});
    const auto there = offsets(grid)(3, 10), back = offsets(grid)(10, 3);
    CHECK(there.x == -back.x);
    CHECK(there.y == -back.y);
}

namespace {

/// A trunk that runs north from the mouth in unit steps, with a tributary of two nodes at each of the given heights,
/// from the east (+1) or the west (−1).
struct Comb {
    terrain::FlowGraph graph;
    std::vector<Point> at{{0, 0}};

    explicit Comb(const std::vector<int>& sides) {
        std::vector<Index> receiver{none};
        const Index steps = 3 * static_cast<Index>(sides.size()) + 4;
        for (Index i = 1; i <= steps; ++i) {
            receiver.push_back(i - 1);
            at.push_back({0, double(i)});
        }
        for (std::size_t k = 0; k < sides.size(); ++k) {
            Index below = 3 * (static_cast<Index>(k) + 1);
            for (int i = 1; i <= 2; ++i) {
                const double x = sides[k] * i, y = at[below].y + (i == 1 ? 0.3 : 0.0);
                receiver.push_back(below);
                below = static_cast<Index>(receiver.size()) - 1;
                at.push_back({x, y});
            }
        }
        graph = graph_of(receiver);
    }
};

}  // namespace

TEST_CASE("Of a trunk's links those whose tributaries come from one side are cis, the others trans") {
    const Comb comb({1, 1, -1, -1, 1, -1});  // between them: cis, trans, cis, trans, trans
    const CisTrans found = cis_trans_links(network_of(comb.graph), offsets_of(comb.at), 1.5);
    CHECK(found.cis.count == 2);
    CHECK(found.trans.count == 3);
    CHECK(found.cis_share == Approx(0.4));
    CHECK(found.cis.mean_m == 3);
    std::vector<Point> mirrored = comb.at, turned = comb.at;
    for (Point& p : mirrored) p.x = -p.x;
    for (Point& p : turned) p = {p.x * 0.6 - p.y * 0.8, p.x * 0.8 + p.y * 0.6};
    for (const auto& at : {mirrored, turned}) {
        CHECK(cis_trans_links(network_of(comb.graph), offsets_of(at), 1.5).cis.count == 2);
    }
}

TEST_CASE("Links at a mouth, at sources and beside triple junctions are neither cis nor trans") {
    const Comb one({1});
    const CisTrans found = cis_trans_links(network_of(one.graph), offsets_of(one.at), 1.5);
    CHECK(found.cis.count == 0);
    CHECK(found.trans.count == 0);
    CHECK(std::isnan(found.cis_share));
    const Comb two({1, 1});
    auto receiver = two.graph.receiver.list();
    auto at = two.at;
    receiver.push_back(3);  // a third river joins at the lower junction
    at.push_back({-1, 3});
    CHECK(cis_trans_links(network_of(graph_of(receiver)), offsets_of(at), 1.5).cis.count == 0);
    CHECK(cis_trans_links(network_of(two.graph), offsets_of(two.at), 1.5).cis.count == 1);
}
