// SPDX-License-Identifier: GPL-3.0-or-later
#include "thalweg/grow/surface_mesh.hpp"

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <map>
#include <set>

#include "support/basins.hpp"
#include "thalweg/grow/elevations.hpp"
#include "thalweg/grow/grow.hpp"
#include "thalweg/mesh/triangulate.hpp"

using namespace thalweg;
using namespace thalweg::grow;

namespace {

double length_of(const Network& network, const Edge& edge) {
    const Point& a = network.vertices[edge.from];
    const Point& b = network.vertices[edge.to];
    return std::hypot(b.x - a.x, b.y - a.y);
}

double area_of(const Network& network, Index link, Side side) {
    Polygon polygon;
    for (const Index vertex : network.polygon(link, side)) polygon.push_back(network.vertices[vertex]);
    return mesh::polygon_area(polygon);
}

double steepest_side(const Network& network) {
    double steepest = 0;
    for (const auto& [left, right] : network.sidewall_slope) steepest = std::max({steepest, left, right});
    return steepest;
}

std::set<std::pair<Index, Index>> edges_of(const SurfaceMesh& mesh) {
    std::set<std::pair<Index, Index>> edges;
    for (const auto& t : mesh.triangles) {
        for (int k = 0; k < 3; ++k) edges.insert(std::minmax(t[k], t[(k + 1) % 3]));
    }
    return edges;
}

double area_of(const SurfaceMesh& mesh) {
    double area = 0;
    for (const auto& [a, b, c] : mesh.triangles) {
        area += mesh::polygon_area({{mesh.x[a], mesh.y[a]}, {mesh.x[b], mesh.y[b]}, {mesh.x[c], mesh.y[c]}});
    }
    return area;
}

struct Grown {
    Basin basin;
    Dials dials;
    Network network;
};

Grown grown(std::uint64_t seed) {
    Random random(seed, 3);
    for (;;) {
        const Basin basin = support::random_basin(random);
        const Dials dials = support::random_dials(random, basin);
        try {
            return {basin, dials, grow::grow(basin, dials).network};
        } catch (const Error&) {  // a trunk that is too long for the density
        }
    }
}

}  // namespace

TEST_CASE("Lines are cut into equal pieces, and the polygons stay what they were") {
    for (std::uint64_t seed = 0; seed < 50; ++seed) {
        const Grown g = grown(seed);
        const double longest = 0.3 * g.dials.channel_maintenance_m;
        const Network cut = subdivided(g.network, longest);
        std::map<EdgeKind, double> before, after;
        for (const Edge& edge : g.network.edges) before[edge.kind] += length_of(g.network, edge);
        for (const Edge& edge : cut.edges) {
            after[edge.kind] += length_of(cut, edge);
            REQUIRE(length_of(cut, edge) <= longest * (1 + 1e-6));
        }
        for (const auto& [kind, length] : before) CHECK(after[kind] == Approx(length).epsilon(1e-9));
        std::size_t sides = 0, outline = 0;
        for (Index link = 0; link < cut.size(); ++link) {
            for (const Side side : {Side::left, Side::right}) {
                const double area = g.network.polygon_area_m2[2 * link + static_cast<Index>(side)];
                REQUIRE(std::abs(area_of(cut, link, side) - area) < 1e-9 * total_area(g.network));
                sides += cut.polygon(link, side).size();
            }
        }
        for (const Edge& edge : cut.edges) outline += edge.kind == EdgeKind::outline;
        CHECK(sides == 2 * cut.edges.size() - outline);
    }
    CHECK_THROWS_WITH(subdivided(grown(1).network, 0), Catch::Contains("pieces of 0 m"));
}

