// SPDX-License-Identifier: GPL-3.0-or-later
#include "thalweg/render/colors.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "thalweg/core/parallel.hpp"
#include "thalweg/evolve/noise.hpp"

namespace thalweg::render {
namespace {

constexpr double degree = 3.14159265358979323846 / 180;

/// 0 under `low`, 1 above `high`, smooth between.
double step(double low, double high, double value) {
    const double share = std::clamp((value - low) / (high - low), 0.0, 1.0);
    return share * share * (3 - 2 * share);
}

struct Range {
    double low = std::numeric_limits<double>::infinity();
    double high = -std::numeric_limits<double>::infinity();

    void add(double value) {
        if (std::isnan(value)) return;
        low = std::min(low, value);
        high = std::max(high, value);
    }
    double size() const { return high > low ? high - low : 1; }
};

Range range_of(std::span<const double> values) {
    Range range;
    for (const double value : values) range.add(value);
    return range;
}

/// Difference per metre along one axis, from the neighbours `before` and `after` where they have data.
double difference(double before, double here, double after, double to_before, double to_after) {
    if (std::isnan(before) && std::isnan(after)) return 0;
    if (std::isnan(before)) return (after - here) / to_after;
    if (std::isnan(after)) return (here - before) / to_before;
    return (after - before) / (to_before + to_after);
}

/// Mottling by place: several octaves of Perlin noise, about −1 to 1.
class Mottling {
  public:
    explicit Mottling(std::span<const Point> places) : noise_(1988) {
        Range x, y;
        for (const Point& p : places) {
            x.add(p.x);
            y.add(p.y);
        }
        origin_ = {x.low, y.low};
        per_metre_ = 12 / std::max(x.size(), y.size());
    }

    double operator()(const Point& p) const {
        double sum = 0, frequency = per_metre_, weight = 1;
        for (int octave = 0; octave < 6; ++octave) {
            sum += weight *
                   noise_((p.x - origin_.x) * frequency + 17.3 * octave, (p.y - origin_.y) * frequency + 5.7 * octave);
            frequency *= 2.1;
            weight *= 0.62;
        }
        return sum;
    }

  private:
    evolve::PerlinNoise noise_;
    Point origin_;
    double per_metre_;
};

struct Lines {
    double trees, snow;
    double blur;  ///< m
};

/// About the height of the snow line in the Alps and the Rocky Mountains: hills of 1000 m are not to be white because
/// nothing around is higher.
constexpr double lowest_usual_snow_m = 3000;

Lines lines_of(const Nature& nature, const Range& heights) {
    return {.trees = nature.tree_line_m.value_or(heights.low + 2.0 / 3 * heights.size()),
            .snow = nature.snow_line_m.value_or(std::max(lowest_usual_snow_m, heights.low + 0.85 * heights.size())),
            .blur = 0.06 * heights.size()};
}

Rgb natural_color(double height, double gradient, double water, double mottle, const Lines& lines) {
    static const Rgb meadow = from_srgb(0x8f9c5a), dry = from_srgb(0xb3a772), forest = from_srgb(0x4c6536),
                     dark_forest = from_srgb(0x38512f), heath = from_srgb(0x9a8f63), rock = from_srgb(0x9a9088),
                     dark_rock = from_srgb(0x77706a), snow = from_srgb(0xf5f8fc), river = from_srgb(0x33658c);
    const auto blend = [](const Rgb& a, const Rgb& b, double share) { return mix(a, b, static_cast<float>(share)); };
    const Rgb grass = blend(meadow, dry, step(-0.3, 0.6, mottle));
    const Rgb trees = blend(forest, dark_forest, step(-0.4, 0.4, mottle));
    Rgb color = blend(grass, trees, step(0.08, 0.28, gradient + 0.12 * mottle));
    color = blend(color, heath, step(lines.trees - lines.blur, lines.trees + lines.blur, height + lines.blur * mottle));
    const Rgb bare = blend(rock, dark_rock, step(-0.2, 0.7, mottle));
    color = blend(color, bare, step(std::tan(30 * degree), std::tan(42 * degree), gradient + 0.1 * mottle));
    const double holds_snow = 1 - step(std::tan(45 * degree), std::tan(58 * degree), gradient);
    const double snowy =
        step(lines.snow - lines.blur / 2, lines.snow + lines.blur / 2, height + lines.blur * mottle / 2);
    color = blend(color, snow, snowy * holds_snow);
    return blend(color, river, water);
}

}  // namespace

std::vector<double> gradients(const Grid& grid, std::span<const double> heights_m) {
    std::vector<double> gradient(grid.size(), std::numeric_limits<double>::quiet_NaN());
    const double nan = std::numeric_limits<double>::quiet_NaN();
    parallel_for(
        0, grid.rows,
        [&](Index first, Index last) {
            for (Index row = first; row < last; ++row) {
                for (Index col = 0; col < grid.cols; ++col) {
                    const Index i = row * grid.cols + col;
                    const double here = heights_m[i];
                    if (std::isnan(here)) continue;
                    const double east_west = grid.east_west[row];
                    const double across =
                        difference(col > 0 ? heights_m[i - 1] : nan, here, col + 1 < grid.cols ? heights_m[i + 1] : nan,
                                   east_west, east_west);
                    const double up = row > 0 ? grid.north_south[row - 1] : 1;
                    const double down = row + 1 < grid.rows ? grid.north_south[row] : 1;
                    const double along = difference(row > 0 ? heights_m[i - grid.cols] : nan, here,
                                                    row + 1 < grid.rows ? heights_m[i + grid.cols] : nan, up, down);
                    gradient[i] = std::hypot(across, along);
                }
            }
        },
        64);
    return gradient;
}

std::vector<Rgb> clay_colors(std::size_t count) { return std::vector<Rgb>(count, from_srgb(0xd8d2c6)); }

std::vector<Rgb> elevation_colors(std::span<const double> heights_m) {
    static const std::array<Rgb, 6> tints{from_srgb(0x5d8a57), from_srgb(0x9fb46b), from_srgb(0xd9cf8e),
                                          from_srgb(0xc19a5e), from_srgb(0x9a7358), from_srgb(0xf2efe9)};
    const Range range = range_of(heights_m);
    std::vector<Rgb> colors;
    colors.reserve(heights_m.size());
    for (const double height : heights_m) {
        if (std::isnan(height)) {
            colors.push_back({});
            continue;
        }
        const double at = (height - range.low) / range.size() * (tints.size() - 1);
        const auto tint = std::min(static_cast<std::size_t>(at), tints.size() - 2);
        colors.push_back(mix(tints[tint], tints[tint + 1], static_cast<float>(at - static_cast<double>(tint))));
    }
    return colors;
}

std::vector<Rgb> natural_colors(const Nature& nature) {
    const Lines lines = lines_of(nature, range_of(nature.heights));
    const Mottling mottling(nature.places);
    std::vector<Rgb> colors(nature.heights.size());
    parallel_for(0, static_cast<Index>(colors.size()), [&](Index first, Index last) {
        for (Index i = first; i < last; ++i) {
            if (std::isnan(nature.heights[i])) continue;
            const double water = nature.water.empty() ? 0 : nature.water[i];
            colors[i] = natural_color(nature.heights[i], nature.gradient[i], water, mottling(nature.places[i]), lines);
        }
    });
    return colors;
}

}  // namespace thalweg::render
