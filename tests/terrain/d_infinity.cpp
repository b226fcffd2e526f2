// SPDX-License-Identifier: GPL-3.0-or-later
#include "thalweg/terrain/d_infinity.hpp"

#include <catch2/catch.hpp>
#include <numbers>

#include "support/divided_flow.hpp"
#include "support/drawing.hpp"
#include "support/terrains.hpp"
#include "thalweg/terrain/accumulate.hpp"
#include "thalweg/terrain/flats.hpp"
#include "thalweg/terrain/graph.hpp"

using namespace thalweg;
using namespace thalweg::terrain;
using namespace thalweg::support;

namespace {

constexpr double pi = std::numbers::pi;

/// Plane that falls in the given direction (counter-clockwise from the east).
TestTerrain plane(Index rows, Index cols, double direction, double dx_m, double dy_m) {
    return terrain_of(
        "plane", rows, cols,
        [=](Index r, Index c) { return -(std::cos(direction) * c * dx_m - std::sin(direction) * r * dy_m); }, dx_m,
        dy_m);
}

FlowDirections drained(const TestTerrain& t) {
    return single_flow(t.grid, t.elevation_m, data_edge(t.grid, t.elevation_m));
}

/// Steepest fall from a cell's centre over the eight triangles, by trying directions one by one; the plane of each
/// triangle written with its own lengths.
double steepest_by_trying(const Grid& grid, const std::vector<double>& z, Index node) {
    constexpr int tries = 4000;
    double steepest = 0;
    for (int corner = 1; corner < 8; corner += 2) {
        for (const int side : {-1, 1}) {
            const Slot diagonal = static_cast<Slot>(corner), straight = static_cast<Slot>((corner + side + 8) % 8);
            const Index e1 = grid.neighbor(node, straight), e2 = grid.neighbor(node, diagonal);
            const double d1 = grid.length(node, straight);
            double d2 = 0;
            grid.neighbors(e1, [&](Index other, double length, Slot) { d2 = other == e2 ? length : d2; });
            const double along = (z[node] - z[e1]) / d1, across = (z[e1] - z[e2]) / d2;
            for (int i = 0; i <= tries; ++i) {
                const double angle = std::atan2(d2, d1) * i / tries;
                steepest = std::max(steepest, along * std::cos(angle) + across * std::sin(angle));
            }
        }
    }
    return steepest;
}

/// Fall of the triangulated surface from a cell in the given direction.
double fall_towards(const Grid& grid, const std::vector<double>& z, Index node, double direction) {
    const double dx = grid.east_west[0], dy = grid.north_south[0];
    const double x = std::cos(direction), y = std::sin(direction);
    const Index beside = node + static_cast<Index>(x > 0 ? 1 : -1);
    const Index above = grid.neighbor(node, y > 0 ? 6 : 2);
    const Index corner = above + static_cast<Index>(x > 0 ? 1 : -1);
    const bool beside_first = std::abs(y) * dx < std::abs(x) * dy;
    const Index e1 = beside_first ? beside : above;
    const double along = (z[node] - z[e1]) / (beside_first ? dx : dy);
    const double across = (z[e1] - z[corner]) / (beside_first ? dy : dx);
    return beside_first ? along * std::abs(x) + across * std::abs(y) : along * std::abs(y) + across * std::abs(x);
}

}  // namespace

TEST_CASE("a drawn cell flows down its steepest facet and divides by the angles") {
    // Facet east and north-east: falls 2 eastward and 1 from there northward, so by atan(1/2) = 26.57° of 45°.
    const Drawing d = draw(R"(
        9 9 6
        9 9 7
        9 9 9)");
    const Grid grid = plane_grid(3, 3, 1, 1);
    const FlowDirections single = single_flow(grid, d.values, data_edge(grid, d.values));
    const auto shares = shares_of(d_infinity(grid, d.values, single), 4);
    const double share = std::atan(0.5) / (pi / 4);
    CHECK(shares.at(2) == Approx(share).epsilon(1e-15));
    CHECK(shares.at(5) == Approx(1 - share).epsilon(1e-15));
    CHECK(d_infinity_angle(grid, d.values, single)[4] == Approx(std::atan(0.5)).epsilon(1e-15));
}

