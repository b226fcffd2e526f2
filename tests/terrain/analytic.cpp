// SPDX-License-Identifier: GPL-3.0-or-later
// Planes, cones and paraboloids: slopes and areas against the formula, at the order that the cells allow.
#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <numbers>

#include "support/terrains.hpp"
#include "thalweg/terrain/accumulate.hpp"
#include "thalweg/terrain/route.hpp"

using namespace thalweg;
using namespace thalweg::terrain;
using support::TestTerrain;

namespace {

struct Routed {
    Grid grid;
    std::vector<Boundary> boundary;
    FlowDirections directions;
    FlowGraph graph;
    std::vector<double> area_m2;

    explicit Routed(const TestTerrain& t)
        : grid(t.grid),
          boundary(data_edge(grid, t.elevation_m)),
          directions(route(grid, t.elevation_m, boundary)),
          graph(flow_graph(grid, t.elevation_m, directions)),
          area_m2(accumulate(graph, cell_areas(grid))) {}
};

double slope_of(const Routed& routed, const TestTerrain& t, Index node) {
    const Index receiver = routed.grid.neighbor(node, routed.directions[node]);
    return (t.elevation_m[node] - t.elevation_m[receiver]) / routed.grid.length(node, routed.directions[node]);
}

/// h = −radius^power about the middle, in cells of `cell` metres; NaN near the middle, where there is no slope.
TestTerrain dome(Index n, double power, double cell) {
    return support::terrain_of(
        "dome", n, n,
        [=](Index r, Index c) {
            const double radius = cell * std::hypot(r - 0.5 * (n - 1), c - 0.5 * (n - 1));
            return -std::pow(radius, power);
        },
        cell, cell);
}

}  // namespace

TEST_CASE("planes that fall along the eight directions have their exact slope and area, on oblong cells too") {
    constexpr Index rows = 9, cols = 13;
    const double dx = 30, dy = 20, fall = 0.04;
    for (Slot slot = 0; slot < 8; ++slot) {
        const double east = Grid::col_step[slot] * dx, south = Grid::row_step[slot] * dy;
        const double length = std::hypot(east, south);
        const TestTerrain plane = support::terrain_of(
            "plane", rows, cols, [&](Index r, Index c) { return -fall * (c * dx * east + r * dy * south) / length; },
            dx, dy);
        const Routed routed(plane);
        for (Index r = 1; r + 1 < rows; ++r) {
            for (Index c = 1; c + 1 < cols; ++c) {
                const Index node = r * cols + c;
                INFO("slot " << int(slot) << ", row " << r << ", column " << c);
                REQUIRE(routed.directions[node] == slot);
                CHECK(slope_of(routed, plane, node) == Approx(fall).epsilon(1e-9));
                // Straight lines of cells: so many lie behind, up to the side where the water comes from, but what the
                // rim's own cells send elsewhere.
                const Index behind_col = Grid::col_step[slot] == 0 ? 99 : (Grid::col_step[slot] > 0 ? c : cols - 1 - c);
                const Index behind_row = Grid::row_step[slot] == 0 ? 99 : (Grid::row_step[slot] > 0 ? r : rows - 1 - r);
                CHECK(routed.area_m2[node] == Approx((std::min(behind_col, behind_row) + 1) * dx * dy));
            }
        }
    }
}

TEST_CASE("the steepest descent of a plane is its slope times the cosine to the nearest direction, all around") {
    constexpr Index n = 7;
    for (int degree = 0; degree < 360; ++degree) {
        const double angle = (degree + 0.25) * std::numbers::pi / 180;
        const TestTerrain plane = support::terrain_of(
            "plane", n, n, [&](Index r, Index c) { return -0.1 * (c * std::cos(angle) + r * std::sin(angle)); });
        const Routed routed(plane);
        const double off = std::remainder(angle, std::numbers::pi / 4);
        CHECK(slope_of(routed, plane, n * n / 2) == Approx(0.1 * std::cos(off)).epsilon(1e-9));
    }
}

TEST_CASE(
    "between two directions a plane's water takes the nearer one, to a hundredth of a degree, on oblong cells too") {
    constexpr Index n = 5;
    constexpr double hundredth = 0.01 * std::numbers::pi / 180;
    for (const auto& [dx, dy] : {std::pair{1.0, 1.0}, {30.0, 20.0}, {20.0, 50.0}}) {
        const auto angle_of = [&](Slot slot) {
            return std::atan2(Grid::row_step[slot] * dy, Grid::col_step[slot] * dx);
        };
        for (Slot slot = 0; slot < 8; ++slot) {
            const Slot next = (slot + 1) % 8;
            const double between =
                angle_of(slot) + std::remainder(angle_of(next) - angle_of(slot), 2 * std::numbers::pi) / 2;
            for (const double aside : {-hundredth, hundredth}) {
                const double angle = between + aside;
                const TestTerrain plane = support::terrain_of(
                    "plane", n, n,
                    [&, width = dx, height = dy](Index r, Index c) {
                        return -0.1 * (c * width * std::cos(angle) + r * height * std::sin(angle));
                    },
                    dx, dy);
                INFO("slot " << int(slot) << ", cells of " << dx << " x " << dy);
                CHECK(Routed(plane).directions[n * n / 2] == (aside < 0 ? slot : next));
            }
        }
    }
}

TEST_CASE("along the axes of cones and paraboloids slopes tend to the formula's, and all area leaves by the rim") {
    for (const double power : {1.0, 2.0}) {
        double last_error = 1;
        for (const Index n : {21u, 41u, 81u}) {
            const double extent = 400, cell = extent / (n - 1);
            const TestTerrain t = dome(n, power, cell);
            const Routed routed(t);
            // East of the middle, halfway out: the chord to the receiver against the slope at the node. Exact for the
            // cone; the paraboloid's chord is that of half a cell farther out.
            const Index node = (n / 2) * n + n / 2 + n / 4;
            const double radius = cell * (n / 4), exact = power * std::pow(radius, power - 1);
            CHECK(routed.directions[node] == 0);
            const double error = std::abs(slope_of(routed, t, node) / exact - 1);
            if (power == 1) CHECK(error < 1e-12);
            if (power == 2) CHECK(error == Approx(0.5 * cell / radius).epsilon(1e-9));
            CHECK(error <= last_error);
            last_error = error;
            double leaving = 0;
            for (Index at = 0; at < n * n; ++at) {
                if (routed.graph.receiver[at] == none) leaving += routed.area_m2[at];
            }
            CHECK(leaving == Approx(n * n * cell * cell));
        }
    }
}
