// SPDX-License-Identifier: GPL-3.0-or-later
#include "thalweg/surface/heightfield.hpp"

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <cstring>
#include <limits>

#include "support/outlines.hpp"
#include "thalweg/core/error.hpp"
#include "thalweg/core/parallel.hpp"
#include "thalweg/mesh/triangulate.hpp"

using namespace thalweg;
using namespace thalweg::surface;
using namespace support;

namespace {

Mesh mesh_of(const Polygon& outline, Index count) {
    return mesh::triangulate(outline, mesh::poisson_disk_count(outline, count, 1));
}

std::vector<double> values_of(const Mesh& mesh, double (*height)(double, double)) {
    std::vector<double> values(mesh.size());
    for (Index node = 0; node < mesh.size(); ++node) values[node] = height(mesh.x[node], mesh.y[node]);
    return values;
}

/// Of all nodes, by looking at each.
double nearest_distance(const Mesh& mesh, const Point& p) {
    double nearest = std::numeric_limits<double>::infinity();
    for (Index node = 0; node < mesh.size(); ++node) {
        nearest = std::min(nearest, distance(p, {mesh.x[node], mesh.y[node]}));
    }
    return nearest;
}

template <class Visit>
void visit_centers(const Raster& raster, Visit visit) {
    for (Index cell = 0; cell < raster.grid.size(); ++cell) {
        visit(cell, raster.placement.center(raster.grid.row(cell), raster.grid.col(cell)));
    }
}

/// Two triangles of a unit square, cut from south-west to north-east.
Mesh two_triangles() {
    Mesh mesh;
    mesh.x = {0, 1, 1, 0};
    mesh.y = {0, 0, 1, 1};
    mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
    mesh.offset = {0, 3, 5, 8, 10};
    mesh.neighbor_list = {1, 2, 3, 0, 2, 0, 1, 3, 0, 2};
    mesh.length_list = {1, std::sqrt(2.0), 1, 1, 1, std::sqrt(2.0), 1, 1, 1, 1};
    return mesh;
}

}  // namespace

TEST_CASE("A covering raster has square cells over the bounding box") {
    Mesh mesh;
    mesh.x = {10, 16, 12};
    mesh.y = {5, 5, 9};
    const Raster raster = covering_raster(mesh, 12);
    CHECK(raster.grid.cols == 12);
    CHECK(raster.grid.rows == 8);
    CHECK(raster.placement.west == 10);
    CHECK(raster.placement.north == 9);
    CHECK(raster.placement.cell_width == 0.5);
    CHECK(raster.placement.cell_height == 0.5);
    CHECK(raster.grid.area(0) == 0.25);
    CHECK(raster.values.size() == 96);
    CHECK(std::all_of(raster.values.begin(), raster.values.end(), [](double v) { return std::isnan(v); }));
    CHECK_THROWS_AS(covering_raster(mesh, 0), Error);
    CHECK_THROWS_AS(covering_raster(Mesh{}, 10), Error);
}

TEST_CASE("Two triangles, drawn by hand, interpolate their corners") {
    const Mesh mesh = two_triangles();
    Raster raster = covering_raster(mesh, 2);
    interpolate_linear(mesh, std::vector<double>{0, 4, 8, 0}, raster);  // folded along the diagonal
    CHECK(raster.values[0] == Approx(2));                               // (0.25, 0.75), upper triangle: 8 x
    CHECK(raster.values[1] == Approx(6));                               // (0.75, 0.75), on the diagonal
    CHECK(raster.values[2] == Approx(2));                               // (0.25, 0.25), on the diagonal
    CHECK(raster.values[3] == Approx(4));                               // (0.75, 0.25), lower triangle: 4 x + 4 y
}

TEST_CASE("A plane is reproduced to rounding, inside the domain only") {
    for (const auto& [name, outline] : many_outlines()) {
        INFO(name);
        const Mesh mesh = mesh_of(outline, 500);
        Raster raster = covering_raster(mesh, 150);
        interpolate_linear(mesh, values_of(mesh, [](double x, double y) { return 3 + 2 * x - 5 * y; }), raster);
        visit_centers(raster, [&](Index cell, const Point& p) {
            if (is_inside(outline, p)) {
                REQUIRE(std::abs(raster.values[cell] - (3 + 2 * p.x - 5 * p.y)) < 1e-11);
            } else {
                REQUIRE(std::isnan(raster.values[cell]));
            }
        });
    }
}

TEST_CASE("A constant stays itself to the last bit") {
    const Mesh mesh = mesh_of(rectangle(7, 3), 1000);
    Raster raster = covering_raster(mesh, 200);
    interpolate_linear(mesh, std::vector<double>(mesh.size(), 0.1), raster);
    CHECK(std::all_of(raster.values.begin(), raster.values.end(), [](double v) { return v == 0.1; }));
}

