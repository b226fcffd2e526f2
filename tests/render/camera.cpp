// SPDX-License-Identifier: GPL-3.0-or-later
#include "thalweg/render/camera.hpp"

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>

#include "thalweg/core/error.hpp"
#include "thalweg/core/random.hpp"

using namespace thalweg;
using namespace thalweg::render;

namespace {

constexpr double degree = std::numbers::pi / 180;

TriangleSurface square(double side, double z = 0) {
    return {.x = {0, side, side, 0}, .y = {0, 0, side, side}, .z = {z, z, z, z}, .triangles = {{0, 1, 2}, {0, 2, 3}}};
}

struct Box {
    double left = 1e9, right = -1e9, top = 1e9, bottom = -1e9;
};

Box drawn_box(const Camera& camera, const TriangleSurface& s) {
    Box box;
    for (Index v = 0; v < s.size(); ++v) {
        const Point p = camera.project({s.x[v], s.y[v], s.z[v]});
        box = {std::min(box.left, p.x), std::max(box.right, p.x), std::min(box.top, p.y), std::max(box.bottom, p.y)};
    }
    return box;
}

}  // namespace

TEST_CASE("A viewer in the south has the east on the right, one in the west the south") {
    View view{.azimuth = 180 * degree, .elevation = 30 * degree};
    Camera camera = fitting_camera(view, square(100));
    CHECK(camera.right.x == Approx(1));
    CHECK(camera.forward.y > 0);
    CHECK(camera.forward.z == Approx(-0.5));
    CHECK(camera.eye.y < 0);
    CHECK(camera.up.z > 0);
    view.azimuth = 270 * degree;
    camera = fitting_camera(view, square(100));
    CHECK(camera.right.y == Approx(-1));
    CHECK(camera.eye.x < 0);
}

TEST_CASE("Straight down with the viewer's bearing in the south, the north is up") {
    const Camera camera = fitting_camera({.azimuth = 180 * degree, .elevation = 90 * degree}, square(100));
    CHECK(camera.up.y == Approx(1));
    const Point north = camera.project({50, 80, 0}), south = camera.project({50, 20, 0});
    CHECK(north.y < south.y);
    CHECK(north.x == Approx(south.x));
}

TEST_CASE("A picture straight down shows a square to scale, fitted to the shorter side of the picture") {
    const View view{.azimuth = 180 * degree, .elevation = 90 * degree, .width = 800, .height = 400, .margin = 0.1};
    const Box box = drawn_box(fitting_camera(view, square(100)), square(100));
    CHECK(box.top == Approx(40));
    CHECK(box.bottom == Approx(360));
    CHECK(box.left == Approx(240));
    CHECK(box.right == Approx(560));
}

TEST_CASE("Whatever the terrain and the view, all is in the picture and it touches two opposite margins") {
    for (std::uint64_t seed = 1; seed <= 300; ++seed) {
        Random random(seed, 0);
        TriangleSurface s;
        for (Index v = 0; v < 60; ++v) {
            s.x.push_back(1000 * random.uniform());
            s.y.push_back(1000 * random.uniform() * random.uniform());
            s.z.push_back(300 * random.uniform());
            if (v >= 2) s.triangles.push_back({v - 2, v - 1, v});
        }
        const View view{.azimuth = 7 * random.uniform(),
                        .elevation = 90 * degree * random.uniform(),
                        .field_of_view = (5 + 100 * random.uniform()) * degree,
                        .width = 600,
                        .height = 400,
                        .margin = 0.05};
        const Box box = drawn_box(fitting_camera(view, s), s);
        INFO(seed);
        CHECK(box.left > 30 - 1e-6);
        CHECK(box.right < 570 + 1e-6);
        CHECK(box.top > 20 - 1e-6);
        CHECK(box.bottom < 380 + 1e-6);
        const bool fills_width = box.left < 30.001 && box.right > 569.999;
        const bool fills_height = box.top < 20.001 && box.bottom > 379.999;
        CHECK((fills_width || fills_height));
    }
}

TEST_CASE("A ray through a place's pixel meets the place") {
    const Camera camera = fitting_camera({.azimuth = 1, .elevation = 0.4}, square(100));
    for (const Vector place : {Vector{10, 20, 0}, Vector{90, 5, 30}, Vector{50, 50, -7}}) {
        const Vector along = camera.ray(camera.project(place));
        const Vector away = cross(unit(along), place - camera.eye);
        CHECK(std::sqrt(dot(away, away)) < 1e-9);
    }
}

TEST_CASE("Views that cannot be are refused") {
    const TriangleSurface s = square(1);
    CHECK_THROWS_AS(fitting_camera({.width = 0}, s), Error);
    CHECK_THROWS_AS(fitting_camera({.field_of_view = 0}, s), Error);
    CHECK_THROWS_AS(fitting_camera({.field_of_view = 3.1}, s), Error);
    CHECK_THROWS_AS(fitting_camera({.field_of_view = 1e-300}, s), Error);
    CHECK_THROWS_AS(fitting_camera({.azimuth = std::nan("")}, s), Error);
    CHECK_THROWS_AS(fitting_camera({.elevation = 1.7}, s), Error);
    CHECK_THROWS_AS(fitting_camera({.elevation = -0.1}, s), Error);
    CHECK_THROWS_AS(fitting_camera({}, TriangleSurface{}), Error);
}
