// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <numeric>

#include "support/outlines.hpp"
#include "support/temp_folder.hpp"
#include "thalweg/core/error.hpp"
#include "thalweg/mesh/points.hpp"
#include "thalweg/mesh/triangulate.hpp"

using namespace thalweg;
using namespace thalweg::mesh;
using namespace support;

namespace {

constexpr PointPattern patterns[] = {PointPattern::poisson, PointPattern::hexagonal, PointPattern::regular};

Polygon moved(Polygon ring, double factor, double x, double y) {
    for (Point& p : ring) p = {x + factor * p.x, y + factor * p.y};
    return ring;
}

/// A square with a concave hole in its middle and a slanted one near a corner, which comes close to the rim.
PolygonPart holed_square() {
    return {rectangle(10, 10), {moved(l_shape(), 1.5, 3, 3), {{8.2, 8.4}, {9.9, 8.9}, {8.9, 9.9}}}};
}

std::vector<std::pair<std::string, PolygonPart>> many_domains() {
    std::vector<std::pair<std::string, PolygonPart>> domains;
    for (const auto& [name, outline] : many_outlines()) domains.push_back({name, {outline, {}}});
    domains.push_back({"holed square", holed_square()});
    domains.push_back({"star with a hole", {random_star(17, 1), {rectangle(0.1, 0.1)}}});
    return domains;
}

double area_of(const PolygonPart& domain) {
    double area = std::abs(polygon_area(domain.outer));
    for (const Polygon& hole : domain.holes) area -= std::abs(polygon_area(hole));
    return area;
}

double sum_of_cells(const Mesh& mesh) { return std::accumulate(mesh.cell_area.begin(), mesh.cell_area.end(), 0.0); }

}  // namespace

TEST_CASE("Every pattern meets a wanted count within 2 % in every domain, and its mesh needs no more points") {
    for (const auto& [name, domain] : many_domains()) {
        for (const PointPattern pattern : patterns) {
            for (Index count : {150u, 333u, 1000u, 5000u, 20000u}) {
                for (std::uint64_t seed = 0; seed < (count < 2000 ? 4 : 1); ++seed) {
                    INFO(name << " pattern " << static_cast<int>(pattern) << " count " << count << " seed " << seed);
                    const PointSet set = place_points_count(domain, pattern, count, seed);
                    CHECK(std::abs(static_cast<double>(set.points.size()) - count) <= 0.02 * count);
                    if (count <= 1000) CHECK(triangulate(domain, set).size() == set.points.size());
                }
            }
        }
    }
}

TEST_CASE("Random outlines and counts are met within 2 % by every pattern") {
    for (std::uint64_t seed = 0; seed < 60; ++seed) {
        const PolygonPart domain{random_star(5 + static_cast<int>(seed % 30), seed), {}};
        const Index count = 200 + static_cast<Index>(37 * seed);
        for (const PointPattern pattern : patterns) {
            INFO(seed << " " << count << " " << static_cast<int>(pattern));
            const double got = static_cast<double>(place_points_count(domain, pattern, count, seed).points.size());
            CHECK(std::abs(got - count) <= 0.02 * count);
        }
    }
}

TEST_CASE("The cells of every pattern add up to the domain's area to rounding, concave or with holes, also far away") {
    for (const auto& [name, domain] : many_domains()) {
        for (const PointPattern pattern : patterns) {
            for (const double away : {0.0, 4e6}) {
                INFO(name << " pattern " << static_cast<int>(pattern) << " at " << away);
                PolygonPart placed{moved(domain.outer, 1e4, away, away), {}};
                for (const Polygon& hole : domain.holes) placed.holes.push_back(moved(hole, 1e4, away, away));
                const Mesh mesh = triangulate(placed, place_points_count(placed, pattern, 3000, 5));
                CHECK(std::abs(sum_of_cells(mesh) / area_of(placed) - 1) < 1e-12);
                CHECK(*std::min_element(mesh.cell_area.begin(), mesh.cell_area.end()) > 0);
            }
        }
    }
}

