// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/raster_survey.hpp"

#include "thalweg/io/raster_file.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <optional>
#include <span>

namespace thalweg::io {
namespace {

struct Heights {
    std::size_t count = 0;
    std::size_t negative = 0;
    std::size_t above_mountains = 0;
    double lowest = std::numeric_limits<double>::infinity();
    double highest = -std::numeric_limits<double>::infinity();
};

constexpr double above_all_mountains_m = 9000;  // Mount Everest: 8849

Heights summarise(std::span<const double> values) {
    Heights heights;
    for (const double value : values) {
        if (std::isnan(value)) continue;
        ++heights.count;
        heights.negative += value < 0;
        heights.above_mountains += value > above_all_mountains_m;
        heights.lowest = std::min(heights.lowest, value);
        heights.highest = std::max(heights.highest, value);
    }
    return heights;
}

/// Valid values along the outer edge of the grid, sorted.
std::vector<double> rim_values(const Raster& raster) {
    const Grid& grid = raster.grid;
    std::vector<double> rim;
    const auto add = [&](Index row, Index col) {
        const double value = raster.values[row * grid.cols + col];
        if (!std::isnan(value)) rim.push_back(value);
    };
    for (Index col = 0; col < grid.cols; ++col) add(0, col), add(grid.rows - 1, col);
    for (Index row = 1; row + 1 < grid.rows; ++row) add(row, 0), add(row, grid.cols - 1);
    std::sort(rim.begin(), rim.end());
    return rim;
}

std::optional<double> most_frequent(const std::vector<double>& sorted) {
    std::size_t longest = 1;
    std::optional<double> value;
    for (std::size_t first = 0; first < sorted.size();) {
        std::size_t last = first;
        while (last < sorted.size() && sorted[last] == sorted[first]) ++last;
        if (last - first > longest) longest = last - first, value = sorted[first];
        first = last;
    }
    return value;
}

/// Median height difference between cells of `value` and their neighbours of another height; 0 if there are none.
double median_step(const Raster& raster, double value) {
    const Grid& grid = raster.grid;
    std::vector<double> steps;
    const auto compare = [&](double a, double b) {
        if ((a == value) != (b == value) && !std::isnan(a) && !std::isnan(b)) steps.push_back(std::abs(a - b));
    };
    for (Index node = 0; node < grid.size(); ++node) {
        if (grid.col(node) + 1 < grid.cols) compare(raster.values[node], raster.values[node + 1]);
        if (node + grid.cols < grid.size()) compare(raster.values[node], raster.values[node + grid.cols]);
    }
    if (steps.empty()) return 0;
    const auto middle = steps.begin() + static_cast<std::ptrdiff_t>(steps.size() / 2);
    std::nth_element(steps.begin(), middle, steps.end());
    return *middle;
}

/// A flat margin as an undeclared "no data" or a sea makes it: on the rim, at least one cell in a hundred, and either
/// the extreme of all heights or zero. A cliff around it (a twentieth of the relief) tells the former from a shore.
std::optional<std::string> flat_margin(const Raster& raster, const Heights& heights, double value,
                                       const std::string& name) {
    if (value != heights.lowest && value != heights.highest && value != 0) return std::nullopt;
    const auto cells = static_cast<double>(std::count(raster.values.begin(), raster.values.end(), value));
    const double share = cells / static_cast<double>(heights.count);
    if (share < 0.01) return std::nullopt;
    const double step = median_step(raster, value);
    const bool cliff = step > 0.05 * (heights.highest - heights.lowest);
    return fmt::format(
        "{:.1f} % of the cells of {}, reaching its edge, are exactly {}{}: they are measured as land; if "
        "they are {}, give --nodata {}",
        100 * share, name, value,
        cliff ? fmt::format(" and stand in a cliff of typically {:.3g} m against the rest", step) : "",
        cliff ? "outside the survey or sea" : "sea, a lake or outside the survey", value);
}

/// Marks all no-data cells that hang together with the edge of the grid by sides or corners.
std::vector<std::uint8_t> outside_cells(const Raster& raster) {
    const Grid& grid = raster.grid;
    std::vector<std::uint8_t> outside(grid.size(), 0);
    std::vector<Index> stack;
    const auto reach = [&](Index node) {
        if (outside[node] || !std::isnan(raster.values[node])) return;
        outside[node] = 1;
        stack.push_back(node);
    };
    for (Index col = 0; col < grid.cols; ++col) reach(col), reach(grid.size() - 1 - col);
    for (Index row = 0; row < grid.rows; ++row) reach(row * grid.cols), reach(row * grid.cols + grid.cols - 1);
    while (!stack.empty()) {
        const Index node = stack.back();
        stack.pop_back();
        grid.neighbors(node, [&](Index other, double, Slot) { reach(other); });
    }
    return outside;
}

/// Cells of the holes that touch the part.
std::size_t cells_beside(const Raster& raster, std::span<const std::uint8_t> part) {
    std::vector<std::uint8_t> seen = outside_cells(raster);
    std::vector<Index> stack;
    std::size_t cells = 0;
    const auto reach = [&](Index node) {
        if (seen[node] || !std::isnan(raster.values[node])) return;
        seen[node] = 1;
        ++cells;
        stack.push_back(node);
    };
    for (Index node = 0; node < raster.grid.size(); ++node) {
        if (part[node]) raster.grid.neighbors(node, [&](Index other, double, Slot) { reach(other); });
    }
    while (!stack.empty()) {
        const Index node = stack.back();
        stack.pop_back();
        raster.grid.neighbors(node, [&](Index other, double, Slot) { reach(other); });
    }
    return cells;
}

std::size_t cells_in_holes(const Raster& raster) {
    const std::vector<std::uint8_t> outside = outside_cells(raster);
    std::size_t cells = 0;
    for (Index node = 0; node < raster.grid.size(); ++node) cells += !outside[node] && std::isnan(raster.values[node]);
    return cells;
}

}  // namespace

Index void_cells_beside(const Raster& raster, std::span<const std::uint8_t> part) {
    return static_cast<Index>(cells_beside(raster, part));
}

HeightsNoticed notice_heights(const Raster& raster, const std::string& name) {
    HeightsNoticed noticed;
    std::vector<std::string>& warnings = noticed.warnings;
    const auto warn = [&](const std::optional<std::string>& text) {
        if (text) warnings.push_back(*text);
    };
    const Heights heights = summarise(raster.values);
    if (heights.lowest == heights.highest) {
        warn(fmt::format("all cells of {} are at {} m: a plain has no drainage to measure", name, heights.lowest));
        return noticed;
    }
    const std::vector<double> rim = rim_values(raster);
    const std::optional<double> frequent = most_frequent(rim);
    if (frequent) warn(flat_margin(raster, heights, *frequent, name));
    if (frequent != 0.0 && std::binary_search(rim.begin(), rim.end(), 0.0)) {
        warn(flat_margin(raster, heights, 0, name));
    }
    if (heights.negative > 0) {
        warn(fmt::format("{} cells of {} lie below 0 m, the lowest at {} m: land below the sea, or errors",
                         heights.negative, name, heights.lowest));
    }
    if (heights.above_mountains > 0) {
        warn(
            fmt::format("{} cells of {} lie above {} m, higher than any mountain, the highest at {} m: errors, a value "
                        "for no data (--nodata), another unit than metres, or not the earth",
                        heights.above_mountains, name, above_all_mountains_m, heights.highest));
    }
    const std::size_t holes = heights.count < raster.values.size() ? cells_in_holes(raster) : 0;
    noticed.void_cells = static_cast<Index>(holes);
    if (holes > 0) {
        warn(
            fmt::format("{} cells of {} are holes of no data inside the terrain: water that reaches one leaves the map "
                        "there (gdal_fillnodata.py closes them)",
                        holes, name));
    }
    return noticed;
}

}  // namespace thalweg::io
