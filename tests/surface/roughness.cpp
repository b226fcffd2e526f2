// SPDX-License-Identifier: GPL-3.0-or-later
#include "thalweg/surface/roughness.hpp"

#include <catch2/catch.hpp>
#include <cmath>
#include <numbers>

#include "support/outlines.hpp"
#include "thalweg/core/error.hpp"
#include "thalweg/core/parallel.hpp"
#include "thalweg/core/random.hpp"
#include "thalweg/mesh/triangulate.hpp"
#include "thalweg/surface/heightfield.hpp"

using namespace thalweg;
using namespace thalweg::surface;
using namespace support;

namespace {

constexpr double side_m = 1000;

Mesh square_mesh(Index nodes) {
    const Polygon outline = rectangle(side_m, side_m);
    return mesh::triangulate(outline, mesh::poisson_disk_count(outline, nodes, 1));
}

std::vector<double> ones(const Mesh& mesh) { return std::vector<double>(mesh.size(), 1); }

/// One triangle with sides of 100, 80 and 60 m.
Mesh lone_triangle() {
    Mesh mesh;
    mesh.x = {0, 100, 64};
    mesh.y = {0, 0, 48};
    mesh.triangles = {{0, 1, 2}};
    return mesh;
}

/// Mean square of the differences between places so far apart, within the mesh.
double mean_square_difference(const Mesh& mesh, const FractalRoughness& how, double lag_m, Random& random) {
    std::vector<Point> from, to;
    while (from.size() < 3000) {
        const Point p{side_m * random.uniform(), side_m * random.uniform()};
        const double angle = 2 * std::numbers::pi * random.uniform();
        const Point q{p.x + lag_m * std::cos(angle), p.y + lag_m * std::sin(angle)};
        if (q.x < 0 || q.x > side_m || q.y < 0 || q.y > side_m) continue;
        from.push_back(p);
        to.push_back(q);
    }
    const auto share = ones(mesh);
    const auto a = roughness_at(mesh, share, how, from), b = roughness_at(mesh, share, how, to);
    double sum = 0, count = 0;
    for (std::size_t i = 0; i < a.size(); ++i) {
        if (std::isnan(a[i]) || std::isnan(b[i])) continue;
        sum += (a[i] - b[i]) * (a[i] - b[i]);
        ++count;
    }
    return sum / count;
}

}  // namespace

TEST_CASE("Differences in height grow with the distance as the Hurst exponent says, and are as large as asked for") {
    const Mesh mesh = square_mesh(60);  // edges of some 150 m
    for (const double hurst : {0.25, 0.5, 0.75}) {
        const std::array<double, 5> lags{0.125, 0.25, 0.5, 1, 2};
        std::array<double, 5> squares{};
        constexpr int seeds = 12;
        for (std::uint64_t seed = 1; seed <= seeds; ++seed) {
            const FractalRoughness how{.amplitude_m = 3, .reference_m = 100, .hurst = hurst, .finest_m = 0.01, .seed = seed};
            Random random(seed, 9);
            for (std::size_t i = 0; i < lags.size(); ++i) {
                squares[i] += mean_square_difference(mesh, how, lags[i], random) / seeds;
            }
        }
        const double exponent = 0.5 * std::log(squares[4] / squares[0]) / std::log(lags[4] / lags[0]);
        INFO(hurst);
        CHECK(exponent == Approx(hurst).margin(0.05));
        for (std::size_t i = 0; i < lags.size(); ++i) {
            CHECK(std::sqrt(squares[i]) == Approx(3 * std::pow(lags[i] / 100, hurst)).epsilon(0.18));
        }
    }
}

TEST_CASE("The middle of an edge is displaced by a normal number of the variance that its length has") {
    const Mesh mesh = lone_triangle();
    const std::vector<Point> middles{{50, 0}, {32, 24}};
    const double hurst = 0.6;
    double squares = 0, fourths = 0, products = 0, others = 0;
    constexpr int seeds = 20000;
    for (std::uint64_t seed = 1; seed <= seeds; ++seed) {
        const FractalRoughness how{.amplitude_m = 2, .reference_m = 100, .hurst = hurst, .finest_m = 30, .seed = seed};
        const auto z = roughness_at(mesh, ones(mesh), how, middles);
        squares += z[0] * z[0] / seeds;
        fourths += std::pow(z[0], 4) / seeds;
        others += z[1] * z[1] / seeds;
        products += z[0] * z[1] / seeds;
    }
    const double variance = 4 * (std::pow(2, -2 * hurst) - 0.25) * 2 / 3;
    CHECK(squares == Approx(variance).epsilon(0.04));
    CHECK(fourths / (squares * squares) == Approx(3).epsilon(0.06));
    CHECK(others == Approx(variance * std::pow(0.8, 2 * hurst)).epsilon(0.04));
    CHECK(std::abs(products / std::sqrt(squares * others)) < 0.03);
}

