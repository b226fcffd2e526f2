// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <functional>
#include <span>
#include <vector>

#include "thalweg/core/raster.hpp"

namespace thalweg::surface {

// Which triangle holds a place: one rule for every surface made of triangles.

/// Triangles in the plane. The arrays belong to the caller.
struct Triangulation {
    std::span<const double> x;  ///< m
    std::span<const double> y;  ///< m
    std::span<const std::array<Index, 3>> triangles;

    Point vertex(Index i) const { return {x[i], y[i]}; }
};

/// One triangle, ready to be asked many times.
class TriangleTest {
  public:
    TriangleTest(const Triangulation&, const std::array<Index, 3>& corners);

    /// Unnormalised barycentric coordinates. Each side is always looked at from its lower vertex, so that the triangles
    /// on both of its sides agree to the last bit on which of them a place belongs to.
    std::array<double, 3> coordinates(const Point& p) const { return {side(0, p), side(1, p), side(2, p)}; }

    /// Triangles without area hold nothing.
    static bool holds(const std::array<double, 3>& at) {
        return at[0] >= 0 && at[1] >= 0 && at[2] >= 0 && at[0] + at[1] + at[2] > 0;
    }

    struct Interval {
        double low;
        double high;  ///< under `low`: empty
    };
    double south() const { return south_; }
    double north() const { return north_; }
    /// Where the triangle lies between two heights of y; not less than that.
    Interval between(double y_low, double y_high) const;

  private:
    /// Twice the signed area of the triangle over side k (opposite to corner k) and p.
    double side(int k, const Point& p) const {
        const Side& s = sides_[k];
        return s.sign * (s.dx * (p.y - s.low.y) - s.dy * (p.x - s.low.x));
    }

    struct Side {
        Point low;  ///< lower vertex by number
        double dx, dy;
        double sign;
    };
    std::array<Side, 3> sides_;
    double south_, north_;
};

/// The cells of one triangle, and where their centres lie in it.
struct Claim {
    Index triangle;
    std::vector<Index> cells;
    std::array<std::vector<double>, 3> at;  ///< unnormalised barycentric coordinates
};

/// Gives every cell whose centre lies in a triangle to it, to the one listed first where several hold it. Calls
/// visit(claim) for each triangle with cells, from several threads, more than once for a triangle of many rows.
void cover(const Triangulation&, const Raster&, const std::function<void(const Claim&)>& visit);

/// For every point the triangle that holds it, by the same rule; `none` outside.
std::vector<Index> triangle_of_points(const Triangulation&, std::span<const Point>);

}  // namespace thalweg::surface
