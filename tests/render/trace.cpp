// SPDX-License-Identifier: GPL-3.0-or-later
#include "thalweg/render/trace.hpp"

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <cstring>

#include "thalweg/core/error.hpp"
#include "thalweg/core/parallel.hpp"

using namespace thalweg;
using namespace thalweg::render;

namespace {

constexpr double degree = std::numbers::pi / 180;

/// A surface over the square from 0 to `side`, `cells` each way.
template <class Height>
Model terrain(double side, Index cells, Height height, float color = 1) {
    Model model{.ground = {}, .color = {}, .sides = {}, .side_color = {}, .shading = Shading::facets};
    const Index across = cells + 1;
    for (Index v = 0; v < across * across; ++v) {
        const double x = side * (v % across) / cells, y = side * (v / across) / cells;
        model.ground.x.push_back(x);
        model.ground.y.push_back(y);
        model.ground.z.push_back(height(x, y));
        model.color.push_back({color, color, color});
        if (v % across == cells || v / across == cells) continue;
        model.ground.triangles.push_back({v, v + 1, v + 1 + across});
        model.ground.triangles.push_back({v, v + 1 + across, v + across});
    }
    return model;
}

double flat(double, double) { return 0; }

Camera from_above(const Model& model, Index pixels) {
    return fitting_camera({.azimuth = 180 * degree,
                           .elevation = 90 * degree,
                           .field_of_view = 20 * degree,
                           .width = pixels,
                           .height = pixels,
                           .margin = 0},
                          model.ground);
}

const Sampling centers{.samples = 1, .sky_rays = 0};

bool same_bytes(const Picture& a, const Picture& b) {
    return std::memcmp(a.light.data(), b.light.data(), a.light.size() * sizeof(Rgb)) == 0 &&
           std::memcmp(a.coverage.data(), b.coverage.data(), a.coverage.size() * sizeof(float)) == 0;
}

}  // namespace

TEST_CASE("A flat plain under the sun has the sine of its elevation times the colour in every pixel") {
    const Model model = terrain(1000, 4, flat, 0.5f);
    const Camera camera = from_above(model, 40);
    for (const double elevation : {10.0, 30.0, 60.0, 90.0}) {
        const Light light{.to_sun = direction(1, elevation * degree), .sun_radius = 0, .sun = {0.8f, 0.6f, 0.4f}};
        const Picture picture = trace(model, camera, light, centers);
        for (const Rgb& pixel : picture.light) {
            REQUIRE(pixel.r == Approx(0.5 * 0.8 * std::sin(elevation * degree)).epsilon(1e-5));
            REQUIRE(pixel.g == Approx(0.5 * 0.6 * std::sin(elevation * degree)).epsilon(1e-5));
        }
        REQUIRE(std::all_of(picture.coverage.begin(), picture.coverage.end(), [](float c) { return c == 1; }));
    }
}

TEST_CASE("A tilted plain has the cosine between its normal and the sun, the open sky the whole of its light") {
    for (const Shading shading : {Shading::facets, Shading::smooth}) {
        Model model = terrain(1000, 4, [](double x, double y) { return 0.3 * x - 0.2 * y; });
        model.shading = shading;
        const Vector to_sun = direction(2.1, 35 * degree);
        const Light light{.to_sun = to_sun, .sun_radius = 0};
        const double expected = dot(unit({-0.3, 0.2, 1}), to_sun);
        const Picture picture = trace(model, from_above(model, 20), light, centers);
        const Rgb middle = picture.light[10 * 20 + 10];
        CHECK(middle.r == Approx(expected).epsilon(1e-5));
    }
    const Model level = terrain(1000, 4, flat);
    const Light sky{.to_sun = {0, 0, -1}, .sky = {0.25f, 0.5f, 1}};
    const Picture picture = trace(level, from_above(level, 10), sky, {.samples = 4, .sky_rays = 16});
    CHECK(picture.light[55].g == Approx(0.5));
}

TEST_CASE("The foot of a high wall sees half of the sky, and a pit less than a ridge") {
    const Model wall = terrain(1000, 250, [](double x, double) { return x > 502 ? 400.0 : 0.0; });
    const Light sky{.to_sun = {0, 0, -1}, .sky = {1, 1, 1}};
    const Camera camera = from_above(wall, 100);
    const Picture picture = trace(wall, camera, sky, {.samples = 16, .sky_rays = 64});
    // Cosine-weighted: beside a wall of height h at distance d, long on both sides, (1 + d/√(d² + h²))/2 is open.
    int tested = 0;
    for (Index col = 0; col < 100; ++col) {
        const Vector along = camera.ray({col + 0.5, 50.5});
        const double x = camera.eye.x - camera.eye.z / along.z * along.x;  // where it meets the plain
        if (x < 20 || x > 480) continue;
        const double d = 502 - x;
        CHECK(picture.light[50 * 100 + col].r == Approx((1 + d / std::hypot(d, 400.0)) / 2).margin(0.05));
        ++tested;
    }
    CHECK(tested > 20);
}

