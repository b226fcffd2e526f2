// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <array>
#include <cmath>

#include "mesh/disk_grid.hpp"
#include "mesh/fill.hpp"
#include "thalweg/core/random.hpp"

namespace thalweg::mesh {
namespace {

/// 32 random bits at a time, four from each call of the generator.
class Draws {
  public:
    explicit Draws(std::uint64_t seed)
        : key_{static_cast<std::uint32_t>(seed), static_cast<std::uint32_t>(seed >> 32)} {}

    /// Uniform in [−1, 1).
    double signed_uniform() {
        if (used_ == 4) refill();
        return static_cast<std::int32_t>(words_[used_++]) * 0x1p-31;
    }

  private:
    void refill() {
        words_ =
            philox({static_cast<std::uint32_t>(number_), static_cast<std::uint32_t>(number_ >> 32), stream, 0}, key_);
        ++number_;
        used_ = 0;
    }
    static constexpr std::uint32_t stream = 0x706f696e;
    std::array<std::uint32_t, 2> key_;
    std::array<std::uint32_t, 4> words_{};
    std::uint64_t number_ = 0;
    std::size_t used_ = 4;
};

/// Uniform in the ring between one and two spacings around the centre: no sine, the same bits on every machine.
Point draw_in_ring(const Point& center, double spacing, Draws& draws) {
    for (;;) {
        const double x = 2 * draws.signed_uniform();
        const double y = 2 * draws.signed_uniform();
        const double square = x * x + y * y;
        if (square >= 1 && square <= 4) return {center.x + x * spacing, center.y + y * spacing};
    }
}

/// Bridson's front, the newest point first: neighbours in time are neighbours in space, and so in the cache.
void grow_front(DiskGrid& grid, double spacing, Draws& draws) {
    constexpr int attempts = 6;  // gaps are filled afterwards, so Bridson's 30 would be wasted
    std::vector<Index> front(grid.points().size());
    for (Index i = 0; i < front.size(); ++i) front[i] = i;
    while (!front.empty()) {
        const Point center = grid.points()[front.back()];
        bool found = false;
        for (int attempt = 0; attempt < attempts && !found; ++attempt) {
            const Point candidate = draw_in_ring(center, spacing, draws);
            if (!grid.has_room(candidate)) continue;
            front.push_back(static_cast<Index>(grid.points().size()));
            grid.add(candidate);
            found = true;
        }
        if (!found) front.pop_back();
    }
}

struct Square {
    Point low;
    double side;
    int level;
};

/// Whether the disc of one of the points covers the whole square.
bool is_covered(const Square& square, const std::vector<Point>& points, double spacing2) {
    const double half = square.side / 2;
    return std::any_of(points.begin(), points.end(), [&](const Point& p) {
        const double dx = std::abs(square.low.x + half - p.x) + half;
        const double dy = std::abs(square.low.y + half - p.y) + half;
        return dx * dx + dy * dy < spacing2;
    });
}

bool is_clear(const Point& dart, const std::vector<Point>& points, double spacing2) {
    return std::none_of(points.begin(), points.end(), [&](const Point& p) {
        return (dart.x - p.x) * (dart.x - p.x) + (dart.y - p.y) * (dart.y - p.y) < spacing2;
    });
}

/// Fills what room is left in one cell (the quartering of Ebeida et al. 2012): throw a dart into each square that no
/// disc covers; where it fails, quarter the square.
void fill_cell(DiskGrid& grid, Index cell, double spacing2, Draws& draws, std::vector<Point>& near,
               std::vector<Square>& squares) {
    constexpr int deepest = 20;  // gaps under a millionth of the spacing are left
    grid.points_near(cell, near);
    squares.assign(1, {grid.corner(cell), grid.cell_side(), 0});
    while (!squares.empty()) {
        const Square square = squares.back();
        squares.pop_back();
        if (square.level == deepest || is_covered(square, near, spacing2)) continue;
        const double half = square.side / 2;
        const Point center{square.low.x + half, square.low.y + half};
        // From level 2 on an uncovered square cannot touch the outline, whose own points cover its surroundings.
        if (square.level >= 2 && grid.is_crossed(cell) && !grid.is_inside(center)) continue;
        const Point dart{center.x + half * draws.signed_uniform(), center.y + half * draws.signed_uniform()};
        if (is_clear(dart, near, spacing2) && (!grid.is_crossed(cell) || grid.is_inside(dart))) return grid.add(dart);
        for (const Point& low : {center, Point{square.low.x, center.y}, Point{center.x, square.low.y}, square.low}) {
            squares.push_back({low, half, square.level + 1});
        }
    }
}

void fill_gaps(DiskGrid& grid, double spacing, Draws& draws) {
    std::vector<Point> near;
    std::vector<Square> squares;
    for (Index cell = 0; cell < grid.cells(); ++cell) {
        if (grid.is_free(cell)) fill_cell(grid, cell, spacing * spacing, draws, near, squares);
    }
}

}  // namespace

PointSet fill_poisson(const Rings& rings, double spacing, int extra, std::uint64_t seed) {
    DiskGrid grid(rings, spacing);
    PointSet set = points_on_rings(divide_rings(rings, {spacing, spacing}, extra));
    grid.add_outline(set.points);
    Draws draws(seed);
    grow_front(grid, spacing, draws);
    fill_gaps(grid, spacing, draws);
    set.points = grid.points();
    return set;
}

}  // namespace thalweg::mesh
