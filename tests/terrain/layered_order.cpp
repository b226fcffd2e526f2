// SPDX-License-Identifier: GPL-3.0-or-later
// Orders, areas, lakes and flats on terrains large enough to be cut into blocks.
#include <algorithm>
#include <catch2/catch.hpp>

#include "support/terrain_oracles.hpp"
#include "support/terrains.hpp"
#include "thalweg/core/parallel.hpp"
#include "thalweg/core/random.hpp"
#include "thalweg/terrain/accumulate.hpp"
#include "thalweg/terrain/flats.hpp"
#include "thalweg/terrain/lakes.hpp"
#include "thalweg/terrain/route.hpp"

using namespace thalweg;
using namespace thalweg::terrain;
using namespace thalweg::support;

namespace {

/// Tens of thousands of nodes and more, in shapes that cut differently.
std::vector<TestTerrain> large_terrains() {
    return {noise_terrain(400, 500, 1),
            with_holes(stepped_terrain(300, 701, 6, 2), 0.05, 2),
            bowl_of_bowls(411, 420),
            comb(500, 401),
            noise_terrain(1, 200000, 3),
            noise_terrain(200000, 1, 4),
            with_holes(noise_terrain(2, 150000, 5), 0.01, 5),
            {"noise on uneven cells", uneven_grid(90, 3000), noise_terrain(90, 3000, 6).elevation_m}};
}

template <Topology T>
FlowDirections drained_directions(const T& topology, const std::vector<double>& z,
                                  const std::vector<Boundary>& boundary) {
    FlowDirections directions = route(topology, z, boundary);
    drain_lakes(topology, z, boundary, directions);
    return directions;
}

/// Every node with data once, after its receiver; no node of a layer flows to another of it; no part but the first is
/// flowed to from another.
void check_order(const FlowGraph& graph, std::span<const double> z) {
    const FlowLayers& layers = graph.layers;
    REQUIRE(layers.part.size() > 2);
    REQUIRE(layers.begin.back() == graph.order.size());
    std::vector<Index> layer_of(graph.size(), none), part_of(graph.size(), none);
    for (Index part = 0; part + 1 < layers.part.size(); ++part) {
        for (Index layer = layers.part[part]; layer < layers.part[part + 1]; ++layer) {
            REQUIRE(layers.begin[layer] < layers.begin[layer + 1]);
            for (Index at = layers.begin[layer]; at < layers.begin[layer + 1]; ++at) {
                REQUIRE(layer_of[graph.order[at]] == none);
                layer_of[graph.order[at]] = layer;
                part_of[graph.order[at]] = part;
            }
        }
    }
    bool right = true;
    for (Index node = 0; node < graph.size(); ++node) {
        right = right && (layer_of[node] == none) == std::isnan(z[node]);
        const Index receiver = graph.receiver[node];
        if (receiver == none) continue;
        right = right && layer_of[receiver] < layer_of[node];
        right = right && (part_of[receiver] == part_of[node] || part_of[receiver] == 0);
    }
    CHECK(right);
}

/// The sum over each node and all upstream of it, pushed down the order one by one.
std::vector<double> accumulate_plainly(const FlowGraph& graph, std::vector<double> sum) {
    for (std::size_t at = graph.order.size(); at-- > 0;) {
        const Index node = graph.order[at];
        if (graph.receiver[node] != none) sum[graph.receiver[node]] += sum[node];
    }
    return sum;
}

template <Topology T>
void check_large(const T& topology, const std::vector<double>& z, const std::vector<Boundary>& boundary) {
    const FlowDirections directions = drained_directions(topology, z, boundary);
    const FlowGraph graph = flow_graph(topology, z, directions);
    check_order(graph, z);
    std::vector<double> whole(topology.size(), 0.0);
    for (Index node = 0; node < topology.size(); ++node) whole[node] = std::isnan(z[node]) ? 0 : 1 + node % 7;
    CHECK(accumulate(graph, whole) == accumulate_plainly(graph, whole));  // whole numbers: the order of adding is free
}

}  // namespace

TEST_CASE("In large terrains the order is one of layers and parts, and sums along it are exact") {
    for (const TestTerrain& terrain : large_terrains()) {
        INFO(terrain.name << " " << terrain.grid.rows << " x " << terrain.grid.cols);
        const auto boundary = data_edge(terrain.grid, terrain.elevation_m);
        check_large(terrain.grid, terrain.elevation_m, boundary);
        check_large(mesh_of(terrain.grid), terrain.elevation_m, boundary);
    }
}

