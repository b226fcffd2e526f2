// SPDX-License-Identifier: GPL-3.0-or-later
#include "thalweg/terrain/multiple_flow.hpp"

#include <algorithm>
#include <catch2/catch.hpp>
#include <numbers>
#include <tuple>

#include "support/divided_flow.hpp"
#include "support/drawing.hpp"
#include "support/lattice_mesh.hpp"
#include "support/terrains.hpp"
#include "thalweg/core/error.hpp"
#include "thalweg/core/parallel.hpp"
#include "thalweg/terrain/accumulate.hpp"
#include "thalweg/terrain/d_infinity.hpp"
#include "thalweg/terrain/flats.hpp"
#include "thalweg/terrain/graph.hpp"

using namespace thalweg;
using namespace thalweg::terrain;
using namespace thalweg::support;

namespace {

static_assert(ReceiverGraph<FlowGraph>);

using Shares = std::map<Index, double>;

MultipleFlow divided(const Grid& grid, const std::vector<double>& z, Division division = {}) {
    return multiple_flow(grid, z, single_flow(grid, z, data_edge(grid, z)), division);
}

void check_shares(const Shares& found, const Shares& expected) {
    REQUIRE(found.size() == expected.size());
    for (const auto& [receiver, share] : expected) {
        INFO("receiver " << receiver);
        REQUIRE(found.contains(receiver));
        CHECK(found.at(receiver) == Approx(share).epsilon(1e-14));
    }
}

/// Every node with data once, all receivers before their donors (so that there are no loops), shares of 1.
template <Topology T>
void check_flow(const T& topology, std::span<const double> z, const FlowDirections& single, const MultipleFlow& flow) {
    REQUIRE(flow.size() == topology.size());
    std::vector<int> placed(topology.size(), 0);
    for (const Index node : flow.order) {
        REQUIRE(!std::isnan(z[node]));
        REQUIRE(placed[node] == 0);
        placed[node] = 1;
        double sum = 0;
        Index count = 0;
        flow.receivers(node, [&](Index receiver, double length_m, double share) {
            REQUIRE(placed[receiver] == 1);
            REQUIRE(share >= 0);
            double expected = 0;
            topology.neighbors(node, [&](Index neighbor, double length, Slot) {
                if (neighbor == receiver) expected = length;
            });
            REQUIRE(length_m == expected);
            sum += share;
            ++count;
        });
        REQUIRE((count == 0) == (single[node] == no_flow));
        if (count > 0) REQUIRE(sum == Approx(1).epsilon(1e-14));
    }
    for (Index node = 0; node < topology.size(); ++node) REQUIRE(placed[node] == !std::isnan(z[node]));
}

/// Off the lakes all lower neighbours are receivers, in lakes the single direction is the only one.
template <Topology T>
void check_receivers(const T& topology, std::span<const double> z, std::span<const double> filled,
                     const FlowDirections& single, const MultipleFlow& flow) {
    for (Index node = 0; node < topology.size(); ++node) {
        if (std::isnan(z[node]) || single[node] == no_flow) continue;
        std::vector<Index> expected;
        topology.neighbors(node, [&](Index neighbor, double, Slot) {
            const bool under_water = z[node] < filled[node];
            if (!under_water && filled[neighbor] < filled[node]) expected.push_back(neighbor);
        });
        if (expected.empty()) expected.push_back(topology.neighbor(node, single[node]));
        std::vector<Index> found;
        flow.receivers(node, [&](Index receiver, double, double) { found.push_back(receiver); });
        std::sort(found.begin(), found.end());
        std::sort(expected.begin(), expected.end());
        REQUIRE(found == expected);
    }
}

/// Standard deviation over mean of the drainage area at distances from 0.6 to 0.9 of the radius of a cone, each area
/// divided by its distance, to which it is proportional.
double unevenness_on_cone(const TestTerrain& cone, const std::vector<double>& area) {
    const double middle = 0.5 * (cone.grid.rows - 1);
    double count = 0, sum = 0, squares = 0;
    for (Index node = 0; node < cone.grid.size(); ++node) {
        const double distance = std::hypot(cone.grid.row(node) - middle, cone.grid.col(node) - middle);
        if (distance < 0.6 * middle || distance > 0.9 * middle) continue;
        const double specific = area[node] / distance;
        ++count;
        sum += specific;
        squares += specific * specific;
    }
    const double mean = sum / count;
    return std::sqrt(squares / count - mean * mean) / mean;
}

}  // namespace

