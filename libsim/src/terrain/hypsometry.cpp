// SPDX-License-Identifier: GPL-3.0-or-later
#include "thalweg/terrain/hypsometry.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "terrain/check_sizes.hpp"

namespace thalweg::terrain {
namespace {

constexpr double undefined = std::numeric_limits<double>::quiet_NaN();

struct Cell {
    double height_m;
    double area_m2;
};

std::vector<Cell> cells_from_the_top(std::span<const double> elevation_m, std::span<const double> cell_area_m2) {
    std::vector<Cell> cells;
    cells.reserve(elevation_m.size());
    for (std::size_t i = 0; i < elevation_m.size(); ++i) {
        if (!std::isnan(elevation_m[i])) cells.push_back({elevation_m[i], cell_area_m2[i]});
    }
    std::stable_sort(cells.begin(), cells.end(), [](const Cell& a, const Cell& b) { return a.height_m > b.height_m; });
    return cells;
}

/// The curve as steps: relative height `height` over the relative areas from `from` to `to`, from the top down.
struct Step {
    double height;
    double from, to;
};

std::vector<Step> steps_of(const std::vector<Cell>& cells) {
    const double lowest = cells.back().height_m;
    const double relief = cells.front().height_m - lowest;
    double total = 0;
    for (const Cell& cell : cells) total += cell.area_m2;
    std::vector<Step> steps;
    steps.reserve(cells.size());
    double above = 0;
    for (const Cell& cell : cells) {
        const double from = above / total;
        above += cell.area_m2;
        steps.push_back({(cell.height_m - lowest) / relief, from, above / total});
    }
    return steps;
}

double mean_height(const std::vector<Cell>& cells) {
    double weighted = 0;
    double total = 0;
    for (const Cell& cell : cells) {
        weighted += cell.area_m2 * cell.height_m;
        total += cell.area_m2;
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

/// Share of the area at or above each relative height.
void add_curve(const std::vector<Step>& steps, int points, Hypsometry& result) {
    std::size_t reached = steps.size();
    for (int i = 0; i < points; ++i) {
        const double height = static_cast<double>(i) / (points - 1);
        while (reached > 0 && steps[reached - 1].height < height) --reached;
        result.relative_height.push_back(height);
        result.relative_area.push_back(reached > 0 ? steps[reached - 1].to : 0);
    }
}

}  // namespace

Hypsometry hypsometry(std::span<const double> elevation_m, std::span<const double> cell_area_m2, int points) {
    check_sizes(static_cast<Index>(elevation_m.size()), elevation_m.size(), cell_area_m2.size());
    if (points < 2) throw Error(fmt::format("a hypsometric curve needs at least 2 heights, not {}", points));
    Hypsometry result{undefined, undefined, undefined, undefined, undefined, undefined, undefined, {}, {}};
    const std::vector<Cell> cells = cells_from_the_top(elevation_m, cell_area_m2);
    if (cells.empty()) return result;
    result.minimum_m = cells.back().height_m;
    result.maximum_m = cells.front().height_m;
    result.mean_m = mean_height(cells);
    if (result.maximum_m == result.minimum_m) return result;
    result.integral = (result.mean_m - result.minimum_m) / (result.maximum_m - result.minimum_m);
    const std::vector<Step> steps = steps_of(cells);
    result.integral_by_curve = area_under(steps);
    add_moments(steps, result);
    add_curve(steps, points, result);
    return result;
}

}  // namespace thalweg::terrain
