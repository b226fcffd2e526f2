// SPDX-License-Identifier: GPL-3.0-or-later
// Nodes are as many as were asked for, and lie in memory as they lie in space.
#include <fmt/format.h>

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>

#include "series.hpp"
#include "thalweg/core/random.hpp"
#include "thalweg/mesh/points.hpp"
#include "thalweg/mesh/triangulate.hpp"

using namespace thalweg;
using namespace thalweg::validation;

namespace {

Polygon coast() {
    Polygon ring;
    for (int i = 0; i < 90; ++i) {
        const double angle = 2 * M_PI * i / 90, r = 9000 + 2500 * std::sin(3 * angle) + 800 * std::cos(11 * angle);
        ring.push_back({r * std::cos(angle), r * std::sin(angle)});
    }
    return ring;
}

Polygon square() { return {{0, 0}, {10000, 0}, {10000, 10000}, {0, 10000}}; }

PolygonPart with_lake() {
    return {.outer = coast(), .holes = {{{-2000, -1500}, {-2000, 1500}, {1800, 1200}, {2200, -900}}}};
}

constexpr std::pair<const char*, mesh::PointPattern> patterns[] = {{"Poisson", mesh::PointPattern::poisson},
                                                                   {"hexagonal", mesh::PointPattern::hexagonal},
                                                                   {"regular", mesh::PointPattern::regular}};

/// Of the distances in numbers between neighbours, the one that nine in ten do not pass.
double ninth_decile_of_index_distance(const Mesh& mesh) {
    std::vector<double> apart;
    for (Index node = 0; node < mesh.size(); ++node) {
        mesh.neighbors(node, [&](Index other, double, Slot) { apart.push_back(std::abs(double(other) - node)); });
    }
    const auto place = apart.begin() + static_cast<std::ptrdiff_t>(apart.size() * 9 / 10);
    std::nth_element(apart.begin(), place, apart.end());
    return *place;
}

/// How far the cells are from adding up to the domain, relative to it.
double area_error(const PolygonPart& domain, const Mesh& mesh) {
    const auto area_of = [](const Polygon& ring) {
        double twice = 0;
        for (std::size_t i = 0; i < ring.size(); ++i) {
            const Point &p = ring[i], &q = ring[(i + 1) % ring.size()];
            twice += p.x * q.y - q.x * p.y;
        }
        return std::abs(twice) / 2;
    };
    double wanted = area_of(domain.outer), sum = 0;
    for (const Polygon& hole : domain.holes) wanted -= area_of(hole);
    for (Index node = 0; node < mesh.size(); ++node) sum += mesh.area(node);
    return std::abs(sum / wanted - 1);
}

}  // namespace

TEST_CASE("From a hundred to 300 000 nodes the wanted count is met within 2 %, and cells add up to the domain") {
    Categories counts, areas;
    for (const auto& [shape, domain] : {std::pair{"square", PolygonPart{.outer = square(), .holes = {}}},
                                        std::pair{"coast", PolygonPart{.outer = coast(), .holes = {}}},
                                        std::pair{"coast with a lake", with_lake()}}) {
        for (const auto& [name, pattern] : patterns) {
            const std::string category = fmt::format("{}, {}", shape, name);
            double worst = 0, area = 0;
            for (const Index wanted : {150u, 1000u, 3000u, 10000u, 30000u, 100000u, 300000u}) {
                const auto points = mesh::place_points_count(domain, pattern, wanted, 1);
                const double off = std::abs(static_cast<double>(points.points.size()) - wanted) / wanted;
                worst = std::max(worst, off);
                counts.add(category, off);
                if (wanted > 30000) continue;
                area = std::max(area, area_error(domain, mesh::triangulate(domain, points)));
                areas.add(category, area);
            }
            fmt::print("{:28} counts within {:.2f} %, cells add up within {:.1e}\n", category, 100 * worst, area);
            CHECK(worst <= 0.02);
            CHECK(area < 1e-12);
        }
    }
    write_series("node_counts", counts);
    write_series("cell_areas", areas);
}

TEST_CASE("How far apart neighbours are in memory does not grow with the number of nodes") {
    std::vector<double> nodes, apart;
    for (const Index wanted : {3000u, 10000u, 30000u, 100000u, 300000u}) {
        const Mesh mesh = mesh::triangulate(square(), mesh::poisson_disk_count(square(), wanted, 1));
        nodes.push_back(mesh.size());
        apart.push_back(ninth_decile_of_index_distance(mesh));
        fmt::print("{:6} nodes: nine in ten neighbours are at most {:.0f} numbers apart\n", mesh.size(), apart.back());
    }
    // Along a Hilbert curve the share of neighbours further than g apart falls like 1/√g, whatever the number of nodes;
    // numbered by rows nine in ten would be within a few √N.
    CHECK(std::log(apart.back() / apart.front()) / std::log(nodes.back() / nodes.front()) < 0.1);
    write_series("memory_order", {{"nodes", nodes}, {"numbers_apart_nine_in_ten", apart}});
}