TEST_CASE("At a node's place the value is the node's, even beside steep neighbours") {
    const Mesh mesh = mesh_of(l_shape(), 400);
    std::vector<double> values(mesh.size());
    for (Index node = 0; node < mesh.size(); ++node) values[node] = std::pow(-1.7, node % 40) + node / 3.0;
    Index tested = 0;
    for (Index node = 0; node < mesh.size(); ++node) {
        if (mesh.x[node] == 0 || mesh.y[node] == 0) continue;
        Raster spot;  // one cell from the origin to twice the node's place: its centre is the node's to the last bit
        spot.grid = plane_grid(1, 1, 2 * mesh.x[node], 2 * mesh.y[node]);
        spot.placement.north = spot.placement.cell_height = 2 * mesh.y[node];
        spot.placement.cell_width = 2 * mesh.x[node];
        REQUIRE(spot.placement.center(0, 0) == Point{mesh.x[node], mesh.y[node]});
        interpolate_linear(mesh, values, spot);
        REQUIRE(spot.values[0] == values[node]);
        ++tested;
    }
    CHECK(tested > mesh.size() / 2);
}

TEST_CASE("Centres on the edges and nodes of a regular mesh all get a value") {
    mesh::PointSet set{.points = {{0, 0}, {8, 0}, {8, 8}, {0, 8}, {4, 4}, {2, 4}, {6, 4}, {4, 2}, {4, 6}},
                       .outline_count = 4};
    const Mesh mesh = mesh::triangulate(rectangle(8, 8), set);
    Raster raster;
    raster.grid = plane_grid(9, 9, 1, 1);
    raster.placement.west = -0.5;
    raster.placement.north = 8.5;
    interpolate_linear(mesh, values_of(mesh, [](double x, double y) { return x + 10 * y; }), raster);
    visit_centers(raster, [&](Index cell, const Point& p) { CHECK(raster.values[cell] == Approx(p.x + 10 * p.y)); });
}

TEST_CASE("Values outside a raster smaller than the mesh are left out") {
    const Mesh mesh = mesh_of(rectangle(10, 10), 500);
    Raster raster;
    raster.grid = plane_grid(20, 30, 0.05, 0.1);
    raster.placement = {.west = 4, .north = 6, .cell_width = 0.05, .cell_height = 0.1, .crs_wkt = {}};
    interpolate_linear(mesh, mesh.x, raster);
    visit_centers(raster, [&](Index cell, const Point& p) { CHECK(raster.values[cell] == Approx(p.x)); });
}

TEST_CASE("Far from the origin, where a cell is a few thousand roundings wide, there are no holes") {
    Mesh mesh = mesh_of(rectangle(1e-3, 1e-3), 300);
    for (double& x : mesh.x) x += 5e5;
    for (double& y : mesh.y) y += 4.2e6;
    Raster raster = covering_raster(mesh, 500);
    interpolate_linear(mesh, mesh.x, raster);
    visit_centers(raster, [&](Index cell, const Point& p) { REQUIRE(std::abs(raster.values[cell] - p.x) < 1e-9); });
}

TEST_CASE("The nearest node is that of a search over all nodes") {
    for (const auto& [name, outline] : many_outlines()) {
        INFO(name);
        const Mesh mesh = mesh_of(outline, 400);
        const Raster raster = covering_raster(mesh, 90);
        const std::vector<Index> nearest = nearest_node(mesh, raster);
        visit_centers(raster, [&](Index cell, const Point& p) {
            REQUIRE((nearest[cell] != none) == is_inside(outline, p));
            if (nearest[cell] == none) return;
            REQUIRE(distance(p, {mesh.x[nearest[cell]], mesh.y[nearest[cell]]}) == nearest_distance(mesh, p));
        });
    }
}

TEST_CASE("Careless points, whose sharp triangles hide the nearest node, make no difference") {
    for (std::uint64_t seed = 0; seed < 30; ++seed) {
        const Polygon outline = random_star(9, seed);
        mesh::PointSet set{.points = outline, .outline_count = 9};
        Random random(seed, 5);
        while (set.points.size() < 80) {
            const Point p{2 * random.uniform() - 1, 2 * random.uniform() - 1};
            if (is_inside(outline, p)) set.points.push_back(p);
        }
        const Mesh mesh = mesh::triangulate(outline, set);
        const Raster raster = covering_raster(mesh, 60);
        const std::vector<Index> nearest = nearest_node(mesh, raster);
        visit_centers(raster, [&](Index cell, const Point& p) {
            if (nearest[cell] == none) return;
            REQUIRE(distance(p, {mesh.x[nearest[cell]], mesh.y[nearest[cell]]}) == nearest_distance(mesh, p));
        });
    }
}

TEST_CASE("One thread and two give the same bytes") {
    const Mesh mesh = mesh_of(random_star(15, 2), 5000);
    const std::vector<double> values = values_of(mesh, [](double x, double y) { return std::sin(9 * x) * y; });
    const auto run = [&](int threads) {
        const ThreadLimit limit(threads);
        Raster raster = covering_raster(mesh, 500);
        interpolate_linear(mesh, values, raster);
        return std::pair(raster.values, nearest_node(mesh, raster));
    };
    const auto one = run(1);
    const auto two = run(2);
    CHECK(std::memcmp(one.first.data(), two.first.data(), one.first.size() * sizeof(double)) == 0);
    CHECK(one.second == two.second);
}

TEST_CASE("A value for each node is needed") {
    const Mesh mesh = two_triangles();
    Raster raster = covering_raster(mesh, 2);
    CHECK_THROWS_AS(interpolate_linear(mesh, std::vector<double>(3), raster), Error);
}
