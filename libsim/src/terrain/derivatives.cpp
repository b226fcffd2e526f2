// SPDX-License-Identifier: GPL-3.0-or-later
#include "thalweg/terrain/derivatives.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <numbers>

#include "thalweg/core/error.hpp"
#include "thalweg/core/parallel.hpp"

namespace thalweg::terrain {
namespace {

constexpr double nan = std::numeric_limits<double>::quiet_NaN();
constexpr double infinity = std::numeric_limits<double>::infinity();

/// Distances that hold for the cells of one row.
struct RowMeasure {
    double width, height;  ///< of a cell, m
    double bend;           ///< of the rows: relative change of the width per metre northward, 1/m; 0 on a plane
};

RowMeasure measure_of(const Grid& grid, Index row) {
    const double height = 0.5 * (grid.north_south[row - 1] + grid.north_south[row]);
    const double width = grid.east_west[row];
    return {width, height, (grid.east_west[row - 1] - grid.east_west[row + 1]) / (2 * height * width)};
}

/// The 3 × 3 heights around a cell, row by row from the north-west.
struct Window {
    const double *north, *middle, *south;

    bool known() const {
        return !std::isnan(north[-1] + north[0] + north[1] + middle[-1] + middle[0] + middle[1] + south[-1] + south[0] +
                           south[1]);
    }
};

/// What `cell` makes of each window that holds nine heights.
template <class Cell>
std::vector<double> of_windows(const Grid& grid, std::span<const double> elevation_m, Cell cell) {
    if (elevation_m.size() != grid.size()) {
        throw Error(fmt::format("{} heights do not fill a grid of {} cells", elevation_m.size(), grid.size()));
    }
    std::vector<double> values(grid.size(), nan);
    if (grid.rows < 3 || grid.cols < 3) return values;
    parallel_for(
        1, grid.rows - 1,
        [&](Index first, Index last) {
            for (Index row = first; row < last; ++row) {
                const RowMeasure measure = measure_of(grid, row);
                const std::size_t start = std::size_t{row} * grid.cols;
                for (Index col = 1; col + 1 < grid.cols; ++col) {
                    const double* const here = elevation_m.data() + start + col;
                    const Window window{here - grid.cols, here, here + grid.cols};
                    if (window.known()) values[start + col] = cell(window, measure);
                }
            }
        },
        16);
    return values;
}

struct Gradient {
    double east, north;
};

Gradient horn(const Window& w, const RowMeasure& m) {
    const double east = (w.north[1] - w.north[-1]) + 2 * (w.middle[1] - w.middle[-1]) + (w.south[1] - w.south[-1]);
    const double north = (w.north[-1] - w.south[-1]) + 2 * (w.north[0] - w.south[0]) + (w.north[1] - w.south[1]);
    return {east / (8 * m.width), north / (8 * m.height)};
}

struct Quadric {
    double p, q;     ///< gradient east, north
    double r, s, t;  ///< second derivatives east–east, east–north, north–north
};

Quadric quadric(const Window& w, const RowMeasure& m) {
    // Heights over the middle one: on high land the second differences would lose their last digits.
    const double z = w.middle[0];
    const double nw = w.north[-1] - z, n = w.north[0] - z, ne = w.north[1] - z;
    const double sw = w.south[-1] - z, s = w.south[0] - z, se = w.south[1] - z;
    const double west = w.middle[-1] - z, east = w.middle[1] - z;
    const double p = (ne + east + se - nw - west - sw) / (6 * m.width);
    const double q = (nw + n + ne - sw - s - se) / (6 * m.height);
    const double along = (nw + ne + west + east + sw + se - 2 * (n + s)) / (3 * m.width * m.width);
    const double across = (nw + n + ne + sw + s + se - 2 * (west + east)) / (3 * m.height * m.height);
    const double twist = (ne + sw - nw - se) / (4 * m.width * m.height);
    // Second derivatives along a row that bends, and of a width that changes, as a surface on the ellipsoid has them.
    return {p, q, along + m.bend * q, twist - m.bend * p, across};
}

constexpr double tolerance = 1e-6;  ///< of a cell

/// Half the width, in cells, of a circle where it crosses a row so far away.
std::int64_t half_width(const Grid& grid, Index row, double distance_m, double radius_m) {
    const double half_m = std::sqrt(std::max(0.0, radius_m * radius_m - distance_m * distance_m));
    // Rounding must not decide whether a middle on the circle is inside.
    return std::min<std::int64_t>(static_cast<std::int64_t>(half_m / grid.east_west[row] + tolerance), grid.cols);
}

/// Highest (or with the signs turned lowest) heights of windows of a row. Level k holds that of 2^k cells from each on.
class RowHighest {
  public:
    RowHighest(std::span<const double> heights, double sign, std::int64_t widest) : pad_(widest) {
        std::vector<double> padded(heights.size() + 2 * static_cast<std::size_t>(widest), -infinity);
        for (std::size_t col = 0; col < heights.size(); ++col) {
            if (!std::isnan(heights[col])) padded[static_cast<std::size_t>(widest) + col] = sign * heights[col];
        }
        levels_.push_back(std::move(padded));
        for (std::size_t span = 1; 2 * span <= 2 * static_cast<std::size_t>(widest) + 1; span *= 2) {
            const std::vector<double>& below = levels_.back();
            std::vector<double> level(below);
            for (std::size_t i = 0; i + span < below.size(); ++i) level[i] = std::max(below[i], below[i + span]);
            levels_.push_back(std::move(level));
        }
    }

