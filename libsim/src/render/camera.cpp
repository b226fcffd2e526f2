// SPDX-License-Identifier: GPL-3.0-or-later
#include "thalweg/render/camera.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "thalweg/core/error.hpp"

namespace thalweg::render {
namespace {

constexpr double degree = std::numbers::pi / 180;

void check(const View& view) {
    if (view.width == 0 || view.height == 0 || view.width > 32768 || view.height > 32768) {
        throw Error(
            fmt::format("a picture of {} x {} pixels cannot be drawn: 1 to 32768 each way", view.width, view.height));
    }
    if (!std::isfinite(view.azimuth)) {
        throw Error(
            fmt::format("the bearing to the viewer must be a finite number of degrees, not {}", view.azimuth / degree));
    }
    if (!(view.field_of_view >= 0.0999 * degree && view.field_of_view <= 170 * degree)) {
        throw Error(
            fmt::format("a field of view must be from 0.1 to 170 degrees, not {}", view.field_of_view / degree));
    }
    if (!(view.elevation >= 0 && view.elevation <= 90.000001 * degree)) {
        throw Error(fmt::format("the viewer's elevation must be from 0 (level) to 90 degrees (straight down), not {}",
                                view.elevation / degree));
    }
}

template <class Visit>
void visit_corners(const TriangleSurface& surface, Visit visit) {
    for (const auto& t : surface.triangles) {
        for (const Index v : t) visit(Vector{surface.x[v], surface.y[v], surface.z[v]});
    }
}

/// How far the corners reach to both sides of a plane pyramid of the camera's opening, seen from `center`: a camera
/// that stands D behind it and s aside sees all where low + D·opening ≥ s ≥ high − D·opening.
struct Reach {
    double opening;
    double low = std::numeric_limits<double>::infinity();
    double high = -std::numeric_limits<double>::infinity();

    void add(double aside, double ahead) {
        high = std::max(high, aside - ahead * opening);
        low = std::min(low, aside + ahead * opening);
    }
    double distance() const { return (high - low) / (2 * opening); }
    double aside() const { return (high + low) / 2; }
};

}  // namespace

Vector unit(const Vector& v) { return (1 / std::sqrt(dot(v, v))) * v; }

Vector direction(double azimuth, double elevation) {
    return {std::sin(azimuth) * std::cos(elevation), std::cos(azimuth) * std::cos(elevation), std::sin(elevation)};
}

Point Camera::project(const Vector& place) const {
    const Vector from_eye = place - eye;
    const double ahead = dot(from_eye, forward);
    return {(1 + dot(from_eye, right) / ahead / half_width) * width / 2,
            (1 - dot(from_eye, up) / ahead / half_height) * height / 2};
}

Vector Camera::ray(const Point& pixel) const {
    return forward + (2 * pixel.x / width - 1) * half_width * right + (1 - 2 * pixel.y / height) * half_height * up;
}

Camera fitting_camera(const View& view, const TriangleSurface& ground, const TriangleSurface& sides) {
    check(view);
    if (ground.triangles.empty()) throw Error("there is nothing to draw: no four neighbouring cells have data");
    const double longer = std::tan(view.field_of_view / 2), most = std::max(view.width, view.height);
    Camera camera{.eye = {},
                  .right = {-std::cos(view.azimuth), std::sin(view.azimuth), 0},
                  .up = {},
                  .forward = -1 * direction(view.azimuth, view.elevation),
                  .half_width = longer * view.width / most,
                  .half_height = longer * view.height / most,
                  .width = view.width,
                  .height = view.height};
    camera.up = cross(camera.right, camera.forward);
    const Index first = ground.triangles[0][0];
    const Vector center{ground.x[first], ground.y[first], ground.z[first]};
    Reach across{.opening = camera.half_width * (1 - 2 * view.margin)};
    Reach upward{.opening = camera.half_height * (1 - 2 * view.margin)};
    double nearest = std::numeric_limits<double>::infinity();
    for (const TriangleSurface* surface : {&ground, &sides}) {
        visit_corners(*surface, [&](const Vector& corner) {
            const Vector v = corner - center;
            const double ahead = dot(v, camera.forward);
            across.add(dot(v, camera.right), ahead);
            upward.add(dot(v, camera.up), ahead);
            nearest = std::min(nearest, ahead);
        });
    }
    // Level with a plain, its corners fill no height at all: then the width alone counts.
    const double distance = std::max({across.distance(), upward.distance(), 1e-6 - nearest});
    camera.eye = center + across.aside() * camera.right + upward.aside() * camera.up - distance * camera.forward;
    return camera;
}

}  // namespace thalweg::render