TEST_CASE("Roughness is continuous across edges, at all levels, and 0 on the mesh's vertices") {
    const Mesh mesh = square_mesh(40);
    const FractalRoughness how{.amplitude_m = 5, .reference_m = 100, .hurst = 0.4, .finest_m = 2, .seed = 3};
    const auto share = ones(mesh);
    std::vector<Point> here, there;
    Random random(4, 0);
    for (const auto& t : mesh.triangles) {
        for (int k = 0; k < 3; ++k) {
            const Index i = t[k], j = t[(k + 1) % 3];
            const double along = random.uniform();
            const Point p{mesh.x[i] + along * (mesh.x[j] - mesh.x[i]), mesh.y[i] + along * (mesh.y[j] - mesh.y[i])};
            here.push_back({p.x + 1e-7, p.y - 1e-7});
            there.push_back({p.x - 1e-7, p.y + 1e-7});
        }
        // Inside: on an edge between the middles of two edges.
        const Point q{0.3 * mesh.x[t[0]] + 0.5 * mesh.x[t[1]] + 0.2 * mesh.x[t[2]],
                      0.3 * mesh.y[t[0]] + 0.5 * mesh.y[t[1]] + 0.2 * mesh.y[t[2]]};
        here.push_back({q.x + 1e-7, q.y + 1e-7});
        there.push_back({q.x - 1e-7, q.y - 1e-7});
    }
    const auto a = roughness_at(mesh, share, how, here), b = roughness_at(mesh, share, how, there);
    double largest = 0;
    std::size_t compared = 0;
    for (std::size_t i = 0; i < a.size(); ++i) {
        if (std::isnan(a[i]) || std::isnan(b[i])) continue;  // beyond the outline
        ++compared;
        largest = std::max(largest, std::abs(a[i]));
        REQUIRE(std::abs(a[i] - b[i]) < 1e-5);
    }
    CHECK(compared > 3 * mesh.triangles.size());
    CHECK(largest > 1);
    std::vector<Point> vertices;
    for (Index node = 0; node < mesh.size(); ++node) vertices.push_back({mesh.x[node], mesh.y[node]});
    for (const double z : roughness_at(mesh, share, how, vertices)) CHECK(std::abs(z) < 1e-9);
}

TEST_CASE("Along an edge without share nothing is displaced, and elsewhere the share multiplies") {
    const Mesh mesh = lone_triangle();
    const FractalRoughness how{.amplitude_m = 5, .reference_m = 100, .hurst = 0.5, .finest_m = 1, .seed = 3};
    std::vector<Point> along, inside;
    for (int i = 0; i <= 100; ++i) along.push_back({static_cast<double>(i), 0});
    for (int i = 1; i < 20; ++i) inside.push_back({60, 2.0 * i});
    for (const double z : roughness_at(mesh, std::vector<double>{0, 0, 1}, how, along)) CHECK(z == 0);
    const auto full = roughness_at(mesh, ones(mesh), how, inside);
    const auto part = roughness_at(mesh, std::vector<double>{0, 0, 1}, how, inside);
    for (std::size_t i = 0; i < full.size(); ++i) {
        CHECK(full[i] != 0);
        CHECK(part[i] == Approx(full[i] * inside[i].y / 48));
    }
}

TEST_CASE("A raster has the roughness of its cells' centres, for any number of threads, and by the seed alone") {
    const Mesh mesh = square_mesh(80);
    FractalRoughness how{.amplitude_m = 5, .reference_m = 100, .hurst = 0.6, .finest_m = 5, .seed = 3};
    const auto rough = [&](int threads) {
        const ThreadLimit limit(threads);
        Raster raster = covering_raster(mesh, 200);
        std::fill(raster.values.begin(), raster.values.end(), 100.0);
        add_roughness(mesh, ones(mesh), how, raster);
        return raster;
    };
    const Raster one = rough(1);
    CHECK(one.values == rough(3).values);
    std::vector<Point> centers;
    for (Index cell = 0; cell < one.grid.size(); ++cell) {
        centers.push_back(one.placement.center(one.grid.row(cell), one.grid.col(cell)));
    }
    const auto single = roughness_at(mesh, ones(mesh), how, centers);
    for (Index cell = 0; cell < one.grid.size(); ++cell) {
        if (!std::isnan(single[cell])) REQUIRE(one.values[cell] == Approx(100 + single[cell]).margin(1e-9));
    }
    how.seed = 4;
    CHECK(one.values != rough(1).values);
}

TEST_CASE("Finer detail leaves the vertices of coarser detail where they are") {
    const Mesh mesh = lone_triangle();
    FractalRoughness how{.amplitude_m = 5, .reference_m = 100, .hurst = 0.6, .finest_m = 20, .seed = 3};
    const std::vector<Point> known{{50, 0}, {25, 0}, {75, 0}, {32, 24}, {82, 24}};
    const auto coarse = roughness_at(mesh, ones(mesh), how, known);
    how.finest_m = 0.5;
    const auto fine = roughness_at(mesh, ones(mesh), how, known);
    for (std::size_t i = 0; i < known.size(); ++i) CHECK(fine[i] == Approx(coarse[i]));
}

TEST_CASE("Roughness that cannot be is refused") {
    const Mesh mesh = lone_triangle();
    const std::vector<Point> places{{50, 10}};
    for (const FractalRoughness& how : {FractalRoughness{.hurst = 0},
                                   {.hurst = 1},
                                   {.hurst = std::nan("")},
                                   {.finest_m = 0},
                                   {.reference_m = -1},
                                   {.amplitude_m = std::nan("")},
                                   {.amplitude_m = HUGE_VAL}}) {
        CHECK_THROWS_AS(roughness_at(mesh, ones(mesh), how, places), Error);
    }
    CHECK_THROWS_AS(roughness_at(mesh, std::vector<double>{1, 1}, {}, places), Error);
    CHECK(roughness_at(mesh, ones(mesh), {.amplitude_m = 0}, places)[0] == 0);
    CHECK(std::isnan(roughness_at(mesh, ones(mesh), {}, std::vector<Point>{{500, 500}})[0]));
}