TEST_CASE("on a plane the angle is the plane's, all around, on cells of any shape") {
    for (const auto& [dx, dy] : {std::pair{1.0, 1.0}, {30.0, 10.0}, {2.0, 7.0}}) {
        for (int degree = 0; degree < 360; ++degree) {
            CAPTURE(dx, dy, degree);
            const double direction = (degree + 0.25) * pi / 180;
            const TestTerrain t = plane(3, 3, direction, dx, dy);
            CHECK(d_infinity_angle(t.grid, t.elevation_m, drained(t))[4] == Approx(direction).epsilon(1e-12));
        }
    }
}

TEST_CASE("on a plane falling between south and south-east every row passes on all it has: area is known exactly") {
    for (const double degree : {271.0, 285.0, 292.5, 310.0, 314.0}) {
        CAPTURE(degree);
        const TestTerrain t = plane(20, 60, degree * pi / 180, 1, 1);
        const MultipleFlow flow = d_infinity(t.grid, t.elevation_m, drained(t));
        const auto shares = shares_of(flow, t.grid.cols + 30);
        CHECK(shares.at(2 * t.grid.cols + 30) == Approx((315 - degree) / 45).epsilon(1e-11));
        CHECK(shares.at(2 * t.grid.cols + 31) == Approx((degree - 270) / 45).epsilon(1e-11));
        const std::vector<double> area = accumulate(flow, cell_areas(t.grid));
        for (Index r = 0; r + 1 < 20; ++r) {
            for (Index c = 20; c < 59; ++c) CHECK(area[r * 60 + c] == Approx(r + 1).epsilon(1e-12));
        }
    }
}

TEST_CASE("on a cone the area is half the distance times the width of the flow, to a hundredth in the mean") {
    // On planes flow that leaves a row or column at an angle φ to it is cos φ cells wide (the case above), so at
    // distance R from a cone's top A = R/2·cos φ. Cells on the axes keep too much (half more), which one direction does
    // everywhere.
    const TestTerrain t = cone(201, 201);
    const FlowDirections single = drained(t);
    const auto misfit = [&](const std::vector<double>& area) {
        double count = 0, sum = 0, squares = 0;
        for (Index node = 0; node < t.grid.size(); ++node) {
            const double y = t.grid.row(node) - 100.0, x = t.grid.col(node) - 100.0, distance = std::hypot(x, y);
            if (distance < 60 || distance > 90) continue;
            const double width = std::max(std::abs(x), std::abs(y)) / distance;
            const double off = area[node] / (0.5 * distance * width) - 1;
            ++count;
            sum += off;
            squares += off * off;
        }
        return std::pair(sum / count, std::sqrt(squares / count));
    };
    const auto [mean, spread] = misfit(accumulate(d_infinity(t.grid, t.elevation_m, single), cell_areas(t.grid)));
    CHECK(std::abs(mean) < 0.01);
    CHECK(spread < 0.12);
    CHECK(misfit(accumulate(flow_graph(t.grid, t.elevation_m, single), cell_areas(t.grid))).second > 0.5);
}

TEST_CASE("no direction on the eight facets falls more steeply than the one that is taken") {
    for (std::uint64_t seed = 1; seed <= 12; ++seed) {
        TestTerrain t = noise_terrain(12, 12, seed);
        t.grid = plane_grid(12, 12, 3, 2 + 0.2 * static_cast<double>(seed));
        const FlowDirections single = drained(t);
        const std::vector<double> filled = fill(t.grid, t.elevation_m, data_edge(t.grid, t.elevation_m));
        const std::vector<double> angle = d_infinity_angle(t.grid, t.elevation_m, single);
        for (Index r = 1; r + 1 < 12; ++r) {
            for (Index c = 1; c + 1 < 12; ++c) {
                const Index node = r * 12 + c;
                bool at_water = false;
                t.grid.neighbors(node, [&](Index other, double, Slot) {
                    at_water = at_water || filled[other] > t.elevation_m[other];
                });
                if (at_water || filled[node] > t.elevation_m[node]) continue;
                const double steepest = steepest_by_trying(t.grid, t.elevation_m, node);
                CHECK(fall_towards(t.grid, t.elevation_m, node, angle[node]) == Approx(steepest).epsilon(1e-6));
            }
        }
    }
}

