// SPDX-License-Identifier: GPL-3.0-or-later
#include "thalweg/mesh/points.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "mesh/constrained.hpp"
#include "mesh/disk_grid.hpp"
#include "mesh/outline.hpp"
#include "thalweg/core/error.hpp"
#include "thalweg/core/random.hpp"
#include "thalweg/mesh/triangulate.hpp"

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

double distance(const Point& a, const Point& b) { return std::hypot(b.x - a.x, b.y - a.y); }

/// Into how many pieces a side is cut, none of them longer than the spacing (but for rounding).
double pieces_of_side(double length, double spacing) { return std::max(1.0, std::ceil(length / spacing - 1e-9)); }

/// Corners, and as few evenly spaced points along each side as leave no gap wider than the spacing; then `extra` more,
/// each where the gaps are widest.
std::vector<Point> divide_outline(const Polygon& outline, double spacing, int extra) {
    const std::size_t sides = outline.size();
    std::vector<double> length(sides);
    std::vector<double> pieces(sides);
    for (std::size_t i = 0; i < sides; ++i) {
        length[i] = distance(outline[i], outline[(i + 1) % sides]);
        pieces[i] = pieces_of_side(length[i], spacing);
    }
    for (; extra > 0; --extra) {
        std::size_t widest = 0;
        for (std::size_t i = 1; i < sides; ++i) {
            if (length[i] / pieces[i] > length[widest] / pieces[widest]) widest = i;
        }
        ++pieces[widest];
    }
    std::vector<Point> points;
    for (std::size_t i = 0; i < sides; ++i) {
        const Point& a = outline[i];
        const Point& b = outline[(i + 1) % sides];
        for (double k = 0; k < pieces[i]; ++k) {
            points.push_back({a.x + (b.x - a.x) * (k / pieces[i]), a.y + (b.y - a.y) * (k / pieces[i])});
        }
    }
    return points;
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

/// A point one spacing away from all the outline's points is 0.86 spacings away from the outline itself and in no
/// edge's diametral disc, so what is put inside needs no more points on the outline.
PointSet fill_outline(const Polygon& outline, double spacing, int extra, std::uint64_t seed) {
    DiskGrid grid(outline, spacing);
    const std::vector<Point> outline_points = conforming_ring(divide_outline(outline, spacing, extra));
    grid.add_outline(outline_points);
    Draws draws(seed);
    grow_front(grid, spacing, draws);
    fill_gaps(grid, spacing, draws);
    return {.points = grid.points(), .outline_count = static_cast<Index>(outline_points.size())};
}

/// How many points a spacing is expected to give: those on the outline are counted, those inside fill what is more than
/// half a spacing or so from it. Both constants are measured on squares of 1e2 to 1e6 points.
double expected_count(const Polygon& outline, double area, double spacing) {
    double on_outline = 0;
    double length = 0;
    for (std::size_t i = 0; i < outline.size(); ++i) {
        const double side = distance(outline[i], outline[(i + 1) % outline.size()]);
        on_outline += pieces_of_side(side, spacing);
        length += side;
    }
    return on_outline + 0.698 * std::max(0.0, area - 0.534 * length * spacing) / (spacing * spacing);
}

double expected_spacing(const Polygon& outline, double area, double count) {
    double low = std::sqrt(area / count) / 1e3;
    double high = std::sqrt(area) + distance(outline[0], outline[1]);
    while (expected_count(outline, area, high) > count && high < 1e3 * distance(outline[0], outline[1])) high *= 2;
    for (int halving = 0; halving < 60; ++halving) {
        const double middle = std::sqrt(low * high);
        (expected_count(outline, area, middle) > count ? low : high) = middle;
    }
    return std::sqrt(low * high);
}

/// How many points may be put on the outline beyond what the spacing asks: a few to hit a small count; where the count
/// leaps with the spacing (a strip whose middle fills all at once), in the end enough to cross the leap.
double largest_extra(int attempt, Index count) {
    if (attempt <= 4) return 0;
    return attempt <= 20 ? 4 : std::min(0.25 * count, 1000.0);
}

void check_count(const Polygon& outline, Index count) {
    if (count < 16 || count > Index{1} << 31) {
        throw Error(fmt::format("a mesh needs 16 to 2147483648 nodes, not {}", count));
    }
    if (static_cast<double>(outline.size()) > 1.02 * count) {
        throw Error(
            fmt::format("the outline alone has {} corners, more than the {} nodes asked for: ask for more nodes or "
                        "simplify the outline",
                        outline.size(), count));
    }
}

}  // namespace

PointSet poisson_disk(const Polygon& outline, double spacing_m, std::uint64_t seed) {
    if (!(spacing_m > 0) || std::isinf(spacing_m)) {
        throw Error(fmt::format("points need a positive spacing, not {} m", spacing_m));
    }
    return fill_outline(checked_outline(outline), spacing_m, 0, seed);
}

PointSet poisson_disk_count(const Polygon& outline, Index count, std::uint64_t seed) {
    const Polygon checked = checked_outline(outline);
    check_count(checked, count);
    double spacing = expected_spacing(checked, polygon_area(checked), count);
    Random jitter(seed, 0x636f756e);
    int extra = 0;
    PointSet near_miss{};
    // A large set is met by the first or second spacing. A small one may need a certain number exactly: then what is
    // missing is put on the outline, at a spacing jittered until the two together make it.
    for (int attempt = 0; attempt < 200; ++attempt) {
        PointSet set = fill_outline(checked, spacing, extra, seed);
        const double missing = static_cast<double>(count) - static_cast<double>(set.points.size());
        if (std::abs(missing) <= 0.02 * count) return set;
        const double ratio = static_cast<double>(set.points.size()) / count;
        if (std::abs(missing) <= 1) near_miss = std::move(set);
        if (extra == 0 && missing > 0 && missing <= largest_extra(attempt, count)) {
            extra = static_cast<int>(missing);
        } else {
            spacing *= std::pow(ratio, 0.5);
            if (attempt >= 4) spacing *= 0.95 + 0.1 * jitter.uniform();
            extra = 0;
        }
    }
    if (!near_miss.points.empty()) return near_miss;
    throw Error(fmt::format("no spacing gives {} points in this outline of {} corners: ask for more, or for a spacing",
                            count, checked.size()));
}

}  // namespace thalweg::mesh
