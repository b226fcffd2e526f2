// SPDX-License-Identifier: GPL-3.0-or-later
#include "thalweg/evolve/tectonics.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "thalweg/core/error.hpp"

namespace thalweg::evolve {
namespace {

Point middle_of(const Box& box) { return {(box.low.x + box.high.x) / 2, (box.low.y + box.high.y) / 2}; }

double width(const Box& box) { return box.high.x - box.low.x; }
double height(const Box& box) { return box.high.y - box.low.y; }

/// Share of the way across the box along the direction, 0 to 1.
class Ramp {
  public:
    Ramp(const Box& box, double direction_deg) : middle_(middle_of(box)) {
        const double angle = direction_deg * std::numbers::pi / 180;
        along_ = {std::sin(angle), std::cos(angle)};
        reach_ = std::abs(along_.x) * width(box) + std::abs(along_.y) * height(box);
    }
    double operator()(const Point& p) const {
        const double ahead = (p.x - middle_.x) * along_.x + (p.y - middle_.y) * along_.y;
        return std::clamp(0.5 + ahead / reach_, 0.0, 1.0);
    }

  private:
    Point middle_, along_;
    double reach_;
};

/// Fractal noise spread between its extremes on a lattice over the box.
std::vector<double> spread_noise(const Shape& shape, const Box& box, std::span<const Point> positions) {
    constexpr int side = 128;
    const double extent = std::max(width(box), height(box));
    Fractal fractal;
    fractal.scale = shape.noise_scale;
    std::vector<Point> lattice;
    for (int row = 0; row < side; ++row) {
        for (int col = 0; col < side; ++col) {
            lattice.push_back(
                {box.low.x + (col + 0.5) / side * width(box), box.low.y + (row + 0.5) / side * height(box)});
        }
    }
    const std::vector<double> sampled = fractal_noise(lattice, extent, shape.seed, shape.variant, fractal);
    const auto [low, high] = std::minmax_element(sampled.begin(), sampled.end());
    std::vector<double> values = fractal_noise(positions, extent, shape.seed, shape.variant, fractal);
    for (double& value : values) value = std::clamp((value - *low) / (*high - *low), 0.0, 1.0);
    return values;
}

template <class Value>
std::vector<double> at_each(std::span<const Point> positions, Value value) {
    std::vector<double> values;
    values.reserve(positions.size());
    for (const Point& p : positions) values.push_back(value(p));
    return values;
}

std::vector<double> stepped(const Shape& shape, const Box& box, std::span<const Point> positions) {
    if (shape.steps < 1) throw Error(fmt::format("a stepped pattern needs at least one step, not {}", shape.steps));
    const Ramp ramp(box, shape.direction_deg);
    const double steps = shape.steps;
    return at_each(positions, [&](const Point& p) { return std::min(std::floor(ramp(p) * steps) + 1, steps) / steps; });
}

}  // namespace

Box bounding_box(std::span<const Point> positions) {
    if (positions.empty()) throw Error("a domain without a single position has no extent");
    Box box{positions[0], positions[0]};
    for (const Point& p : positions) {
        box.low = {std::min(box.low.x, p.x), std::min(box.low.y, p.y)};
        box.high = {std::max(box.high.x, p.x), std::max(box.high.y, p.y)};
    }
    return box;
}

std::vector<double> pattern_values(const Shape& shape, const Box& box, std::span<const Point> positions) {
    const Point middle = middle_of(box);
    const double half_width = width(box) / 2, half_height = height(box) / 2;
    const double radius = std::min(half_width, half_height);
    switch (shape.pattern) {
        case Pattern::constant:
            break;
        case Pattern::gradient:
            return at_each(positions, Ramp(box, shape.direction_deg));
        case Pattern::stepped:
            return stepped(shape, box, positions);
        case Pattern::diamond:
            return at_each(positions, [&](const Point& p) {
                return std::max(0.0,
                                1 - std::abs(p.x - middle.x) / half_width - std::abs(p.y - middle.y) / half_height);
            });
        case Pattern::radial:
            return at_each(positions, [&](const Point& p) {
                return std::max(0.0, 1 - std::hypot(p.x - middle.x, p.y - middle.y) / radius);
            });
        case Pattern::noise:
            return spread_noise(shape, box, positions);
    }
    return std::vector<double>(positions.size(), 1.0);
}

}  // namespace thalweg::evolve
