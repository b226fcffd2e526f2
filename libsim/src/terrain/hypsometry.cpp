// SPDX-License-Identifier: GPL-3.0-or-later
#include "thalweg/terrain/hypsometry.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "terrain/check_sizes.hpp"
#include "thalweg/core/error.hpp"
#include "thalweg/core/parallel.hpp"

namespace thalweg::terrain {
namespace {

constexpr double undefined = std::numeric_limits<double>::quiet_NaN();

/// Cells taken as one step: a single one, or all within a thin slice of the relief.
struct Layer {
    double height_m;  ///< mean of its cells
    double area_m2;
    double highest_m;
};

constexpr std::size_t most_layers = 65536;

/// What the cells are, seen from outside: `visit(height, area)` for each one with data.
struct Range {
    double lowest_m = std::numeric_limits<double>::infinity();
    double highest_m = -std::numeric_limits<double>::infinity();
    std::size_t cells = 0;
};

template <class Cells>
Range range_of(const Cells& cells) {
    Range range;
    cells([&](double height, double) {
        range.lowest_m = std::min(range.lowest_m, height);
        range.highest_m = std::max(range.highest_m, height);
        ++range.cells;
    });
    return range;
}

template <class Cells>
std::vector<Layer> sorted_cells(const Cells& cells, std::size_t count) {
    std::vector<Layer> layers;
    layers.reserve(count);
    cells([&](double height, double area) { layers.push_back({height, area, height}); });
    std::stable_sort(layers.begin(), layers.end(),
                     [](const Layer& a, const Layer& b) { return a.height_m > b.height_m; });
    return layers;
}

/// Slices of equal thickness from the top down, those without cells left out. Their number is a multiple of the curve's
/// steps, so that no slice lies across one of its heights.
template <class Cells>
std::vector<Layer> slices(const Cells& cells, const Range& range, int points) {
    const std::size_t per_step = (most_layers + points - 2) / (points - 1);
    const std::size_t count = per_step * (points - 1) + 1;  // the topmost holds the highest cells alone
    const double scale = static_cast<double>(count - 1) / (range.highest_m - range.lowest_m);
    std::vector<Layer> layers(count, {0, 0, range.lowest_m});
    cells([&](double height, double area) {
        const auto slice = static_cast<std::size_t>((height - range.lowest_m) * scale);
        Layer& layer = layers[count - 1 - std::min(slice, count - 1)];
        layer.height_m += area * (height - range.lowest_m);
        layer.area_m2 += area;
        layer.highest_m = std::max(layer.highest_m, height);
    });
    std::erase_if(layers, [](const Layer& layer) { return !(layer.area_m2 > 0); });
    for (Layer& layer : layers) {
        layer.height_m = std::min(range.lowest_m + layer.height_m / layer.area_m2, layer.highest_m);
    }
    return layers;
}

/// The curve as steps: relative height `height` over the relative areas from `from` to `to`, from the top down.
struct Step {
    double height;
    double highest;  ///< of the step's cells
    double from, to;
};

std::vector<Step> steps_of(const std::vector<Layer>& layers, const Range& range) {
    const double relief = range.highest_m - range.lowest_m;
    double total = 0;
    for (const Layer& layer : layers) total += layer.area_m2;
    std::vector<Step> steps;
    steps.reserve(layers.size());
    double above = 0;
    for (const Layer& layer : layers) {
        const double from = above / total;
        above += layer.area_m2;
        steps.push_back({(layer.height_m - range.lowest_m) / relief, (layer.highest_m - range.lowest_m) / relief, from,
                         above / total});
    }
    return steps;
}

double mean_height(const std::vector<Layer>& layers) {
    double weighted = 0;
    double total = 0;
    for (const Layer& layer : layers) {
        weighted += layer.area_m2 * layer.height_m;
        total += layer.area_m2;
    }
    return weighted / total;
}

/// Area between the curve and the height axis: what each drop from step to step adds reaches over all the area above.
double area_under(const std::vector<Step>& steps) {
    double sum = 0;
    for (std::size_t i = 0; i < steps.size(); ++i) {
        const double below = i + 1 < steps.size() ? steps[i + 1].height : 0;
        sum += (steps[i].height - below) * steps[i].to;
    }
    return sum;
}

/// ∫ (x − center)^power·f(x) dx, f the relative height over the relative area x.
double moment(const std::vector<Step>& steps, double center, int power) {
    double sum = 0;
    for (const Step& step : steps) {
        const double to = std::pow(step.to - center, power + 1);
        const double from = std::pow(step.from - center, power + 1);
        sum += step.height * (to - from) / (power + 1);
    }
    return sum;
}

void add_moments(const std::vector<Step>& steps, Hypsometry& result) {
    const double area = moment(steps, 0, 0);
    const double center = moment(steps, 0, 1) / area;
    const double variance = moment(steps, center, 2) / area;
    result.skewness = moment(steps, center, 3) / area / std::pow(variance, 1.5);
    result.kurtosis = moment(steps, center, 4) / area / (variance * variance);
}

/// ∫ (x − center)^power·(−df/dx) dx: where one step ends and the next begins, the height falls by their difference.
double density_moment(const std::vector<Step>& steps, double center, int power) {
    double sum = 0;
    for (std::size_t i = 0; i + 1 < steps.size(); ++i) {
        sum += (steps[i].height - steps[i + 1].height) * std::pow(steps[i].to - center, power);
    }
    return sum;  // the drops add up to 1
}

void add_density_moments(const std::vector<Step>& steps, Hypsometry& result) {
    const double center = density_moment(steps, 0, 1);
    const double variance = density_moment(steps, center, 2);
    if (!(variance > 0)) return;  // two heights: all is lost at one place
    result.density_skewness = density_moment(steps, center, 3) / std::pow(variance, 1.5);
    result.density_kurtosis = density_moment(steps, center, 4) / (variance * variance);
}

/// Share of the area at or above each relative height.
void add_curve(const std::vector<Step>& steps, int points, Hypsometry& result) {
    std::size_t reached = steps.size();
    for (int i = 0; i < points; ++i) {
        const double height = static_cast<double>(i) / (points - 1);
        while (reached > 0 && steps[reached - 1].highest < height) --reached;
        result.relative_height.push_back(height);
        result.relative_area.push_back(reached > 0 ? steps[reached - 1].to : 0);
    }
}

template <class Cells>
Hypsometry hypsometry_of(const Cells& cells, int points) {
    Hypsometry result{undefined, undefined, undefined, undefined, undefined, undefined,
                      undefined, undefined, undefined, {},        {}};
    const Range range = range_of(cells);
    if (range.cells == 0) return result;
    result.minimum_m = range.lowest_m;
    result.maximum_m = range.highest_m;
    const bool level = range.highest_m == range.lowest_m;
    const std::vector<Layer> layers =
        level || range.cells <= most_layers ? sorted_cells(cells, range.cells) : slices(cells, range, points);
    result.mean_m = mean_height(layers);
    if (level) return result;
    result.integral = (result.mean_m - result.minimum_m) / (result.maximum_m - result.minimum_m);
    const std::vector<Step> steps = steps_of(layers, range);
    result.integral_by_curve = area_under(steps);
    add_moments(steps, result);
    add_density_moments(steps, result);
    add_curve(steps, points, result);
    return result;
}

void check_points(int points) {
    if (points < 2) throw Error(fmt::format("a hypsometric curve needs at least 2 heights, not {}", points));
}

}  // namespace

Hypsometry hypsometry(std::span<const double> elevation_m, const CellAreas& cell_area_m2, int points) {
    check_sizes(static_cast<Index>(elevation_m.size()), elevation_m.size(), cell_area_m2.size());
    check_points(points);
    const auto cells = [&](auto visit) {
        for (std::size_t node = 0; node < elevation_m.size(); ++node) {
            if (!std::isnan(elevation_m[node])) visit(elevation_m[node], cell_area_m2[node]);
        }
    };
    return hypsometry_of(cells, points);
}

std::vector<Hypsometry> hypsometries(std::span<const double> elevation_m, const CellAreas& cell_area_m2,
                                     std::span<const Index> offset, std::span<const Index> nodes, int points) {
    check_sizes(static_cast<Index>(elevation_m.size()), elevation_m.size(), cell_area_m2.size());
    check_points(points);
    std::vector<Hypsometry> all(offset.empty() ? 0 : offset.size() - 1);
    const auto measure = [&](Index first, Index last) {
        for (Index basin = first; basin < last; ++basin) {
            const auto own = nodes.subspan(offset[basin], offset[basin + 1] - offset[basin]);
            const auto cells = [&](auto visit) {
                for (const Index node : own) {
                    if (!std::isnan(elevation_m[node])) visit(elevation_m[node], cell_area_m2[node]);
                }
            };
            all[basin] = hypsometry_of(cells, points);
        }
    };
    parallel_for(0, static_cast<Index>(all.size()), measure, 1);
    return all;
}

}  // namespace thalweg::terrain