TEST_CASE("facets of a geographic grid are measured with the lengths of their own rows") {
    const Grid grid = uneven_grid(5, 5);
    const Index node = 12, straight = 17, diagonal = 18;  // south and south-east
    std::vector<double> z(25, 100);
    z[straight] = 100 - 0.3 * grid.north_south[2];
    z[diagonal] = z[straight] - 0.1 * grid.east_west[3];
    FlowDirections single(25, no_flow);
    single[node] = 2;
    const auto shares = shares_of(d_infinity(grid, z, single), node);
    const double share = std::atan2(0.1, 0.3) / std::atan2(grid.east_west[3], grid.north_south[2]);
    CHECK(shares.at(diagonal) == Approx(share).epsilon(1e-14));
    CHECK(shares.at(straight) == Approx(1 - share).epsilon(1e-14));
}

TEST_CASE("area by D-infinity solves the linear equations, with lakes, flats, voids and edges") {
    for (std::uint64_t seed = 1; seed <= 25; ++seed) {
        for (const TestTerrain& t : assorted_terrains(seed)) {
            INFO(t.name << " " << t.grid.rows << " x " << t.grid.cols);
            const auto boundary = data_edge(t.grid, t.elevation_m);
            FlowDirections single = route(t.grid, t.elevation_m, boundary);
            resolve_flats(t.grid, t.elevation_m, boundary, single);
            drain_lakes(t.grid, t.elevation_m, boundary, single);
            const MultipleFlow flow = d_infinity(t.grid, t.elevation_m, single);
            std::vector<double> amount = cell_areas(t.grid);
            double total = 0, leaving = 0;
            for (Index node = 0; node < t.grid.size(); ++node) {
                if (std::isnan(t.elevation_m[node])) amount[node] = 0;
                total += amount[node];
            }
            const std::vector<double> expected = accumulate_by_elimination(flow, amount);
            const std::vector<double> found = accumulate(flow, amount);
            for (Index node = 0; node < t.grid.size(); ++node) {
                REQUIRE(found[node] == Approx(expected[node]).epsilon(1e-11));
                REQUIRE(flow.offset[node + 1] - flow.offset[node] <= 2);
                if (flow.offset[node + 1] == flow.offset[node]) leaving += found[node];
            }
            REQUIRE(leaving == Approx(total).epsilon(1e-12));
        }
    }
}

TEST_CASE("a cell beside a void takes the neighbour that there is") {
    const Drawing d = draw(R"(
        9 9 #
        9 9 5
        9 8 #)");
    const Grid grid = plane_grid(3, 3, 1, 1);
    const FlowDirections single = single_flow(grid, d.values, data_edge(grid, d.values));
    CHECK(shares_of(d_infinity(grid, d.values, single), 4) == std::map<Index, double>{{5, 1}});
    CHECK(d_infinity_angle(grid, d.values, single)[4] == 0);
}

TEST_CASE("cells without receiver have no angle, cells that follow the single direction have its angle") {
    const Drawing d = draw(R"(
        9 9 9 9
        9 1 9 0
        9 9 9 9)");
    const Grid grid = plane_grid(3, 4, 3, 4);
    std::vector<Boundary> boundary(12, Boundary::interior);
    boundary[7] = Boundary::base_level;
    FlowDirections single = route(grid, d.values, boundary);
    single[5] = 1;
    const std::vector<double> angle = d_infinity_angle(grid, d.values, single);
    CHECK(std::isnan(angle[7]));
    CHECK(angle[5] == Approx(2 * pi - std::atan2(4, 3)).epsilon(1e-15));
}
