// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <array>
#include <catch2/catch.hpp>
#include <cmath>
#include <set>

#include "thalweg/core/error.hpp"
#include "thalweg/evolve/noise.hpp"

namespace {

using thalweg::Point;
using thalweg::evolve::Fractal;
using thalweg::evolve::perlin_surface;
using thalweg::evolve::PerlinNoise;
using thalweg::evolve::uniform_surface;

/// The order published with the improved noise (Perlin 2002).
constexpr std::array<std::uint8_t, 256> perlins_own{
    151, 160, 137, 91,  90,  15,  131, 13,  201, 95,  96,  53,  194, 233, 7,   225, 140, 36,  103, 30,  69,  142,
    8,   99,  37,  240, 21,  10,  23,  190, 6,   148, 247, 120, 234, 75,  0,   26,  197, 62,  94,  252, 219, 203,
    117, 35,  11,  32,  57,  177, 33,  88,  237, 149, 56,  87,  174, 20,  125, 136, 171, 168, 68,  175, 74,  165,
    71,  134, 139, 48,  27,  166, 77,  146, 158, 231, 83,  111, 229, 122, 60,  211, 133, 230, 220, 105, 92,  41,
    55,  46,  245, 40,  244, 102, 143, 54,  65,  25,  63,  161, 1,   216, 80,  73,  209, 76,  132, 187, 208, 89,
    18,  169, 200, 196, 135, 130, 116, 188, 159, 86,  164, 100, 109, 198, 173, 186, 3,   64,  52,  217, 226, 250,
    124, 123, 5,   202, 38,  147, 118, 126, 255, 82,  85,  212, 207, 206, 59,  227, 47,  16,  58,  17,  182, 189,
    28,  42,  223, 183, 170, 213, 119, 248, 152, 2,   44,  154, 163, 70,  221, 153, 101, 155, 167, 43,  172, 9,
    129, 22,  39,  253, 19,  98,  108, 110, 79,  113, 224, 232, 178, 185, 112, 104, 218, 246, 97,  228, 251, 34,
    242, 193, 238, 210, 144, 12,  191, 179, 162, 241, 81,  51,  145, 235, 249, 14,  239, 107, 49,  192, 214, 31,
    181, 199, 106, 157, 184, 84,  204, 176, 115, 121, 50,  45,  127, 4,   150, 254, 138, 236, 205, 93,  222, 114,
    67,  29,  24,  72,  243, 141, 128, 195, 78,  66,  215, 61,  156, 180};

std::vector<Point> lattice(int side, double spacing) {
    std::vector<Point> points;
    for (int row = 0; row < side; ++row) {
        for (int col = 0; col < side; ++col) points.push_back({col * spacing, row * spacing});
    }
    return points;
}

}  // namespace

TEST_CASE("With Perlin's own permutation the reference implementation's value comes out") {
    CHECK(PerlinNoise(perlins_own)(3.14, 42, 7) == Approx(0.13691995878400012).epsilon(1e-14));
}

TEST_CASE("Perlin noise in the plane can be followed by hand in the first cell") {
    // p[0] = 151, p[151 + 0] = 17, p[17] = 142 … : hashes of the corners (0,0), (1,0), (0,1), (1,1) by the published
    // rule, written out plainly and apart from the library.
    const auto p = [](unsigned i) { return unsigned{perlins_own[i & 255U]}; };
    const auto corner = [&](unsigned i, unsigned j, double x, double y) {
        const unsigned h = p(p(p(i) + j)) & 15U;
        const double u = h < 8 ? x : y;
        const double v = h < 4 ? y : (h == 12 || h == 14 ? x : 0.0);
        return ((h & 1U) ? -u : u) + ((h & 2U) ? -v : v);
    };
    const PerlinNoise noise(perlins_own);
    for (double x = 0.05; x < 1; x += 0.1) {
        for (double y = 0.05; y < 1; y += 0.1) {
            const auto fade = [](double t) { return 6 * std::pow(t, 5) - 15 * std::pow(t, 4) + 10 * std::pow(t, 3); };
            const double south = corner(0, 0, x, y) * (1 - fade(x)) + corner(1, 0, x - 1, y) * fade(x);
            const double north = corner(0, 1, x, y - 1) * (1 - fade(x)) + corner(1, 1, x - 1, y - 1) * fade(x);
            CHECK(noise(x, y) == Approx(south * (1 - fade(y)) + north * fade(y)).margin(1e-14));
        }
    }
}

