// SPDX-License-Identifier: GPL-3.0-or-later
#include "study/water.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "thalweg/core/error.hpp"
#include "thalweg/io/line_file.hpp"
#include "thalweg/study/measure.hpp"
#include "thalweg/terrain/accumulate.hpp"
#include "thalweg/terrain/flats.hpp"
#include "thalweg/terrain/lakes.hpp"
#include "thalweg/terrain/route.hpp"

namespace thalweg::study {
namespace {

class Brush {
  public:
    explicit Brush(const Grid& grid)
        : grid_(grid), water_(grid.size(), 0.0), unit_(std::max(grid.rows, grid.cols) / 1000.0) {}

    /// A disc about a place counted in cells from the north-west corner, `tenfold` the power of ten by which the
    /// drainage area exceeds the channels' smallest.
    void paint(double col, double row, double tenfold) {
        const double radius = std::max(0.35, unit_ * (0.5 + 0.75 * tenfold));
        const Range rows = cells(row - radius - 1, row + radius + 1, grid_.rows);
        const Range cols = cells(col - radius - 1, col + radius + 1, grid_.cols);
        for (Index r = rows.first; r < rows.last; ++r) {
            for (Index c = cols.first; c < cols.last; ++c) {
                double& here = water_[std::size_t{r} * grid_.cols + c];
                const double away = std::hypot(c + 0.5 - col, r + 0.5 - row);
                here = std::max(here, std::clamp(radius + 0.5 - away, 0.0, 1.0));
            }
        }
        touched_ = touched_ || (rows.first < rows.last && cols.first < cols.last);
    }

    bool touched() const { return touched_; }
    std::vector<double> take() { return std::move(water_); }

  private:
    struct Range {
        Index first, last;
    };
    static Range cells(double low, double high, Index count) {
        return {static_cast<Index>(std::clamp(std::floor(low), 0.0, double(count))),
                static_cast<Index>(std::clamp(std::ceil(high), 0.0, double(count)))};
    }

    const Grid& grid_;
    std::vector<double> water_;
    double unit_;  ///< cells
    bool touched_ = false;
};

std::vector<double> drainage_area(const Raster& raster) {
    const auto boundary = terrain::data_edge(raster.grid, raster.values);
    const std::vector<double> filled = terrain::fill(raster.grid, raster.values, boundary);
    FlowDirections directions = terrain::route(raster.grid, filled, boundary);
    terrain::resolve_flats(raster.grid, filled, boundary, directions);
    return terrain::graph_and_area(raster.grid, filled, std::move(directions)).drainage_area_m2;
}

/// As elsewhere, but never under 50 cells: on a small DEM a share of its area is a cell or two, and all would be water.
double painted_channel_area(const Raster& raster) {
    const double area = data_area(raster);
    const auto void_cells =
        std::count_if(raster.values.begin(), raster.values.end(), [](double z) { return std::isnan(z); });
    const double cell = area / static_cast<double>(raster.values.size() - static_cast<std::size_t>(void_cells));
    return std::max(default_channel_area(area), 50 * cell);
}

}  // namespace

std::vector<double> water_of_flow(const Raster& raster, std::optional<double> threshold_m2) {
    const double threshold = threshold_m2.value_or(painted_channel_area(raster));
    const std::vector<double> area = drainage_area(raster);
    Brush brush(raster.grid);
    for (Index node = 0; node < raster.grid.size(); ++node) {
        if (std::isnan(raster.values[node]) || !(area[node] >= threshold)) continue;
        brush.paint(raster.grid.col(node) + 0.5, raster.grid.row(node) + 0.5, std::log10(area[node] / threshold));
    }
    return brush.take();
}

std::vector<double> water_of_lines(const Raster& raster, const std::filesystem::path& path) {
    const std::vector<io::DrainageLine> lines = io::read_drainage_lines(path);
    double smallest = std::numeric_limits<double>::infinity();
    for (const auto& line : lines) {
        if (line.area_m2 > 0) smallest = std::min(smallest, line.area_m2);
    }
    Brush brush(raster.grid);
    const Placement& place = raster.placement;
    for (const auto& line : lines) {
        const double tenfold = line.area_m2 > 0 ? std::log10(line.area_m2 / smallest) : 0;
        for (std::size_t i = 0; i + 1 < line.points.size(); ++i) {
            const Point &a = line.points[i], &b = line.points[i + 1];
            const double col = (a.x - place.west) / place.cell_width, row = (place.north - a.y) / place.cell_height;
            const double across = (b.x - a.x) / place.cell_width, down = (a.y - b.y) / place.cell_height;
            // Beyond the raster nothing is painted, however long the line.
            const double pieces = std::clamp(std::ceil(2 * std::hypot(across, down)), 1.0, 1e6);
            for (double k = 0; k <= pieces; ++k) {
                brush.paint(col + k / pieces * across, row + k / pieces * down, tenfold);
            }
        }
    }
    if (!brush.touched()) {
        throw Error(fmt::format("no line of {} crosses the terrain: its coordinates must be the DEM's", path.string()));
    }
    return brush.take();
}

}  // namespace thalweg::study
