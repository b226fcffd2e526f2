// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <vector>

#include "mesh/outline.hpp"
#include "thalweg/core/index.hpp"
#include "thalweg/core/point.hpp"

namespace thalweg::mesh {

/// The background grid of Bridson (2007): cells whose diagonal is the spacing, so that a cell holds one disk point at
/// most, over the outline's bounding box and a margin of two cells. A cell knows its point, or whether it lies inside
/// the outline. Points on the outline may be closer together: those of one cell are chained.
class DiskGrid {
  public:
    /// Throws Error if the spacing is too fine for 32-bit cell numbers.
    DiskGrid(const Rings& rings, double spacing_m);

    /// Once, before any other point is added.
    void add_outline(const std::vector<Point>& outline_points);

    /// Free of other points within the spacing, and inside the outline.
    bool has_room(const Point& candidate) const;
    /// Numbers the points in the order of adding, after those of the outline.
    void add(const Point& point);

    /// Points of the 21 cells around a cell that can lie within the spacing of a place in it.
    void points_near(Index cell, std::vector<Point>& near) const;
    bool is_inside(const Point& place) const;

    Index cells() const { return static_cast<Index>(cell_.size()); }
    bool is_free(Index cell) const { return cell_[cell] == inside || cell_[cell] == crossed; }
    bool is_crossed(Index cell) const { return cell_[cell] == crossed; }
    Point corner(Index cell) const { return {low_.x + (cell % cols_) * side_, low_.y + (cell / cols_) * side_}; }
    double cell_side() const { return side_; }
    const std::vector<Point>& points() const { return points_; }

  private:
    static constexpr Index outside = none;
    static constexpr Index crossed = none - 1;  ///< no point yet, and the outline passes through
    static constexpr Index inside = none - 2;   ///< no point yet

    Index cell_of(const Point& p) const;
    Index row_of(double y) const { return static_cast<Index>((y - low_.y) / side_); }
    void mark_inside();
    void mark_crossed(std::size_t side);
    void list_sides_by_row();
    bool crowded(Index cell, const Point& candidate) const;

    struct Side {
        Point from, to;
    };
    std::vector<Side> sides_;
    double spacing2_;
    double side_;
    Point low_;
    Index cols_;
    Index rows_;
    std::vector<Index> cell_;
    std::vector<Index> row_start_;  ///< sides that touch row r: row_side_[row_start_[r] … row_start_[r + 1])
    std::vector<Index> row_side_;
    std::vector<Index> next_;  ///< of a point on the outline: another one in its cell, or none
    std::vector<Point> points_;
};

}  // namespace thalweg::mesh
