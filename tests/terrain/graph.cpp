// SPDX-License-Identifier: GPL-3.0-or-later
#include "thalweg/terrain/graph.hpp"

#include <catch2/catch.hpp>

#include "support/drawing.hpp"
#include "support/terrain_oracles.hpp"
#include "support/terrains.hpp"
#include "thalweg/core/error.hpp"
#include "thalweg/core/parallel.hpp"
#include "thalweg/terrain/accumulate.hpp"
#include "thalweg/terrain/lakes.hpp"

using namespace thalweg;
using namespace thalweg::terrain;
using namespace thalweg::support;

namespace {

template <Topology T>
FlowDirections drained_directions(const T& topology, std::span<const double> z, std::span<const Boundary> boundary) {
    FlowDirections directions = route(topology, z, boundary);
    drain_lakes(topology, z, boundary, directions);
    return directions;
}

/// Every node with data once, receivers before donors.
template <Topology T>
void check_order(const T& topology, std::span<const double> z, const FlowDirections& directions,
                 const std::vector<Index>& order) {
    std::vector<int> placed(topology.size(), 0);
    for (const Index node : order) {
        REQUIRE(node < topology.size());
        REQUIRE(!std::isnan(z[node]));
        REQUIRE(placed[node] == 0);
        placed[node] = 1;
        if (directions[node] != no_flow) REQUIRE(placed[topology.neighbor(node, directions[node])] == 1);
    }
    for (Index node = 0; node < topology.size(); ++node) REQUIRE(placed[node] == !std::isnan(z[node]));
}

}  // namespace

TEST_CASE("a drawn network becomes receivers, lengths and an order") {
    const Grid grid = plane_grid(2, 3, 3, 4);
    const std::vector<double> z{5, 4, 3, nodata, 2, 1};
    const FlowDirections directions = draw_directions(R"(
        1 v v
        . > .)");
    const FlowGraph graph = flow_graph(grid, z, directions);
    CHECK(graph.receiver == std::vector<Index>{4, 4, 5, none, 5, none});
    CHECK(graph.length == std::vector<double>{5, 4, 4, 0, 3, 0});
    CHECK(graph.order.size() == 5);
    check_order(grid, z, directions, graph.order);
    CHECK(downstream_first_order(grid, z, directions) == graph.order);
}

TEST_CASE("on any terrain receivers come before donors, every node with data once") {
    for (std::uint64_t seed = 1; seed <= 40; ++seed) {
        for (const TestTerrain& terrain : assorted_terrains(seed)) {
            INFO(terrain.name << " " << terrain.grid.rows << " x " << terrain.grid.cols);
            const std::vector<double>& z = terrain.elevation_m;
            const auto boundary = data_edge(terrain.grid, z);
            const FlowDirections directions = drained_directions(terrain.grid, z, boundary);
            check_order(terrain.grid, z, directions, downstream_first_order(terrain.grid, z, directions));
            const Mesh mesh = mesh_of(terrain.grid);
            const FlowDirections of_mesh = drained_directions(mesh, z, boundary);
            check_order(mesh, z, of_mesh, downstream_first_order(mesh, z, of_mesh));
        }
    }
}

TEST_CASE("planes that fall to any side are ordered, also where all is placed before the last nodes are looked at") {
    for (const Index rows : {100U, 700U}) {  // one block and several
        const Grid grid = plane_grid(rows, 200, 1, 1);
        for (const auto& [east, south] : {std::pair{0, 1}, {0, -1}, {1, 0}, {-1, 0}, {1, 1}, {-1, -1}}) {
            INFO(rows << " rows, rising by " << east << " east, " << south << " south");
            std::vector<double> z(grid.size());
            for (Index node = 0; node < grid.size(); ++node) {
                z[node] = east * static_cast<double>(grid.col(node)) + south * static_cast<double>(grid.row(node));
            }
            const FlowDirections directions = route(grid, z, data_edge(grid, z));
            check_order(grid, z, directions, downstream_first_order(grid, z, directions));
        }
    }
}

TEST_CASE("a river as long as the grid is ordered without recursion") {
    const Index cols = 3'000'000;
    const Grid grid = plane_grid(1, cols, 1, 1);
    std::vector<double> z(cols);
    for (Index c = 0; c < cols; ++c) z[c] = c;
    const FlowGraph graph = flow_graph(grid, z, route(grid, z, data_edge(grid, z)));
    CHECK(graph.order.front() == 0);
    CHECK(graph.order.back() == cols - 1);
    CHECK(accumulate(graph, std::vector<double>(cols, 1.0))[0] == cols);
}