TEST_CASE("Perlin noise is 0 at whole numbers, repeats after 256 and stays within one") {
    const PerlinNoise noise(7);
    for (int i = -300; i < 300; i += 7) CHECK(noise(i, 3 * i + 1) == 0);
    double largest = 0;
    for (int i = 0; i < 20000; ++i) {
        const double x = -40 + 0.0137 * i;
        const double y = 0.0071 * i - 3;
        CHECK(noise(x, y) == Approx(noise(x + 256, y - 512)).margin(1e-11));
        largest = std::max(largest, std::abs(noise(x, y)));
    }
    CHECK(largest <= 1);
    CHECK(largest > 0.5);
}

TEST_CASE("Perlin noise is continuous across the cells of its lattice") {
    const PerlinNoise noise(8);
    for (int i = -20; i < 20; ++i) {
        CHECK(noise(i - 1e-9, 0.3 + i) == Approx(noise(i + 1e-9, 0.3 + i)).margin(1e-8));
        CHECK(noise(0.7 - i, i - 1e-9) == Approx(noise(0.7 - i, i + 1e-9)).margin(1e-8));
    }
}

TEST_CASE("Two seeds give two noises, one seed the same") {
    CHECK(PerlinNoise(1)(0.3, 0.4) == PerlinNoise(1)(0.3, 0.4));
    int different = 0;
    for (int i = 0; i < 50; ++i) different += PerlinNoise(1)(0.3 + i, 0.4) != PerlinNoise(2)(0.3 + i, 0.4);
    CHECK(different > 30);
}

TEST_CASE("A permutation that leaves out a number is refused") {
    auto broken = perlins_own;
    broken[3] = broken[4];
    CHECK_THROWS_AS(PerlinNoise(broken), thalweg::Error);
    CHECK_THROWS_AS(PerlinNoise(std::span(perlins_own).first(255)), thalweg::Error);
}

TEST_CASE("The fractal surface lies between 0 and its amplitude, is rough, and depends on seed and scale") {
    const auto points = lattice(64, 100);
    const auto surface = perlin_surface(points, 6400, 0.01, 3);
    CHECK(*std::ranges::min_element(surface) >= 0);
    CHECK(*std::ranges::max_element(surface) <= 0.01);
    CHECK(*std::ranges::max_element(surface) > 0.003);
    CHECK(std::set<double>(surface.begin(), surface.end()).size() >
          4000);  // no ties: no row of zeros at lattice points
    CHECK(surface == perlin_surface(points, 6400, 0.01, 3));
    CHECK(surface != perlin_surface(points, 6400, 0.01, 4));
    CHECK(surface != perlin_surface(points, 6400, 0.01, 3, Fractal{.scale = 20}));
}

TEST_CASE("Scaling positions and extent together leaves the fractal surface alone") {
    const auto metres = perlin_surface(lattice(20, 1024), 20480, 2, 5);
    const auto kilometres = perlin_surface(lattice(20, 1), 20, 2, 5);
    for (std::size_t i = 0; i < metres.size(); ++i) CHECK(metres[i] == Approx(kilometres[i]).margin(1e-10));
}

TEST_CASE("A fractal without an extent or octaves is refused") {
    CHECK_THROWS_AS(perlin_surface(lattice(2, 1), 0, 1, 1), thalweg::Error);
    CHECK_THROWS_AS(perlin_surface(lattice(2, 1), 1, 1, 1, Fractal{.octaves = 0}), thalweg::Error);
}

TEST_CASE("The uniform surface fills its range evenly, and a longer one begins with the shorter") {
    const auto surface = uniform_surface(10000, 2, 9);
    double sum = 0;
    for (const double height : surface) {
        REQUIRE(height >= 0);
        REQUIRE(height < 2);
        sum += height;
    }
    CHECK(sum / 10000 == Approx(1).margin(0.03));  // five standard errors
    const auto shorter = uniform_surface(100, 2, 9);
    CHECK(std::equal(shorter.begin(), shorter.end(), surface.begin()));
    CHECK(uniform_surface(100, 2, 10) != shorter);
}