    /// Raises `highest` to that of the cells up to `half` to both sides of each.
    void raise(std::span<double> highest, std::int64_t half) const {
        const auto cells = static_cast<std::size_t>(2 * half + 1);
        const auto level = static_cast<std::size_t>(std::bit_width(cells) - 1);
        const double* const left = levels_[level].data() + (pad_ - half);
        const double* const right = left + (cells - (std::size_t{1} << level));
        for (std::size_t col = 0; col < highest.size(); ++col) {
            highest[col] = std::max(highest[col], std::max(left[col], right[col]));
        }
    }

  private:
    std::int64_t pad_;
    std::vector<std::vector<double>> levels_;
};

/// Middles of the rows on a meridian, m southward from the first.
std::vector<double> row_places(const Grid& grid) {
    std::vector<double> place(grid.rows, 0);
    for (Index row = 1; row < grid.rows; ++row) place[row] = place[row - 1] + grid.north_south[row - 1];
    return place;
}

}  // namespace

std::vector<double> slope(const Grid& grid, std::span<const double> elevation_m) {
    return of_windows(grid, elevation_m, [](const Window& window, const RowMeasure& measure) {
        const auto [east, north] = horn(window, measure);
        return std::hypot(east, north);
    });
}

std::vector<double> aspect(const Grid& grid, std::span<const double> elevation_m) {
    return of_windows(grid, elevation_m, [](const Window& window, const RowMeasure& measure) {
        const auto [east, north] = horn(window, measure);
        if (east == 0 && north == 0) return nan;
        const double turned = std::atan2(-east, -north);
        const double clockwise = turned < 0 ? turned + 2 * std::numbers::pi : turned;
        return clockwise < 2 * std::numbers::pi ? clockwise : 0.0;
    });
}

std::vector<double> profile_curvature(const Grid& grid, std::span<const double> elevation_m) {
    return of_windows(grid, elevation_m, [](const Window& window, const RowMeasure& measure) {
        const auto [p, q, r, s, t] = quadric(window, measure);
        const double steep = p * p + q * q;
        if (steep == 0) return nan;
        return -(p * p * r + 2 * p * q * s + q * q * t) / (steep * (1 + steep) * std::sqrt(1 + steep));
    });
}

std::vector<double> plan_curvature(const Grid& grid, std::span<const double> elevation_m) {
    return of_windows(grid, elevation_m, [](const Window& window, const RowMeasure& measure) {
        const auto [p, q, r, s, t] = quadric(window, measure);
        const double steep = p * p + q * q;
        if (steep == 0) return nan;
        return -(q * q * r - 2 * p * q * s + p * p * t) / (steep * std::sqrt(steep));
    });
}

std::vector<double> local_relief(const Grid& grid, std::span<const double> elevation_m, double radius_m) {
    if (!(radius_m > 0) || !std::isfinite(radius_m)) {
        throw Error(fmt::format("the radius of local relief must be above zero, not {} m", radius_m));
    }
    const std::vector<double> place = row_places(grid);
    const double reach = radius_m + (grid.rows > 1 ? tolerance * grid.north_south.front() : 0);
    std::vector<double> highest(grid.size(), -infinity), depth(grid.size(), -infinity);
    // Rows give their heights to the rows around; each piece of rows takes from all that reach it.
    const auto take = [&](Index first, Index last, Index from) {
        const auto [near, far] = std::minmax({place[first], place[last - 1]});
        if (place[from] < near - reach || place[from] > far + reach) return;
        const auto heights = elevation_m.subspan(std::size_t{from} * grid.cols, grid.cols);
        const std::int64_t widest = half_width(grid, from, 0, radius_m);
        const RowHighest up(heights, 1, widest), down(heights, -1, widest);
        for (Index row = first; row < last; ++row) {
            const double away = std::abs(place[row] - place[from]);
            if (away > reach) continue;
            const std::size_t start = std::size_t{row} * grid.cols;
            const std::int64_t half = half_width(grid, from, away, radius_m);
            up.raise(std::span(highest).subspan(start, grid.cols), half);
            down.raise(std::span(depth).subspan(start, grid.cols), half);
        }
    };
    parallel_for(
        0, grid.rows,
        [&](Index first, Index last) {
            for (Index from = 0; from < grid.rows; ++from) take(first, last, from);
        },
        64);
    for (Index node = 0; node < grid.size(); ++node) {
        highest[node] = std::isnan(elevation_m[node]) ? nan : highest[node] + depth[node];
    }
    return highest;
}

}  // namespace thalweg::terrain
