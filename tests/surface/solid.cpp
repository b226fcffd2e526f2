// SPDX-License-Identifier: GPL-3.0-or-later
#include "thalweg/surface/solid.hpp"

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <limits>
#include <map>
#include <set>

#include "support/outlines.hpp"
#include "support/rasters.hpp"
#include "thalweg/core/error.hpp"
#include "thalweg/core/random.hpp"

using namespace thalweg;
using namespace thalweg::surface;
using namespace support;

namespace {

constexpr double no_data = std::numeric_limits<double>::quiet_NaN();

/// Every edge is run along once each way.
bool is_closed_manifold(const TriangleSurface& s) {
    std::map<std::pair<Index, Index>, int> runs;
    for (const auto& t : s.triangles) {
        for (int k = 0; k < 3; ++k) ++runs[{t[k], t[(k + 1) % 3]}];
    }
    return std::all_of(runs.begin(), runs.end(), [&](const auto& run) {
        const auto back = runs.find({run.first.second, run.first.first});
        return run.second == 1 && run.first.first != run.first.second && back != runs.end();
    });
}

/// The triangles around every vertex hang together by their sides.
bool has_one_fan_per_vertex(const TriangleSurface& s) {
    std::vector<std::map<Index, Index>> next(s.size());  // around each vertex, from neighbour to neighbour
    for (const auto& t : s.triangles) {
        for (int k = 0; k < 3; ++k) next[t[k]][t[(k + 1) % 3]] = t[(k + 2) % 3];
    }
    for (const auto& ring : next) {
        if (ring.empty()) return false;
        std::set<Index> seen;
        for (Index at = ring.begin()->first; seen.insert(at).second; at = ring.at(at)) {
        }
        if (seen.size() != ring.size()) return false;
    }
    return true;
}

/// Prisms under the triangles, one by one.
double volume_above(const TriangleSurface& s, double base) {
    double volume = 0;
    for (const auto& [i, j, k] : s.triangles) {
        const double area = ((s.x[j] - s.x[i]) * (s.y[k] - s.y[i]) - (s.x[k] - s.x[i]) * (s.y[j] - s.y[i])) / 2;
        volume += area * ((s.z[i] + s.z[j] + s.z[k]) / 3 - base);
    }
    return volume;
}

void check_solid(const TriangleSurface& surface, double base) {
    const TriangleSurface solid = closed_solid(surface, base);
    CHECK(is_closed_manifold(solid));
    CHECK(has_one_fan_per_vertex(solid));
    const double expected = volume_above(surface, base);
    CHECK(expected > 0);
    CHECK(enclosed_volume(solid) == Approx(expected).epsilon(1e-10));
    CHECK(*std::min_element(solid.z.begin(), solid.z.end()) == base);
    CHECK(solid.triangles.size() >= 2 * surface.triangles.size() + 6);
    CHECK(std::equal(surface.z.begin(), surface.z.end(), solid.z.begin()));  // vertices keep their numbers
}

struct GridTerrain {
    Grid grid;
    std::vector<Point> centers;
    std::vector<double> heights;

    TriangleSurface surface() const { return triangle_surface(grid, centers, heights); }
};

GridTerrain grid_terrain(Index rows, Index cols, double dx, double dy) {
    GridTerrain t{plane_grid(rows, cols, dx, dy), {}, {}};
    for (Index node = 0; node < t.grid.size(); ++node) {
        t.centers.push_back({t.grid.col(node) * dx, -dy * t.grid.row(node)});
        t.heights.push_back(5 + std::sin(node * 1.7));
    }
    return t;
}

}  // namespace

TEST_CASE("One triangle becomes a prism") {
    const TriangleSurface flat{.x = {0, 4, 0}, .y = {0, 0, 3}, .z = {2, 2, 2}, .triangles = {{0, 1, 2}}};
    const TriangleSurface solid = closed_solid(flat, 0);
    CHECK(solid.size() == 6);
    CHECK(solid.triangles.size() == 8);
    CHECK(is_closed_manifold(solid));
    CHECK(enclosed_volume(solid) == Approx(12));
}