TEST_CASE("In large terrains the filled surface is that of a priority flood: random, bowls in bowls, a comb") {
    for (const TestTerrain& terrain : large_terrains()) {
        INFO(terrain.name << " " << terrain.grid.rows << " x " << terrain.grid.cols);
        std::vector<Boundary> one_outlet(terrain.grid.size(), Boundary::interior);
        one_outlet[terrain.grid.size() / 3] = Boundary::open;
        for (const auto& boundary : {data_edge(terrain.grid, terrain.elevation_m), one_outlet}) {
            const std::vector<double> filled = fill(terrain.grid, terrain.elevation_m, boundary);
            const std::vector<double> flooded = fill_by_priority_flood(terrain.grid, terrain.elevation_m, boundary);
            Index different = 0;
            for (Index node = 0; node < filled.size(); ++node) {
                different += filled[node] != flooded[node] && !std::isnan(filled[node]);
            }
            CHECK(different == 0);
        }
    }
}

TEST_CASE("Order, areas, lakes, filling and flats are the same bytes on 1, 2, 3 and 7 threads") {
    for (const TestTerrain& terrain : large_terrains()) {
        INFO(terrain.name << " " << terrain.grid.rows << " x " << terrain.grid.cols);
        const std::vector<double>& z = terrain.elevation_m;
        const auto boundary = data_edge(terrain.grid, z);
        std::vector<double> amount = cell_areas(terrain.grid);
        for (Index node = 0; node < amount.size(); ++node) amount[node] *= 0.1 + node % 13;
        const auto with_threads = [&](int threads) {
            const ThreadLimit limit(threads);
            const FlowGraph lakes = flow_graph(terrain.grid, z, drained_directions(terrain.grid, z, boundary));
            std::vector<double> level = fill(terrain.grid, z, boundary);
            FlowDirections directions = route(terrain.grid, level, boundary);
            const Index resolved = resolve_flats(terrain.grid, level, boundary, directions);
            std::replace_if(
                level.begin(), level.end(), [](double height) { return std::isnan(height); }, -1);
            return std::tuple(lakes.order, lakes.layers.begin, accumulate(lakes, amount), level, directions, resolved);
        };
        const auto once = with_threads(1);
        for (const int threads : {2, 3, 7}) CHECK((with_threads(threads) == once));
    }
}

TEST_CASE("A flat that crosses the borders of blocks is resolved as one") {
    // One flat over all but the rim, with one way out in a corner: every cell must flow, and the way must be shortest.
    const Index rows = 500, cols = 400;
    std::vector<double> z(std::size_t{rows} * cols, 5);
    for (Index c = 0; c < cols; ++c) z[c] = z[std::size_t{rows - 1} * cols + c] = 9;
    for (Index r = 0; r < rows; ++r) z[std::size_t{r} * cols] = z[std::size_t{r} * cols + cols - 1] = 9;
    z[cols + 1] = 4;
    const Grid grid = plane_grid(rows, cols, 1, 1);
    std::vector<Boundary> boundary(grid.size(), Boundary::interior);
    boundary[cols + 1] = Boundary::base_level;
    FlowDirections directions = route(grid, z, boundary);
    const auto stuck = std::count(directions.begin(), directions.end(), no_flow);
    CHECK(resolve_flats(grid, z, boundary, directions) == static_cast<Index>(stuck) - 1);
    CHECK(std::count(directions.begin(), directions.end(), no_flow) == 1);
    const Index start = (rows - 2) * cols + cols - 2;
    Index steps = 0;
    for (Index node = start; directions[node] != no_flow; node = grid.neighbor(node, directions[node])) ++steps;
    CHECK(steps >= rows - 3);
    CHECK(steps < rows + cols);
}

