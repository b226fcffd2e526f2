// SPDX-License-Identifier: GPL-3.0-or-later
#include "mesh/disk_grid.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>

#include "thalweg/core/error.hpp"

namespace thalweg::mesh {
namespace {

struct Step {
    int row;
    int col;
};

/// The cells that come within one spacing (√2 cells) of a cell, nearest first: most candidates fail on one of the
/// first.
constexpr std::array<Step, 20> around{{{0, 1},   {0, -1},  {1, 0},  {-1, 0}, {1, 1},  {1, -1}, {-1, 1},
                                       {-1, -1}, {0, 2},   {0, -2}, {2, 0},  {-2, 0}, {1, 2},  {1, -2},
                                       {-1, 2},  {-1, -2}, {2, 1},  {2, -1}, {-2, 1}, {-2, -1}}};

double distance2(const Point& a, const Point& b) { return (a.x - b.x) * (a.x - b.x) + (a.y - b.y) * (a.y - b.y); }

/// Where the line from a to b meets the height y.
double x_at(const Point& a, const Point& b, double y) { return a.x + (y - a.y) * ((b.x - a.x) / (b.y - a.y)); }

}  // namespace

DiskGrid::DiskGrid(const Rings& rings, double spacing_m)
    : spacing2_(spacing_m * spacing_m), side_(spacing_m / std::sqrt(2.0)) {
    for (const Polygon& ring : rings) {
        for (std::size_t i = 0; i < ring.size(); ++i) sides_.push_back({ring[i], ring[(i + 1) % ring.size()]});
    }
    Point low = rings.front().front();
    Point high = low;
    for (const Point& p : rings.front()) {
        low = {std::min(low.x, p.x), std::min(low.y, p.y)};
        high = {std::max(high.x, p.x), std::max(high.y, p.y)};
    }
    low_ = {low.x - 2.5 * side_, low.y - 2.5 * side_};
    const double cols = std::floor((high.x - low_.x) / side_) + 4;
    const double rows = std::floor((high.y - low_.y) / side_) + 4;
    if (!(cols * rows < inside)) {
        throw Error(fmt::format("a spacing of {} m is too fine for an outline {} m wide and {} m high", spacing_m,
                                high.x - low.x, high.y - low.y));
    }
    cols_ = static_cast<Index>(cols);
    rows_ = static_cast<Index>(rows);
    cell_.assign(std::size_t{rows_} * cols_, outside);
    list_sides_by_row();
    mark_inside();
    for (std::size_t i = 0; i < sides_.size(); ++i) mark_crossed(i);
}

Index DiskGrid::cell_of(const Point& p) const {
    return row_of(p.y) * cols_ + static_cast<Index>((p.x - low_.x) / side_);
}

void DiskGrid::list_sides_by_row() {
    row_start_.assign(rows_ + 1, 0);
    const auto visit_rows = [&](auto visit) {
        for (std::size_t i = 0; i < sides_.size(); ++i) {
            const auto [low, high] = std::minmax(sides_[i].from.y, sides_[i].to.y);
            for (Index row = row_of(low); row <= row_of(high); ++row) visit(row, static_cast<Index>(i));
        }
    };
    visit_rows([&](Index row, Index) { ++row_start_[row + 1]; });
    std::partial_sum(row_start_.begin(), row_start_.end(), row_start_.begin());
    row_side_.resize(row_start_.back());
    std::vector<Index> next(row_start_.begin(), row_start_.end() - 1);
    visit_rows([&](Index row, Index side) { row_side_[next[row]++] = side; });
}

/// Even-odd filling at the height of the cells' centres.
void DiskGrid::mark_inside() {
    std::vector<double> crossings;
    for (Index row = 0; row < rows_; ++row) {
        const double y = low_.y + (row + 0.5) * side_;
        crossings.clear();
        for (Index at = row_start_[row]; at < row_start_[row + 1]; ++at) {
            const auto& [a, b] = sides_[row_side_[at]];
            if ((a.y <= y) != (b.y <= y)) crossings.push_back((x_at(a, b, y) - low_.x) / side_ - 0.5);
        }
        std::sort(crossings.begin(), crossings.end());
        for (std::size_t i = 0; i + 1 < crossings.size(); i += 2) {
            const auto first = static_cast<Index>(std::ceil(crossings[i]));
            const auto last = static_cast<Index>(std::ceil(crossings[i + 1]));
            const auto start = cell_.begin() + std::size_t{row} * cols_;
            std::fill(start + first, start + std::max(first, last), inside);
        }
    }
}

/// Marks the cells that a side passes through (a hair more where it follows a border between cells).
void DiskGrid::mark_crossed(std::size_t side) {
    const auto [a, b] =
        std::minmax(sides_[side].from, sides_[side].to, [](const Point& p, const Point& q) { return p.y < q.y; });
    constexpr double hair = 1e-9;
    for (Index row = row_of(a.y - hair * side_); row <= row_of(b.y + hair * side_); ++row) {
        const double bottom = std::max(a.y, low_.y + row * side_);
        const double top = std::min(b.y, low_.y + (row + 1) * side_);
        const bool level = !(a.y < b.y) || !(bottom < top);
        const double x0 = level ? a.x : std::clamp(x_at(a, b, bottom), std::min(a.x, b.x), std::max(a.x, b.x));
        const double x1 = level ? b.x : std::clamp(x_at(a, b, top), std::min(a.x, b.x), std::max(a.x, b.x));
        const auto first = static_cast<Index>((std::min(x0, x1) - low_.x) / side_ - hair);
        const auto last = static_cast<Index>((std::max(x0, x1) - low_.x) / side_ + hair);
        for (Index col = first; col <= last; ++col) cell_[std::size_t{row} * cols_ + col] = crossed;
    }
}

void DiskGrid::add_outline(const std::vector<Point>& outline_points) {
    points_ = outline_points;
    next_.assign(points_.size(), none);
    for (Index i = 0; i < points_.size(); ++i) {
        Index& first = cell_[cell_of(points_[i])];
        if (first < points_.size()) next_[i] = first;
        first = i;
    }
}

bool DiskGrid::crowded(Index cell, const Point& candidate) const {
    Index point = cell_[cell];
    while (point < inside) {
        if (distance2(points_[point], candidate) < spacing2_) return true;
        point = point < next_.size() ? next_[point] : none;
    }
    return false;
}

bool DiskGrid::has_room(const Point& candidate) const {
    if (!(candidate.x > low_.x + 2 * side_) || !(candidate.y > low_.y + 2 * side_)) return false;
    const auto col = static_cast<Index>((candidate.x - low_.x) / side_);
    const Index row = row_of(candidate.y);
    if (col + 2 >= cols_ || row + 2 >= rows_) return false;
    const Index cell = row * cols_ + col;
    if (!is_free(cell)) return false;
    for (const Step& step : around) {
        if (crowded(cell + static_cast<Index>(step.row * static_cast<std::int64_t>(cols_) + step.col), candidate)) {
            return false;
        }
    }
    return !is_crossed(cell) || is_inside(candidate);
}

bool DiskGrid::is_inside(const Point& place) const {
    const Index row = row_of(place.y);
    bool odd = false;
    for (Index at = row_start_[row]; at < row_start_[row + 1]; ++at) {
        const auto& [a, b] = sides_[row_side_[at]];
        if ((a.y <= place.y) != (b.y <= place.y) && x_at(a, b, place.y) <= place.x) odd = !odd;
    }
    return odd;
}

void DiskGrid::add(const Point& point) {
    cell_[cell_of(point)] = static_cast<Index>(points_.size());
    points_.push_back(point);
}

void DiskGrid::points_near(Index cell, std::vector<Point>& near) const {
    near.clear();
    for (const Step& step : around) {
        Index point = cell_[cell + static_cast<Index>(step.row * static_cast<std::int64_t>(cols_) + step.col)];
        while (point < inside) {
            near.push_back(points_[point]);
            point = point < next_.size() ? next_[point] : none;
        }
    }
}

}  // namespace thalweg::mesh