TEST_CASE("The shadow of a wall is as long as its height over the tangent of the sun's elevation") {
    constexpr double height = 50, ridge = 500;
    const Model model = terrain(1000, 500, [](double x, double) { return x == ridge ? height : 0.0; });
    const Camera camera = from_above(model, 500);
    for (const double elevation : {15.0, 25.0, 45.0}) {
        const Light light{.to_sun = direction(-90 * degree, elevation * degree), .sun_radius = 0};
        const Picture picture = trace(model, camera, light, centers);
        const double shadow_end = ridge + height / std::tan(elevation * degree);
        Index tested = 0;
        for (Index col = 0; col < 500; ++col) {
            // On the plain the pixel's ray tells where: above the ridge's foot nothing is asked.
            const Vector along = camera.ray({col + 0.5, 250.5});
            const double x = camera.eye.x - camera.eye.z / along.z * along.x;
            if (x < ridge + 10 || x > 998 || std::abs(x - shadow_end) < 1) continue;
            INFO("x = " << x << ", end of the shadow at " << shadow_end);
            const float light_here = picture.light[250 * 500 + col].r;
            REQUIRE(light_here == Approx(x < shadow_end ? 0 : std::sin(elevation * degree)).margin(1e-5));
            ++tested;
        }
        CHECK(tested > 200);
    }
}

TEST_CASE("A sun of some width softens that shadow's edge about the same place") {
    const Model model = terrain(1000, 500, [](double x, double) { return x == 500 ? 50.0 : 0.0; });
    const Camera camera = from_above(model, 500);
    const Light light{.to_sun = direction(-90 * degree, 25 * degree), .sun_radius = 0.02};
    const Picture picture = trace(model, camera, light, {.samples = 64, .sky_rays = 0});
    const double end = 500 + 50 / std::tan(25 * degree);
    const auto at = [&](double x) {
        const Point p = camera.project({x, 500, 0});
        return picture.light[std::size_t(p.y) * 500 + std::size_t(p.x)].r / std::sin(25 * degree);
    };
    CHECK(at(end - 12) == Approx(0).margin(0.01));
    CHECK(at(end) == Approx(0.5).margin(0.15));
    CHECK(at(end + 12) == Approx(1).margin(0.02));
}

TEST_CASE("A square's picture covers exactly the pixels whose rays meet it") {
    const Model model = terrain(1000, 3, flat);
    for (const double azimuth : {0.0, 77.0, 200.0}) {
        View view{.azimuth = azimuth * degree, .elevation = 25 * degree, .field_of_view = 60 * degree};
        view.width = 160;
        view.height = 100;
        const Camera camera = fitting_camera(view, model.ground);
        const Picture picture = trace(model, camera, {}, centers);
        Index inside = 0;
        for (Index row = 0; row < 100; ++row) {
            for (Index col = 0; col < 160; ++col) {
                const Vector along = camera.ray({col + 0.5, row + 0.5});
                const double t = -camera.eye.z / along.z;
                const double x = camera.eye.x + t * along.x, y = camera.eye.y + t * along.y;
                const bool meets = t > 0 && x >= 0 && x <= 1000 && y >= 0 && y <= 1000;
                const double edge = std::min({std::abs(x), std::abs(y), std::abs(x - 1000), std::abs(y - 1000)});
                if (t > 0 && edge < 0.01) continue;
                INFO(col << ", " << row);
                REQUIRE(picture.coverage[row * 160 + col] == (meets ? 1.0f : 0.0f));
                inside += meets;
            }
        }
        CHECK(inside > 2000);
    }
}

TEST_CASE("A dome's outline is that of its sphere") {
    constexpr double radius = 400;
    const Model model = terrain(1000, 400, [](double x, double y) {
        const double square = radius * radius - (x - 500) * (x - 500) - (y - 500) * (y - 500);
        return square > 0 ? std::sqrt(square) : 0;
    });
    View view{.azimuth = 180 * degree, .elevation = 5 * degree, .field_of_view = 40 * degree};
    view.width = 400;
    view.height = 200;
    const Camera camera = fitting_camera(view, model.ground);
    const Picture picture = trace(model, camera, {}, centers);
    const Vector to_center = Vector{500, 500, 0} - camera.eye;
    const double edge = std::asin(radius / std::sqrt(dot(to_center, to_center)));
    Index tested = 0;
    for (Index row = 0; row < 200; ++row) {
        for (Index col = 0; col < 400; ++col) {
            const Vector along = unit(camera.ray({col + 0.5, row + 0.5}));
            if (along.z < 0) continue;  // the sky: only the dome stands before it
            const double angle = std::acos(dot(along, unit(to_center)));
            if (std::abs(angle - edge) < 0.01 * edge) continue;
            INFO(col << ", " << row);
            REQUIRE(picture.coverage[row * 400 + col] == (angle < edge ? 1.0f : 0.0f));
            ++tested;
        }
    }
    CHECK(tested > 1000);
}