TEST_CASE("shares on a drawn cell are those of the slopes' powers") {
    // Cells of 3 m by 4 m: slopes 6/3 to the east, 10/5 to the south-east, 4/4 to the south.
    const Drawing d = draw(R"(
        99 99 99
        99 10  4
        99  6  0)");
    const Grid grid = plane_grid(3, 3, 3, 4);
    FlowDirections single(9, no_flow);
    single[4] = 0;
    SECTION("Freeman") {
        const double sum = 2 + std::pow(0.5, 1.1);
        check_shares(shares_of(multiple_flow(grid, d.values, single), 4),
                     {{5, 1 / sum}, {7, std::pow(0.5, 1.1) / sum}, {8, 1 / sum}});
    }
    SECTION("Holmgren") {
        check_shares(shares_of(multiple_flow(grid, d.values, single, {.exponent = 4}), 4),
                     {{5, 16 / 33.0}, {7, 1 / 33.0}, {8, 16 / 33.0}});
    }
    SECTION("Quinn: contour lengths of 2, 1.2 and 1.5 m") {
        const Division quinn{.exponent = 1, .contour = Division::Contour::quinn};
        check_shares(shares_of(multiple_flow(grid, d.values, single, quinn), 4),
                     {{5, 4 / 7.9}, {7, 1.5 / 7.9}, {8, 2.4 / 7.9}});
    }
}

TEST_CASE("powers are those of the library to rounding, from gentle to steep") {
    const Grid grid = plane_grid(1, 3, 1, 1);
    const FlowDirections single{no_flow, 0, no_flow};
    Random random(5, 1);
    for (int i = 0; i < 20000; ++i) {
        const double ratio = std::pow(10, -12 * random.uniform() * random.uniform());
        const double exponent = std::pow(10, -1 + 2.5 * random.uniform());
        const std::vector<double> z{1 - ratio, 1, 0};
        const double expected = std::pow(1 - z[0], exponent);
        const Shares shares = shares_of(multiple_flow(grid, z, single, {.exponent = exponent}), 1);
        CAPTURE(ratio, exponent);
        const double tolerance = 4e-15 + 4e-16 * exponent * std::abs(std::log2(ratio));
        if (expected < 1e-290) continue;
        REQUIRE(shares.at(0) == Approx(expected / (1 + expected)).epsilon(tolerance));
    }
}

TEST_CASE("a drawn lake is led over its pass, and no dry cell sends water back") {
    // The pit (1) fills to the pass (5); beyond it water divides again. Cell 3 (height 5) is the pass: it has lower
    // cells on both sides.
    const Drawing d = draw(R"(
        9 9 9 9 9 9
        8 1 3 5 4 0
        9 9 9 9 2 9)");
    const Grid grid = plane_grid(3, 6, 1, 1);
    std::vector<Boundary> boundary(18, Boundary::interior);
    boundary[11] = Boundary::base_level;
    const FlowDirections single = single_flow(grid, d.values, boundary);
    const MultipleFlow flow = multiple_flow(grid, d.values, single, {.exponent = 1});
    CHECK(shares_of(flow, 7) == Shares{{8, 1}});
    CHECK(shares_of(flow, 8) == Shares{{9, 1}});
    check_shares(shares_of(flow, 9), {{10, 1 / (1 + 3 / std::sqrt(2.0))}, {16, 1 - 1 / (1 + 3 / std::sqrt(2.0))}});
    CHECK(shares_of(flow, 10).size() == 2);
    CHECK(shares_of(flow, 16) == Shares{{11, 1}});
    const std::vector<double> area = accumulate(flow, cell_areas(grid));
    CHECK(area[11] == Approx(18).epsilon(1e-15));
}