TEST_CASE("A TIN's solid is closed, faces outward and holds the prisms under its triangles, in every outline") {
    for (const auto& [name, outline] : many_outlines()) {
        INFO(name);
        const Mesh mesh = poisson_mesh(outline, 150);
        const auto heights =
            node_values(mesh, [](double x, double y) { return 3 + std::sin(5 * x) - std::cos(7 * y); });
        const TriangleSurface surface = triangle_surface(mesh, heights);
        CHECK(surface.triangles == mesh.triangles);
        check_solid(surface, 0.5);
        check_solid(surface, -100);
    }
}

TEST_CASE("A mesh whose nodes lack data loses their triangles and stays closed") {
    const Mesh mesh = poisson_mesh(random_star(12, 3), 300);
    for (std::uint64_t seed = 1; seed <= 30; ++seed) {
        Random random(seed, 1);
        auto heights = node_values(mesh, [](double x, double y) { return 2 + x * y; });
        for (double& h : heights) {
            if (random.uniform() < 0.3) h = no_data;
        }
        const TriangleSurface surface = triangle_surface(mesh, heights);
        CHECK(std::none_of(surface.z.begin(), surface.z.end(), [](double z) { return std::isnan(z); }));
        check_solid(surface, 0);
    }
}

TEST_CASE("A grid of cells makes two triangles of four neighbours, on the lesser fall") {
    const GridTerrain t{plane_grid(2, 2, 1, 1), {{0, 1}, {1, 1}, {0, 0}, {1, 0}}, {0, 9, 5, 1}};
    const TriangleSurface surface = t.surface();
    REQUIRE(surface.triangles.size() == 2);
    for (const auto& corners : surface.triangles) {  // both hold the diagonal from 0 m to 1 m
        CHECK(std::count(corners.begin(), corners.end(), Index{0}) == 1);
        CHECK(std::count(corners.begin(), corners.end(), Index{3}) == 1);
    }
    check_solid(surface, -1);
}

TEST_CASE("A grid's surface has the area of its cells between centres, facing up") {
    const GridTerrain t = grid_terrain(7, 11, 30, 20);
    const TriangleSurface surface = t.surface();
    CHECK(surface.triangles.size() == 2 * 6 * 10);
    TriangleSurface flat = surface;
    std::fill(flat.z.begin(), flat.z.end(), 1.0);
    CHECK(volume_above(flat, 0) == Approx(6 * 10 * 30 * 20.0));
    check_solid(surface, 1);
}

TEST_CASE("Rasters with holes, and parts that touch in a corner only, become closed solids") {
    for (std::uint64_t seed = 1; seed <= 60; ++seed) {
        INFO(seed);
        GridTerrain t = grid_terrain(14, 17, 10, 10);
        Random random(seed, 2);
        for (double& h : t.heights) {
            if (random.uniform() < 0.02 * static_cast<double>(seed % 20)) h = no_data;
        }
        check_solid(t.surface(), -2);
    }
}

TEST_CASE("Two squares that share one vertex only get one each") {
    GridTerrain t = grid_terrain(3, 3, 1, 1);
    t.heights[2] = t.heights[6] = no_data;  // leaves three squares' worth of a diagonal band
    check_solid(t.surface(), 0);
    const TriangleSurface bow{
        .x = {0, 1, 0, -1, 0}, .y = {0, 1, 1, -1, -1}, .z = {1, 1, 1, 1, 1}, .triangles = {{0, 1, 2}, {0, 3, 4}}};
    const TriangleSurface solid = closed_solid(bow, 0);
    CHECK(solid.size() == 12);
    CHECK(is_closed_manifold(solid));
    CHECK(has_one_fan_per_vertex(solid));
}

TEST_CASE("What cannot become a solid is refused") {
    const TriangleSurface flat{.x = {0, 4, 0}, .y = {0, 0, 3}, .z = {2, 2, 2}, .triangles = {{0, 1, 2}}};
    CHECK_THROWS_AS(closed_solid(flat, 2), Error);
    TriangleSurface twice = flat;
    twice.triangles.push_back({0, 1, 2});
    CHECK_THROWS_AS(closed_solid(twice, 0), Error);
    const Mesh mesh = poisson_mesh(rectangle(1, 1), 50);
    CHECK_THROWS_AS(triangle_surface(mesh, std::vector<double>(3)), Error);
    const GridTerrain t = grid_terrain(3, 3, 1, 1);
    CHECK_THROWS_AS(triangle_surface(t.grid, t.centers, std::vector<double>(3)), Error);
    CHECK_THROWS_AS(triangle_surface(t.grid, std::vector<Point>(2), t.heights), Error);
}