TEST_CASE("The surface's triangles fill random basins, hold all lines as edges and keep every height in its bounds") {
    for (std::uint64_t seed = 0; seed < 100; ++seed) {
        const Grown g = grown(seed);
        const double spacing = 0.5 * g.dials.channel_maintenance_m;
        const SurfaceMesh mesh = surface_mesh(g.network, g.dials.flint, g.basin.base_level_m, spacing);
        CHECK(area_of(mesh) == Approx(total_area(g.network)).epsilon(1e-9));
        const auto edges = edges_of(mesh);
        for (const Edge& line : mesh.lines) REQUIRE(edges.count(std::minmax(line.from, line.to)) == 1);

        const Network cut = subdivided(g.network, spacing);
        REQUIRE(mesh.size() == cut.vertices.size());
        const auto ranges = height_ranges(g.network, g.dials.flint, g.basin.base_level_m);
        for (std::size_t vertex = 0; vertex < ranges.size(); ++vertex) {
            const double height = mesh.height[mesh.vertex_of[vertex]];
            const double digits = 1e-9 * (std::abs(height) + 1);
            REQUIRE(height >= ranges[vertex].least - digits);
            REQUIRE(height <= std::max(ranges[vertex].least, ranges[vertex].allowed) + digits);
        }
        for (Index link = 0; link < g.network.size(); ++link) {  // channels are not touched
            const double rise = gradient(g.dials.flint, g.network.magnitude[link]) * g.network.length_m[link];
            const double low = mesh.height[mesh.vertex_of[g.network.lower[link]]];
            const double high = mesh.height[mesh.vertex_of[g.network.upper[link]]];
            REQUIRE(high - low == Approx(rise).epsilon(1e-6).margin(1e-9 * high));
        }
    }
}

TEST_CASE("Beyond the reach of valley sides there are level benches, and the basin is still filled") {
    std::size_t places = 0;
    for (std::uint64_t seed = 0; seed < 100; ++seed) {
        Grown g = grown(seed);
        const double c = g.dials.channel_maintenance_m;
        g.network.sidewall_reach_m = 0.8 * c;
        const SurfaceMesh mesh = surface_mesh(g.network, g.dials.flint, 0, 0.5 * c);
        CHECK(area_of(mesh) == Approx(total_area(g.network)).epsilon(1e-9));
        const auto edges = edges_of(mesh);
        for (const Edge& line : mesh.lines) REQUIRE(edges.count(std::minmax(line.from, line.to)) == 1);
        std::vector<std::uint8_t> on_line(mesh.size(), 0);
        for (const Edge& line : mesh.lines) on_line[line.from] = on_line[line.to] = 1;
        const auto channel = elevations(g.network, g.dials.flint, 0);
        const double highest_channel =
            channel[*std::ranges::max_element(g.network.upper, {}, [&](Index vertex) { return channel[vertex]; })];
        for (Index i = 0; i < mesh.size(); ++i) {
            REQUIRE(mesh.height[i] <= highest_channel + 0.8 * c * steepest_side(g.network) * (1 + 1e-9));
            if (on_line[i] != 0) continue;
            ++places;
            REQUIRE_FALSE(mesh.on_channel[i]);
        }
    }
    CHECK(places > 1000);
}

TEST_CASE("A bare lobe is a bench as high as its sides reach, and its surface does not sag") {
    // A link of 300 m in a basin 4 km wide: corners at the reach of 500 m, all else of the ground beyond it.
    Network network;
    network.vertices = {{0, 0}, {0, 300}, {2000, 0}, {2000, 4000}, {0, 4000}, {-2000, 4000}, {-2000, 0}};
    network.edges = {{0, 1, EdgeKind::channel}, {0, 2, EdgeKind::outline}, {2, 3, EdgeKind::outline},
                     {3, 4, EdgeKind::outline}, {4, 5, EdgeKind::outline}, {5, 6, EdgeKind::outline},
                     {6, 0, EdgeKind::outline}, {1, 4, EdgeKind::head}};
    network.downstream = {none};
    network.upstream = {{none, none}};
    network.lower = {0};
    network.upper = {1};
    network.magnitude = {1};
    network.length_m = {300};
    network.sidewall_slope = {{0.4, 0.4}};
    network.sidewall_reach_m = 500;
    network.polygon_vertices = {0, 1, 4, 5, 6, 1, 0, 2, 3, 4};
    network.polygon_offset = {0, 5, 10};
    network.polygon_area_m2 = {8e6, 8e6};
    const SurfaceMesh mesh = surface_mesh(network, {.p = 0.1, .q = -0.6}, 0, 400);
    CHECK(area_of(mesh) == Approx(1.6e7));
    std::vector<std::uint8_t> on_line(mesh.size(), 0);
    for (const Edge& line : mesh.lines) on_line[line.from] = on_line[line.to] = 1;
    std::size_t benches = 0;
    for (Index i = 0; i < mesh.size(); ++i) {
        const double along = std::clamp(mesh.y[i], 0.0, 300.0);
        const double away = std::hypot(mesh.x[i], mesh.y[i] - along);
        INFO(mesh.x[i] << " " << mesh.y[i]);
        CHECK(mesh.height[i] == Approx(0.1 * along + 0.4 * std::min(away, 500.0)).margin(1e-9));
        benches += on_line[i] == 0;
        CHECK((on_line[i] != 0 || away > 500));
    }
    CHECK(benches > 50);  // 16 km² in squares of 400 m, less those near the link and near the lines
}