TEST_CASE("No node and no edge lies in a hole, whose corners are nodes of the outline") {
    const PolygonPart domain = holed_square();
    for (const PointPattern pattern : patterns) {
        const Mesh mesh = triangulate(domain, place_points(domain, pattern, 0.3, 3));
        for (const Polygon& hole : domain.holes) {
            for (Index node = 0; node < mesh.size(); ++node) {
                if (mesh.on_outline[node]) continue;
                REQUIRE_FALSE(is_inside(hole, {mesh.x[node], mesh.y[node]}));
            }
            for (const auto& [a, b, c] : mesh.triangles) {
                const Point middle{(mesh.x[a] + mesh.x[b] + mesh.x[c]) / 3, (mesh.y[a] + mesh.y[b] + mesh.y[c]) / 3};
                REQUIRE_FALSE(is_inside(hole, middle));
            }
            for (const Point& corner : hole) {
                Index node = 0;
                while (node < mesh.size() && !(mesh.x[node] == corner.x && mesh.y[node] == corner.y)) ++node;
                REQUIRE(node < mesh.size());
                CHECK(mesh.on_outline[node] == 1);
            }
        }
        // A surface with two holes: vertices − edges + triangles = 1 − 2.
        const auto edges = static_cast<std::int64_t>(mesh.neighbor_list.size() / 2);
        CHECK(mesh.size() - edges + static_cast<std::int64_t>(mesh.triangles.size()) == -1);
    }
}

TEST_CASE("A regular lattice in a rectangle is whole, and a hexagonal one has six equal neighbours inside") {
    const PolygonPart rectangle_part{rectangle(20, 10), {}};
    const Mesh squares = triangulate(rectangle_part, place_points(rectangle_part, PointPattern::regular, 1, 1));
    CHECK(squares.size() == 21 * 11);
    CHECK(std::count(squares.on_outline.begin(), squares.on_outline.end(), 1) == 60);
    for (Index node = 0; node < squares.size(); ++node) {
        CHECK(squares.x[node] == Approx(std::round(squares.x[node])).margin(1e-12));
        if (!squares.on_outline[node]) CHECK(squares.cell_area[node] == Approx(1).epsilon(1e-12));
    }
    const double height = 20 * std::sqrt(0.75);
    const PolygonPart tall{rectangle(20, height), {}};
    const Mesh triangles = triangulate(tall, place_points(tall, PointPattern::hexagonal, 1, 1));
    int inner = 0;
    for (Index node = 0; node < triangles.size(); ++node) {
        const double x = triangles.x[node], y = triangles.y[node];
        if (x < 2.6 || x > 17.4 || y < 1.8 || y > height - 1.8) continue;
        ++inner;
        CHECK(triangles.offset[node + 1] - triangles.offset[node] == 6);
        CHECK(triangles.cell_area[node] == Approx(std::sqrt(0.75)).epsilon(1e-12));
        triangles.neighbors(node, [](Index, double length, Slot) { CHECK(length == Approx(1).epsilon(1e-12)); });
    }
    CHECK(inner > 200);
}

TEST_CASE("Holes that touch, cross, lie outside or in each other are refused") {
    const auto refuses = [](std::vector<Polygon> holes) {
        const auto error = test::error_of([&] {
            place_points({rectangle(10, 10), std::move(holes)}, PointPattern::poisson, 0.5, 1);
        });
        INFO(error);
        CHECK(test::is_sentence(error));
    };
    refuses({moved(rectangle(1, 1), 1, 20, 20)});                                 // outside
    refuses({moved(rectangle(4, 4), 1, 8, 3)});                                   // through the rim
    refuses({moved(rectangle(1, 1), 1, 0, 3)});                                   // along the rim
    refuses({{{5, 5}, {6, 6}, {10, 8}}});                                         // a corner on the rim
    refuses({moved(rectangle(4, 4), 1, 2, 2), moved(rectangle(1, 1), 1, 3, 3)});  // one in the other
    refuses({moved(rectangle(2, 2), 1, 2, 2), moved(rectangle(2, 2), 1, 4, 4)});  // corner to corner
    refuses({moved(rectangle(20, 20), 1, -5, -5)});                               // around the whole
    refuses({{{5, 5}, {6, 6}, {6, 5}, {5, 6}}});                                  // a bow tie
}