TEST_CASE("on any terrain flow divides among all lower neighbours, without loops, and lakes follow the single way") {
    for (std::uint64_t seed = 1; seed <= 60; ++seed) {
        for (const TestTerrain& terrain : assorted_terrains(seed)) {
            INFO(terrain.name << " " << terrain.grid.rows << " x " << terrain.grid.cols);
            const auto check = [&](const auto& topology) {
                const std::vector<double>& z = terrain.elevation_m;
                const auto boundary = data_edge(terrain.grid, z);
                const FlowDirections single = single_flow(topology, z, boundary);
                const MultipleFlow flow = multiple_flow(topology, z, single);
                check_flow(topology, z, single, flow);
                const std::vector<double> filled = fill(topology, z, boundary);
                check_receivers(topology, z, filled, single, flow);
                const auto level = water_level(topology, z, single, downstream_first_order(topology, z, single));
                for (Index node = 0; node < topology.size(); ++node) {
                    if (!std::isnan(z[node])) REQUIRE(level[node] == filled[node]);
                }
            };
            check(terrain.grid);
            check(mesh_of(terrain.grid));
        }
    }
    for (const TestTerrain& terrain : shaped_terrains()) {
        INFO(terrain.name);
        const FlowDirections single =
            single_flow(terrain.grid, terrain.elevation_m, data_edge(terrain.grid, terrain.elevation_m));
        check_flow(terrain.grid, terrain.elevation_m, single, multiple_flow(terrain.grid, terrain.elevation_m, single));
    }
}

TEST_CASE("there are no loops whatever single directions flow is given, downhill or not") {
    for (std::uint64_t seed = 1; seed <= 60; ++seed) {
        const TestTerrain terrain = stepped_terrain(9, 8, 6, seed);
        const FlowDirections single =  // of another terrain
            single_flow(terrain.grid, noise_terrain(9, 8, seed).elevation_m,
                        data_edge(terrain.grid, terrain.elevation_m));
        check_flow(terrain.grid, terrain.elevation_m, single, multiple_flow(terrain.grid, terrain.elevation_m, single));
        check_flow(terrain.grid, terrain.elevation_m, single, d_infinity(terrain.grid, terrain.elevation_m, single));
    }
}

TEST_CASE("flats that were resolved keep their single directions, and all else divides") {
    for (std::uint64_t seed = 1; seed <= 40; ++seed) {
        const TestTerrain terrain = with_holes(stepped_terrain(14, 13, 4, seed), 0.05, seed);
        const auto boundary = data_edge(terrain.grid, terrain.elevation_m);
        const std::vector<double> filled = fill(terrain.grid, terrain.elevation_m, boundary);
        FlowDirections single = route(terrain.grid, filled, boundary);
        resolve_flats(terrain.grid, filled, boundary, single);
        const MultipleFlow flow = multiple_flow(terrain.grid, filled, single);
        check_flow(terrain.grid, filled, single, flow);
        check_receivers(terrain.grid, filled, filled, single, flow);
    }
}

TEST_CASE("accumulated area solves the linear equations of divided flow") {
    for (std::uint64_t seed = 1; seed <= 25; ++seed) {
        for (const TestTerrain& terrain : assorted_terrains(seed)) {
            INFO(terrain.name << " " << terrain.grid.rows << " x " << terrain.grid.cols);
            const MultipleFlow flow = divided(terrain.grid, terrain.elevation_m);
            Random random(seed, 9);
            std::vector<double> amount(terrain.grid.size());
            for (Index node = 0; node < terrain.grid.size(); ++node) {
                amount[node] = std::isnan(terrain.elevation_m[node]) ? 0.0 : random.uniform();
            }
            const std::vector<double> expected = accumulate_by_elimination(flow, amount);
            const std::vector<double> found = accumulate(flow, amount);
            for (Index node = 0; node < terrain.grid.size(); ++node) {
                REQUIRE(found[node] == Approx(expected[node]).epsilon(1e-12));
            }
        }
    }
}

TEST_CASE("all water arrives at the outlets, with lakes, voids and rows of any width") {
    const TestTerrain terrain{"", uneven_grid(70, 90), with_holes(noise_terrain(70, 90, 4), 0.05, 4).elevation_m};
    const MultipleFlow flow = divided(terrain.grid, terrain.elevation_m);
    const std::vector<double> area = accumulate(flow, cell_areas(terrain.grid));
    double leaving = 0, total = 0;
    for (Index node = 0; node < terrain.grid.size(); ++node) {
        if (std::isnan(terrain.elevation_m[node])) {
            CHECK(area[node] == 0);
            continue;
        }
        total += terrain.grid.area(node);
        if (flow.offset[node] == flow.offset[node + 1]) leaving += area[node];
    }
    CHECK(leaving == Approx(total).epsilon(1e-13));
}