TEST_CASE(
    "No vertex rises from a neighbour more steeply than any valley side, unless it must to lie above its channels") {
    Dials dials;
    dials.channel_maintenance_m = 250;
    const Network network = grow::grow(support::square_basin(10000), dials).network;
    const SurfaceMesh mesh = surface_mesh(network, dials.flint, 0, 125);
    const auto ranges = height_ranges(subdivided(network, 125), dials.flint, 0);
    std::map<std::pair<double, double>, double> least;  // by place: the mesh numbers its vertices anew
    const Network cut = subdivided(network, 125);
    for (std::size_t i = 0; i < ranges.size(); ++i) least[{cut.vertices[i].x, cut.vertices[i].y}] = ranges[i].least;
    const double steepest = steepest_side(network);
    std::size_t held_up = 0, limited = 0;
    for (const auto& [a, b] : edges_of(mesh)) {
        const Index high = mesh.height[a] > mesh.height[b] ? a : b;
        const Index low = a == high ? b : a;
        const double distance = std::hypot(mesh.x[a] - mesh.x[b], mesh.y[a] - mesh.y[b]);
        const double allowed = mesh.height[low] + steepest * distance;
        if (mesh.height[high] > allowed + 1e-9) {
            ++held_up;
            REQUIRE(mesh.height[high] == least[std::pair(mesh.x[high], mesh.y[high])]);
        }
        limited += mesh.height[high] > allowed - 1e-9;
    }
    CHECK(limited > held_up);             // the limit is felt
    CHECK(held_up < 0.05 * mesh.size());  // a few channels lie too near to each other for their heights
}

TEST_CASE("The gradient on channels is that of the link, and junctions are level") {
    Dials dials;
    dials.channel_maintenance_m = 400;
    const Network network = grow::grow(support::square_basin(10000), dials).network;
    const SurfaceMesh mesh = surface_mesh(network, dials.flint, 0, 100);
    for (Index i = 0; i < mesh.size(); ++i) REQUIRE(std::isnan(mesh.channel_slope_x[i]) == !mesh.on_channel[i]);
    const auto slope_at = [&](Index vertex, Index link) {
        const Index here = mesh.vertex_of[vertex];
        const Point& lower = network.vertices[network.lower[link]];
        const Point& upper = network.vertices[network.upper[link]];
        const bool level = vertex == network.upper[link] && !network.is_exterior(link);
        const double slope = level ? 0 : gradient(dials.flint, network.magnitude[link]) / network.length_m[link];
        CHECK(mesh.channel_slope_x[here] == Approx(slope * (upper.x - lower.x)).margin(1e-12));
        CHECK(mesh.channel_slope_y[here] == Approx(slope * (upper.y - lower.y)).margin(1e-12));
    };
    for (Index link = 0; link < network.size(); ++link) slope_at(network.upper[link], link);
    slope_at(network.lower[0], 0);
}
