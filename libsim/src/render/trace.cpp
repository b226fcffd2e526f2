// SPDX-License-Identifier: GPL-3.0-or-later
#include "thalweg/render/trace.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "render/rays.hpp"
#include "thalweg/core/error.hpp"
#include "thalweg/core/parallel.hpp"

namespace thalweg::render {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();

double fraction(double value) { return value - std::floor(value); }

/// Point `number` of a sequence that fills the unit square evenly, moved by a shift.
Point spread(double number, const Point& shift) {
    constexpr double plastic = 1.32471795724474602596;
    return {fraction(shift.x + number / plastic), fraction(shift.y + number / (plastic * plastic))};
}

/// A shift for every pixel (a 32-bit finalizer: every bit of the number reaches every bit of the hash).
Point shift_of(std::size_t pixel, std::uint32_t salt) {
    const auto scrambled = [](std::uint32_t bits) {
        bits = (bits ^ bits >> 16) * 0x7feb352du;
        bits = (bits ^ bits >> 15) * 0x846ca68bu;
        return bits ^ bits >> 16;
    };
    const std::uint32_t first = scrambled(static_cast<std::uint32_t>(pixel) ^ salt);
    return {first / 4294967296.0, scrambled(first + 0x9e3779b9u) / 4294967296.0};
}

/// Two directions at right angles to a unit vector and to each other.
std::pair<Vector, Vector> around(const Vector& normal) {
    const Vector other = std::abs(normal.z) < 0.9 ? Vector{0, 0, 1} : Vector{1, 0, 0};
    const Vector first = unit(cross(other, normal));
    return {first, cross(normal, first)};
}

Vector vertex(const TriangleSurface& s, Index v) { return {s.x[v], s.y[v], s.z[v]}; }

std::vector<Vector> vertex_normals(const TriangleSurface& s) {
    std::vector<Vector> normals(s.size());
    for (const auto& t : s.triangles) {
        const Vector a = vertex(s, t[0]);
        const Vector area = cross(vertex(s, t[1]) - a, vertex(s, t[2]) - a);
        for (const Index v : t) normals[v] = normals[v] + area;
    }
    return normals;
}

/// A place on the model, ready to be lit.
struct Spot {
    Vector place;
    Vector normal;  ///< of the triangle, towards the eye
    Vector shading;
    Rgb color;
};

class Tracer {
  public:
    Tracer(const Model& model, const Camera& camera, const Light& light, const Sampling& sampling)
        : model_(model),
          camera_(camera),
          light_(light),
          sampling_(sampling),
          rays_(model.ground, model.sides),
          normals_(model.shading == Shading::smooth ? vertex_normals(model.ground) : std::vector<Vector>()),
          sun_side_(around(light.to_sun)) {}

    void draw_pixel(Index row, Index col, Picture& picture) const {
        const std::size_t pixel = std::size_t{row} * camera_.width + col;
        Rgb light;
        Index hits = 0;
        for (Index sample = 0; sample < sampling_.samples; ++sample) {
            const Point in_pixel = spread(sample, {0.5, 0.5});
            const Vector along = camera_.ray({col + in_pixel.x, row + in_pixel.y});
            const Hit hit = rays_.first(camera_.eye, along);
            if (hit.surface == none) continue;
            ++hits;
            light = light + lit(spot(hit, along), pixel, sample);
        }
        const float share = 1.0f / static_cast<float>(sampling_.samples);
        picture.light[pixel] = share * light;
        picture.coverage[pixel] = share * static_cast<float>(hits);
    }