namespace {

/// Steps from the seeds (0 there) through stuck cells; far above any count where there is no way.
std::vector<int> steps_from(const Grid& grid, const std::vector<char>& stuck, std::vector<Index> reached) {
    std::vector<int> steps(grid.size(), 1'000'000'000);
    for (const Index seed : reached) steps[seed] = 0;
    for (std::size_t next = 0; next < reached.size(); ++next) {
        grid.neighbors(reached[next], [&](Index other, double, Slot) {
            if (!stuck[other] || steps[other] <= steps[reached[next]] + 1) return;
            steps[other] = steps[reached[next]] + 1;
            reached.push_back(other);
        });
    }
    return steps;
}

/// Whether every stuck cell flows to the lowest neighbour of its height on Barnes' surface, and those without a way out
/// nowhere.
bool flows_as_gradients_say(const Grid& grid, const std::vector<double>& z, const std::vector<Boundary>& boundary,
                            const FlowDirections& routed, const FlowDirections& directions) {
    std::vector<char> stuck(grid.size());
    std::vector<Index> at_exit, at_rim;
    for (Index node = 0; node < grid.size(); ++node) {
        stuck[node] = routed[node] == no_flow && boundary[node] == Boundary::interior && !std::isnan(z[node]);
    }
    for (Index node = 0; node < grid.size(); ++node) {
        bool exit = false, rim = false;
        grid.neighbors(node, [&](Index other, double, Slot) {
            exit = exit || (z[other] == z[node] && !stuck[other]);
            rim = rim || z[other] > z[node];
        });
        if (stuck[node] && exit) at_exit.push_back(node);
        if (stuck[node] && rim) at_rim.push_back(node);
    }
    const std::vector<int> to_exit = steps_from(grid, stuck, at_exit);
    const std::vector<int> from_rim = steps_from(grid, stuck, at_rim);
    const auto surface = [&](Index node) {
        if (!stuck[node]) return std::int64_t{-1'000'000'000};
        return 2 * std::int64_t{to_exit[node]} - (from_rim[node] < 1'000'000'000 ? from_rim[node] : -1);
    };
    bool right = true;
    for (Index node = 0; node < grid.size(); ++node) {
        if (!stuck[node]) continue;
        right = right && (directions[node] != no_flow) == (to_exit[node] < 1'000'000'000);
        if (directions[node] == no_flow) continue;
        const Index chosen = grid.neighbor(node, directions[node]);
        grid.neighbors(node, [&](Index other, double, Slot) {
            right = right && (z[other] != z[node] || surface(chosen) <= surface(other));
        });
        right = right && z[chosen] == z[node];
    }
    return right;
}

}  // namespace

TEST_CASE("Flats whose arms meet beyond the border of a block are resolved as one") {
    for (std::uint64_t seed = 1; seed <= 6; ++seed) {
        // At this share of low cells flats are long and branch often; a few ways out.
        const Grid grid = plane_grid(500, 400, 1, 1);
        Random random(seed, 77);
        std::vector<double> z(grid.size());
        std::vector<Boundary> boundary(grid.size(), Boundary::interior);
        for (double& height : z) height = random.uniform() < 0.38 + 0.02 * static_cast<double>(seed) ? 1 : 2;
        for (Boundary& b : boundary) {
            if (random.uniform() < 0.002) b = Boundary::base_level;
        }
        const FlowDirections routed = route(grid, z, boundary);
        FlowDirections directions = routed;
        resolve_flats(grid, z, boundary, directions);
        CHECK(flows_as_gradients_say(grid, z, boundary, routed, directions));
        const FlowGraph graph = flow_graph(grid, z, directions);
        CHECK(graph.order.size() == grid.size());  // nothing goes round in circles
    }
}

TEST_CASE("A single river of a million cells needs no recursion: straight, and winding through a square") {
    const Index side = 1000;
    const auto check_river = [](const Grid& grid, const std::vector<double>& z) {
        std::vector<Boundary> boundary(grid.size(), Boundary::interior);
        boundary[0] = Boundary::base_level;
        const FlowDirections directions = drained_directions(grid, z, boundary);
        const FlowGraph graph = flow_graph(grid, z, directions);
        const std::vector<double> area = accumulate(graph, std::vector<double>(grid.size(), 1.0));
        CHECK(area[0] == grid.size());
        CHECK(std::count(area.begin(), area.end(), 1.0) >= 1);
        return area;
    };
    std::vector<double> straight(std::size_t{side} * side);
    for (std::size_t i = 0; i < straight.size(); ++i) straight[i] = static_cast<double>(i);
    const std::vector<double> area = check_river(plane_grid(1, side * side, 1, 1), straight);
    CHECK(area[side] == straight.size() - side);
    // Every second row is the river's, joined at alternate ends; walls between.
    std::vector<double> winding(std::size_t{side} * side, 1e7);
    for (Index r = 0; r < side; ++r) {
        for (Index c = 0; c < side; ++c) {
            const Index along = r / 2 % 2 == 0 ? c : side - 1 - c;
            const bool joint = r % 2 == 1 && along == side - 1;
            if (r % 2 == 0 || joint)
                winding[std::size_t{r} * side + c] = (r / 2) * (side + 1.0) + along + (joint ? 1 : 0);
        }
    }
    check_river(plane_grid(side, side, 1, 1), winding);
}