TEST_CASE("A higher ridge hides the lower one behind it from the height where similar triangles say so") {
    // Seen level from the south, the near ridge of 100 m at y = 200 hides what is less high behind it.
    for (const double far_height : {90.0, 130.0}) {
        Model model = terrain(1000, 100, [&](double, double y) { return y == 200 ? 100 : y == 800 ? far_height : 0; });
        const Index across = 101;
        for (Index v = 0; v < model.ground.size(); ++v) {
            if (v / across >= 79) model.color[v] = {0, 1, 0};
        }
        View view{.azimuth = 180 * degree, .elevation = 0, .field_of_view = 10 * degree, .width = 200, .height = 60};
        const Camera camera = fitting_camera(view, model.ground);
        const Picture picture =
            trace(model, camera, {.to_sun = direction(180 * degree, 0.3), .sun_radius = 0}, centers);
        const double near_slope = (100 - camera.eye.z) / (200 - camera.eye.y);
        const double far_slope = (far_height - camera.eye.z) / (800 - camera.eye.y);
        const bool far_seen = std::any_of(picture.light.begin(), picture.light.end(),
                                          [](const Rgb& c) { return c.g > 0 && c.r < 0.5f * c.g; });
        CHECK(far_seen == (far_slope > near_slope));
    }
}

TEST_CASE("A picture has the same bytes for any number of threads") {
    Model model = terrain(
        1000, 120, [](double x, double y) { return 80 * std::sin(x / 60) * std::cos(y / 90); }, 0.7f);
    model.shading = Shading::smooth;
    const Camera camera = fitting_camera({.width = 120, .height = 80}, model.ground);
    const Light light{.to_sun = direction(5, 0.5), .sky = {0.3f, 0.4f, 0.5f}};
    const auto drawn = [&](int threads) {
        const ThreadLimit limit(threads);
        return trace(model, camera, light, {.samples = 8, .sky_rays = 4});
    };
    const Picture one = drawn(1);
    CHECK(same_bytes(one, drawn(2)));
    CHECK(same_bytes(one, drawn(4)));
}

TEST_CASE("Far from the origin nothing changes but rounding") {
    const auto height = [](double x, double y) { return 80 * std::sin(x / 60) * std::cos(y / 90); };
    Model here = terrain(1000, 60, height), there = here;
    for (double& x : there.ground.x) x += 5e5;
    for (double& y : there.ground.y) y += 4.2e6;
    const auto drawn = [](const Model& model) {
        return trace(model, fitting_camera({.width = 90, .height = 60}, model.ground), {.to_sun = direction(5, 0.5)},
                     centers);
    };
    const Picture a = drawn(here), b = drawn(there);
    Index different = 0;
    for (std::size_t i = 0; i < a.light.size(); ++i) different += std::abs(a.light[i].r - b.light[i].r) > 1e-3f;
    CHECK(different < 20);
}

TEST_CASE("Pictures that cannot be are refused") {
    const Model model = terrain(10, 2, flat);
    const Camera camera = from_above(model, 4);
    CHECK_THROWS_AS(trace(model, camera, {}, {.samples = 0}), Error);
    CHECK_THROWS_AS(trace({}, camera, {}, {}), Error);
    Model uncolored = model;
    uncolored.color.clear();
    CHECK_THROWS_AS(trace(uncolored, camera, {}, {}), Error);
}

TEST_CASE("Light becomes bytes by the curve of sRGB, over the background where nothing is drawn") {
    const Picture picture{.width = 2,
                          .height = 2,
                          .light = {{1, 0.2158605f, 0}, {0, 0, 0}, {0.5f, 0.5f, 0.5f}, {9, -1, 0.0031308f}},
                          .coverage = {1, 0, 0.5f, 1}};
    const auto bytes = to_srgb(picture, {from_srgb(0x804020), from_srgb(0x804020)});
    CHECK(bytes[0] == 255);
    CHECK(bytes[1] == 128);  // ((128/255 + 0.055)/1.055)^2.4
    CHECK(bytes[2] == 0);
    CHECK(bytes[3] == 0x80);
    CHECK(bytes[4] == 0x40);
    CHECK(bytes[5] == 0x20);
    CHECK(bytes[9] == 255);
    CHECK(bytes[10] == 0);
    CHECK(bytes[11] == 10);
}