  private:
    Spot spot(const Hit& hit, const Vector& along) const {
        const TriangleSurface& s = hit.surface == 0 ? model_.ground : model_.sides;
        const auto& t = s.triangles[hit.triangle];
        const double w = 1 - hit.u - hit.v;
        Spot spot{.place = w * vertex(s, t[0]) + hit.u * vertex(s, t[1]) + hit.v * vertex(s, t[2]),
                  .normal = unit(hit.normal),
                  .shading = {},
                  .color = model_.side_color};
        if (dot(spot.normal, along) > 0) spot.normal = -1 * spot.normal;
        spot.shading = spot.normal;
        if (hit.surface != 0 && !model_.side_normals.empty()) {
            const Vector& outward = model_.side_normals[hit.triangle];
            spot.shading = spot.normal = outward;
            spot.place = spot.place + model_.side_clearance * outward;
        }
        if (hit.surface != 0) return spot;
        spot.color = static_cast<float>(w) * model_.color[t[0]] + static_cast<float>(hit.u) * model_.color[t[1]] +
                     static_cast<float>(hit.v) * model_.color[t[2]];
        if (model_.shading == Shading::smooth) {
            spot.shading = unit(w * normals_[t[0]] + hit.u * normals_[t[1]] + hit.v * normals_[t[2]]);
        }
        return spot;
    }

    Rgb lit(const Spot& spot, std::size_t pixel, Index sample) const {
        Rgb sum = sunlight(spot, pixel, sample);
        if (sampling_.sky_rays > 0) sum = sum + open_sky(spot, pixel, sample) * light_.sky;
        return spot.color * sum;
    }

    Rgb sunlight(const Spot& spot, std::size_t pixel, Index sample) const {
        if (!(light_.to_sun.z > 0)) return {};
        const Point on_disc = spread(sample, shift_of(pixel, 1));
        const double radius = light_.sun_radius * std::sqrt(on_disc.x), angle = 2 * std::numbers::pi * on_disc.y;
        const Vector to_sun = unit(light_.to_sun + radius * std::cos(angle) * sun_side_.first +
                                   radius * std::sin(angle) * sun_side_.second);
        const double facing = dot(spot.shading, to_sun);
        if (!(facing > 0) || rays_.blocked(spot.place, spot.normal, to_sun, infinity)) return {};
        return static_cast<float>(facing) * light_.sun;
    }

    /// Share of the sky's light that arrives.
    Rgb open_sky(const Spot& spot, std::size_t pixel, Index sample) const {
        const auto [first, second] = around(spot.shading);
        const Point shift = shift_of(pixel, 2);
        Index open = 0;
        for (Index i = 0; i < sampling_.sky_rays; ++i) {
            const Point p = spread(double(sample) * sampling_.sky_rays + i, shift);
            const double radius = std::sqrt(p.x), angle = 2 * std::numbers::pi * p.y;
            const Vector along = radius * std::cos(angle) * first + radius * std::sin(angle) * second +
                                 std::sqrt(1 - p.x) * spot.shading;
            open +=
                along.z > 0 && dot(along, spot.normal) > 0 && !rays_.blocked(spot.place, spot.normal, along, infinity);
        }
        const float share = static_cast<float>(open) / static_cast<float>(sampling_.sky_rays);
        return {share, share, share};
    }

    const Model& model_;
    const Camera& camera_;
    const Light& light_;
    const Sampling& sampling_;
    Rays rays_;
    std::vector<Vector> normals_;
    std::pair<Vector, Vector> sun_side_;
};

}  // namespace

Picture trace(const Model& model, const Camera& camera, const Light& light, const Sampling& sampling) {
    if (sampling.samples == 0) throw Error("a picture needs at least one sample per pixel");
    if (model.ground.triangles.empty()) throw Error("a picture needs at least one triangle");
    if (model.color.size() != model.ground.size()) {
        throw Error(fmt::format("{} colours for {} vertices", model.color.size(), model.ground.size()));
    }
    if (!model.side_normals.empty() && model.side_normals.size() != model.sides.triangles.size()) {
        throw Error(fmt::format("{} normals for {} triangles of the sides", model.side_normals.size(),
                                model.sides.triangles.size()));
    }
    const Tracer tracer(model, camera, light, sampling);
    Picture picture{.width = camera.width, .height = camera.height, .light = {}, .coverage = {}};
    picture.light.resize(std::size_t{camera.width} * camera.height);
    picture.coverage.resize(picture.light.size());
    const auto draw_rows = [&](Index first, Index last) {
        for (Index row = first; row < last; ++row) {
            for (Index col = 0; col < camera.width; ++col) tracer.draw_pixel(row, col, picture);
        }
    };
    parallel_for(0, camera.height, draw_rows, 4);
    return picture;
}

}  // namespace thalweg::render