TEST_CASE("drawn areas add up down the rivers") {
    const Grid grid = plane_grid(3, 3, 10, 10);
    const std::vector<double> z{9, 8, 7, 6, 5, 4, nodata, 3, 2};
    const FlowGraph graph = flow_graph(grid, z, draw_directions(R"(
        1 v v
        > v 3
        . > .)"));
    CHECK(accumulate(graph, cell_areas(grid)) == std::vector<double>{100, 100, 100, 100, 400, 200, 0, 700, 800});
}

TEST_CASE("accumulated area is what walking down from every cell counts") {
    for (std::uint64_t seed = 1; seed <= 40; ++seed) {
        for (const TestTerrain& terrain : assorted_terrains(seed)) {
            INFO(terrain.name << " " << terrain.grid.rows << " x " << terrain.grid.cols);
            const std::vector<double>& z = terrain.elevation_m;
            const FlowDirections directions = drained_directions(terrain.grid, z, data_edge(terrain.grid, z));
            const FlowGraph graph = flow_graph(terrain.grid, z, directions);
            Random random(seed, 9);
            std::vector<double> whole(terrain.grid.size());
            for (double& amount : whole) amount = random.below(1000);
            CHECK(accumulate(graph, whole) == accumulate_by_walking(terrain.grid, z, directions, whole));
        }
    }
}

TEST_CASE("area at the outlets is the area of the cells with data, rows of any width") {
    const TestTerrain terrain{"", uneven_grid(60, 70), with_holes(noise_terrain(60, 70, 4), 0.05, 4).elevation_m};
    const std::vector<double>& z = terrain.elevation_m;
    const FlowGraph graph =
        flow_graph(terrain.grid, z, drained_directions(terrain.grid, z, data_edge(terrain.grid, z)));
    const std::vector<double> area = accumulate(graph, cell_areas(terrain.grid));
    double leaving = 0, total = 0;
    for (Index node = 0; node < terrain.grid.size(); ++node) {
        if (std::isnan(z[node])) {
            CHECK(area[node] == 0);
            continue;
        }
        total += terrain.grid.area(node);
        if (graph.receiver[node] == none) leaving += area[node];
    }
    CHECK(leaving == Approx(total).epsilon(1e-13));
}

TEST_CASE("cell areas are those of the grid's rows and of the mesh") {
    const Grid grid = uneven_grid(3, 2);
    const std::vector<double> areas{600, 600, 595, 595, 590, 590};
    CHECK(cell_areas(grid) == areas);
    CHECK(cell_areas(mesh_of(grid)) == areas);
}

TEST_CASE("carving cuts what stands in the way of lower water and touches nothing else") {
    const Drawing drawing = draw("9 3 6 2 1 7 4 0");
    const Grid grid = plane_grid(1, 8, 1, 1);
    const FlowGraph graph = flow_graph(grid, drawing.values, draw_directions("> > > > > > > ."));
    CHECK(carve(graph, drawing.values) == std::vector<double>{9, 3, 3, 2, 1, 1, 1, 0});
}

TEST_CASE("the carved surface is the lowest height upstream, and falls along every path") {
    for (std::uint64_t seed = 1; seed <= 20; ++seed) {
        for (const TestTerrain& terrain : assorted_terrains(seed)) {
            const std::vector<double>& z = terrain.elevation_m;
            const FlowDirections directions = drained_directions(terrain.grid, z, data_edge(terrain.grid, z));
            const FlowGraph graph = flow_graph(terrain.grid, z, directions);
            const std::vector<double> carved = carve(graph, z);
            std::vector<double> lowest = z;
            for (Index start = 0; start < terrain.grid.size(); ++start) {
                for (Index node = start; directions[node] != no_flow;) {
                    node = terrain.grid.neighbor(node, directions[node]);
                    lowest[node] = std::min(lowest[node], z[start]);
                }
            }
            for (Index node = 0; node < terrain.grid.size(); ++node) {
                REQUIRE(std::isnan(carved[node]) == std::isnan(z[node]));
                if (!std::isnan(z[node])) REQUIRE(carved[node] == lowest[node]);
            }
        }
    }
}

TEST_CASE("the largest value upstream is what walking down from every cell finds") {
    for (std::uint64_t seed = 1; seed <= 20; ++seed) {
        for (const TestTerrain& terrain : assorted_terrains(seed)) {
            const std::vector<double>& z = terrain.elevation_m;
            const FlowDirections directions = drained_directions(terrain.grid, z, data_edge(terrain.grid, z));
            const std::vector<double> values = noise_terrain(terrain.grid.rows, terrain.grid.cols, 77).elevation_m;
            std::vector<double> largest = values;
            for (Index start = 0; start < terrain.grid.size(); ++start) {
                for (Index node = start; directions[node] != no_flow;) {
                    node = terrain.grid.neighbor(node, directions[node]);
                    largest[node] = std::max(largest[node], values[start]);
                }
            }
            REQUIRE(largest_upstream(flow_graph(terrain.grid, z, directions), values) == largest);
        }
    }
}

TEST_CASE("graph, area and carved surface are the same bytes on one thread and on two") {
    const TestTerrain terrain = noise_terrain(300, 300, 21);
    const auto boundary = data_edge(terrain.grid, terrain.elevation_m);
    const auto with_threads = [&](int threads) {
        const ThreadLimit limit(threads);
        const FlowDirections directions = drained_directions(terrain.grid, terrain.elevation_m, boundary);
        const FlowGraph graph = flow_graph(terrain.grid, terrain.elevation_m, directions);
        return std::tuple(graph.receiver, graph.length, graph.order, accumulate(graph, terrain.elevation_m),
                          carve(graph, terrain.elevation_m));
    };
    CHECK(with_threads(1) == with_threads(2));
}

TEST_CASE("areas added while the order is found are those added along the order, bit for bit") {
    for (const TestTerrain& terrain : shaped_terrains()) {
        Grid grid = terrain.grid;
        for (Index row = 0; row < grid.rows; ++row) grid.cell_area[row] *= 1 + 1e-3 * row;  // sums that round
        const auto boundary = data_edge(grid, terrain.elevation_m);
        const FlowDirections directions = drained_directions(grid, terrain.elevation_m, boundary);
        const FlowGraph graph = flow_graph(grid, terrain.elevation_m, directions);
        const GraphAndArea both = graph_and_area(grid, terrain.elevation_m, directions);
        CHECK(both.drainage_area_m2 == accumulate(graph, cell_areas(grid)));
        CHECK(both.graph.order == graph.order);
        CHECK(both.graph.receiver == graph.receiver);
    }
}

TEST_CASE("a grid's receivers and lengths are those of its directions, with rows alike or not") {
    for (const double growth : {0.0, 0.01}) {
        Grid grid = plane_grid(7, 5, 3, 4);
        for (Index row = 0; row < grid.rows; ++row) grid.east_west[row] *= 1 + growth * row;
        for (Index gap = 0; gap + 1 < grid.rows; ++gap) {
            grid.north_south[gap] *= 1 + 2 * growth * gap;
            grid.diagonal[gap] *= 1 + 3 * growth * gap;
        }
        const std::vector<double> z(grid.size(), 0);
        for (Slot slot = 0; slot < 8; ++slot) {
            FlowDirections directions(grid.size(), no_flow);
            for (Index node = 0; node < grid.size(); ++node) {
                grid.neighbors(node, [&](Index, double, Slot s) {
                    if (s == slot) directions[node] = slot;
                });
            }
            const FlowGraph graph = flow_graph(grid, z, directions);
            for (Index node = 0; node < grid.size(); ++node) {
                const bool flows = directions[node] != no_flow;
                CHECK(graph.receiver[node] == (flows ? grid.neighbor(node, slot) : none));
                CHECK(graph.length[node] == (flows ? grid.length(node, slot) : 0));
            }
            CHECK(graph.receiver.directions() == directions);
        }
    }
}

TEST_CASE("amounts of the wrong number are refused") {
    const Grid grid = plane_grid(2, 2, 1, 1);
    const FlowGraph graph = flow_graph(grid, std::vector<double>(4, 0), FlowDirections(4, no_flow));
    CHECK_THROWS_AS(accumulate(graph, std::vector<double>(3)), Error);
    CHECK_THROWS_AS(carve(graph, std::vector<double>(5)), Error);
    CHECK_THROWS_AS(flow_graph(grid, std::vector<double>(4), FlowDirections(3)), Error);
}