TEST_CASE("a large exponent sends nearly everything the steepest way") {
    for (std::uint64_t seed = 1; seed <= 10; ++seed) {
        const TestTerrain terrain = noise_terrain(25, 25, seed);
        const std::vector<double>& z = terrain.elevation_m;
        const FlowDirections single = single_flow(terrain.grid, z, data_edge(terrain.grid, z));
        const MultipleFlow flow = multiple_flow(terrain.grid, z, single, {.exponent = 3000});
        for (const Index node : flow.order) {
            if (flow.offset[node + 1] - flow.offset[node] < 2) continue;
            double steepest = 0;
            flow.receivers(node, [&](Index receiver, double length_m, double) {
                steepest = std::max(steepest, (z[node] - z[receiver]) / length_m);
            });
            double gentler = 0;
            flow.receivers(node, [&](Index receiver, double length_m, double share) {
                if ((z[node] - z[receiver]) / length_m < 0.99 * steepest) gentler += share;
            });
            REQUIRE(gentler < 1e-12);  // 0.99^3000 = 8e-14
        }
    }
}

TEST_CASE(
    "on a plane divided flow goes down the plane's direction on average, one direction up to 22 degrees beside it") {
    double d8 = 0, freeman = 0, infinity = 0;
    for (int degree = 0; degree < 360; ++degree) {
        const double direction = degree * std::numbers::pi / 180;
        const TestTerrain t = terrain_of(
            "plane", 3, 3, [=](Index r, Index c) { return std::sin(direction) * r - std::cos(direction) * c; });
        const FlowDirections single = single_flow(t.grid, t.elevation_m, data_edge(t.grid, t.elevation_m));
        const auto off = [&](const MultipleFlow& flow) {
            double x = 0, y = 0;
            flow.receivers(4, [&](Index receiver, double, double share) {
                x += share * (static_cast<double>(receiver % 3) - 1);
                y -= share * (static_cast<double>(receiver / 3) - 1);
            });
            return std::abs(std::remainder(std::atan2(y, x) - direction, 2 * std::numbers::pi)) * 180 /
                   std::numbers::pi;
        };
        d8 = std::max(d8, off(multiple_flow(t.grid, t.elevation_m, single, {.exponent = 1e5})));
        freeman = std::max(freeman, off(multiple_flow(t.grid, t.elevation_m, single)));
        infinity = std::max(infinity, off(d_infinity(t.grid, t.elevation_m, single)));
    }
    CAPTURE(d8, freeman, infinity);
    CHECK(d8 == Approx(22).margin(0.6));
    CHECK(freeman < 3);
    CHECK(infinity < 4.2);  // the share grows with the angle, the way with its tangent
}

TEST_CASE("on a cone the area of divided flow is far more even than that of one direction") {
    const TestTerrain hill = cone(101, 101);
    const auto boundary = data_edge(hill.grid, hill.elevation_m);
    const FlowDirections single = single_flow(hill.grid, hill.elevation_m, boundary);
    const auto areas = cell_areas(hill.grid);
    const double d8 = unevenness_on_cone(hill, accumulate(flow_graph(hill.grid, hill.elevation_m, single), areas));
    const double freeman =
        unevenness_on_cone(hill, accumulate(multiple_flow(hill.grid, hill.elevation_m, single), areas));
    const double infinity =
        unevenness_on_cone(hill, accumulate(d_infinity(hill.grid, hill.elevation_m, single), areas));
    CAPTURE(d8, freeman, infinity);
    CHECK(d8 > 0.5);
    CHECK(freeman < 0.02);
    CHECK(infinity < 0.1);
}

TEST_CASE("grid and mesh of the same cells divide alike") {
    const TestTerrain terrain{"", uneven_grid(30, 20), noise_terrain(30, 20, 8).elevation_m};
    const auto boundary = data_edge(terrain.grid, terrain.elevation_m);
    const Mesh mesh = mesh_of(terrain.grid);
    const FlowDirections on_grid = single_flow(terrain.grid, terrain.elevation_m, boundary);
    const FlowDirections on_mesh = single_flow(mesh, terrain.elevation_m, boundary);
    const Division division{.exponent = 2.5, .contour = Division::Contour::quinn};
    const MultipleFlow a = multiple_flow(terrain.grid, terrain.elevation_m, on_grid, division);
    const MultipleFlow b = multiple_flow(mesh, terrain.elevation_m, on_mesh, division);
    for (Index node = 0; node < mesh.size(); ++node) check_shares(shares_of(b, node), shares_of(a, node));
}

TEST_CASE("divided flow and its area are the same bytes on one thread and on two") {
    const TestTerrain terrain = with_holes(noise_terrain(301, 257, 21), 0.01, 2);
    const Mesh mesh = lattice_mesh(150, 150, 10, 0.3, 4);
    const std::vector<double> heights = noise_terrain(150, 150, 3).elevation_m;
    const auto with_threads = [&](int threads) {
        const ThreadLimit limit(threads);
        const auto& z = terrain.elevation_m;
        const FlowDirections single = single_flow(terrain.grid, z, data_edge(terrain.grid, z));
        const MultipleFlow a = multiple_flow(terrain.grid, z, single);
        const MultipleFlow b = d_infinity(terrain.grid, z, single);
        std::vector<Boundary> boundary(mesh.size(), Boundary::interior);
        boundary[7] = Boundary::base_level;
        const MultipleFlow c = multiple_flow(mesh, heights, single_flow(mesh, heights, boundary));
        return std::tuple(a.receiver, a.share, a.order, accumulate(a, cell_areas(terrain.grid)), b.receiver, b.share,
                          b.order, c.share, c.order);
    };
    CHECK(with_threads(1) == with_threads(2));
}

TEST_CASE("areas added up while the flow is laid out are those of accumulating afterwards") {
    const TestTerrain terrain{"", uneven_grid(30, 40), with_holes(noise_terrain(30, 40, 4), 0.05, 4).elevation_m};
    const std::vector<double>& z = terrain.elevation_m;
    const FlowDirections single = single_flow(terrain.grid, z, data_edge(terrain.grid, z));
    const std::vector<double> areas = cell_areas(terrain.grid);
    std::vector<double> upstream = areas;
    MultipleFlow flow;
    multiple_flow(terrain.grid, z, single, {}, flow, upstream);
    const std::vector<double> expected = accumulate(flow, areas);
    for (Index node = 0; node < terrain.grid.size(); ++node) {
        CHECK(upstream[node] == Approx(expected[node]).epsilon(1e-14));
    }
    upstream.pop_back();
    CHECK_THROWS_AS(multiple_flow(terrain.grid, z, single, {}, flow, upstream), Error);
}

TEST_CASE("memory that is used again holds nothing of what was there") {
    const TestTerrain first = noise_terrain(40, 30, 1), second = noise_terrain(20, 25, 2);
    MultipleFlow flow = divided(first.grid, first.elevation_m);
    multiple_flow(second.grid, second.elevation_m,
                  single_flow(second.grid, second.elevation_m, data_edge(second.grid, second.elevation_m)), {}, flow);
    const MultipleFlow fresh = divided(second.grid, second.elevation_m);
    CHECK(flow.offset == fresh.offset);
    CHECK(flow.receiver == fresh.receiver);
    CHECK(flow.length == fresh.length);
    CHECK(flow.share == fresh.share);
    CHECK(flow.order == fresh.order);
}

TEST_CASE("exponents that are no positive numbers and sizes that do not fit are refused") {
    const Grid grid = plane_grid(2, 2, 1, 1);
    const std::vector<double> z{3, 2, 1, 0};
    const FlowDirections single(4, no_flow);
    CHECK_THROWS_AS(multiple_flow(grid, z, single, {.exponent = 0}), Error);
    CHECK_THROWS_AS(multiple_flow(grid, z, single, {.exponent = std::nan("")}), Error);
    CHECK_THROWS_AS(multiple_flow(grid, z, FlowDirections(3), {}), Error);
    CHECK_THROWS_AS(d_infinity(grid, z, FlowDirections(3)), Error);
    CHECK_THROWS_AS(accumulate(multiple_flow(grid, z, single), std::vector<double>(3)), Error);
}
