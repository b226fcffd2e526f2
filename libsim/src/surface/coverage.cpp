// SPDX-License-Identifier: GPL-3.0-or-later
#include "surface/coverage.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <tuple>

#include "thalweg/core/parallel.hpp"

namespace thalweg::surface {
namespace {

constexpr Index rows_per_band = 32;
/// Bounds are this much wider than computed, against rounding at coordinates of this size; the exact test decides.
double slack_for(double spacing, double largest_coordinate) {
    return 1e-6 * spacing + 16 * std::numeric_limits<double>::epsilon() * largest_coordinate;
}

struct Range {
    Index first;
    Index last;  ///< one past
};

/// Cells whose centres lie between `low` and `high`, in cells from the first cell's edge.
Range centers_between(double low, double high, Index cells) {
    const double first = std::ceil(low - 0.5);
    const double last = std::floor(high - 0.5) + 1;
    return {static_cast<Index>(std::clamp(first, 0.0, double(cells))),
            static_cast<Index>(std::clamp(last, 0.0, double(cells)))};
}

/// Where the centres of a raster's cells are.
struct Centers {
    explicit Centers(const Raster& raster)
        : place(raster.placement),
          rows(raster.grid.rows),
          cols(raster.grid.cols),
          slack_x(slack_for(place.cell_width, std::abs(place.west) + cols * place.cell_width)),
          slack_y(slack_for(place.cell_height, std::abs(place.north) + rows * place.cell_height)) {}

    Range rows_of(const TriangleTest& test) const {
        return centers_between((place.north - test.north() - slack_y) / place.cell_height,
                               (place.north - test.south() + slack_y) / place.cell_height, rows);
    }

    /// The columns in which the triangle can have centres of this row.
    Range cols_of(const TriangleTest& test, Index row) const {
        const double y = place.center(row, 0).y;
        const auto [west, east] = test.between(y - slack_y, y + slack_y);
        if (!(west <= east)) return {0, 0};
        return centers_between((west - slack_x - place.west) / place.cell_width,
                               (east + slack_x - place.west) / place.cell_width, cols);
    }

    const Placement& place;
    Index rows, cols;
    double slack_x, slack_y;
};

/// Triangles sorted into bands (of rows, of buckets), ascending in each.
struct Bands {
    std::vector<Index> start;
    std::vector<Index> triangles;
};

/// for_each(put) calls put(band, triangle), triangles ascending, twice the same.
template <class ForEach>
Bands sort_into_bands(std::size_t count, ForEach for_each) {
    Bands bands;
    bands.start.assign(count + 1, 0);
    for_each([&](std::size_t band, Index) { ++bands.start[band + 1]; });
    std::partial_sum(bands.start.begin(), bands.start.end(), bands.start.begin());
    bands.triangles.resize(bands.start.back());
    std::vector<Index> next(bands.start.begin(), bands.start.end() - 1);
    for_each([&](std::size_t band, Index t) { bands.triangles[next[band]++] = t; });
    return bands;
}

Bands bands_of_rows(const Triangulation& plane, const Centers& centers) {
    const Index count = (centers.rows + rows_per_band - 1) / rows_per_band;
    return sort_into_bands(count, [&](auto put) {
        for (Index t = 0; t < plane.triangles.size(); ++t) {
            const Range rows = centers.rows_of(TriangleTest(plane, plane.triangles[t]));
            if (rows.first >= rows.last) continue;
            const Index last = (rows.last - 1) / rows_per_band;
            for (Index band = rows.first / rows_per_band; band <= last; ++band) put(band, t);
        }
    });
}

/// Collects the cells of one band that lie in the triangle and in none before it.
void claim_cells(const TriangleTest& test, const Centers& centers, const Range& band, std::vector<char>& taken,
                 Claim& claim) {
    claim.cells.clear();
    for (auto& coordinate : claim.at) coordinate.clear();
    const Range rows = centers.rows_of(test);
    const Index last = std::min(rows.last, band.last);
    for (Index row = std::max(rows.first, band.first); row < last; ++row) {
        const Range cols = centers.cols_of(test, row);
        for (Index col = cols.first; col < cols.last; ++col) {
            char& is_taken = taken[(row - band.first) * centers.cols + col];
            if (is_taken) continue;
            const auto at = test.coordinates(centers.place.center(row, col));
            if (!TriangleTest::holds(at)) continue;
            is_taken = 1;
            claim.cells.push_back(row * centers.cols + col);
            for (int k = 0; k < 3; ++k) claim.at[k].push_back(at[k]);
        }
    }
}

/// Square buckets over the triangles, about as many as there are triangles.
struct Buckets {
    double west, south, size, slack;
    Index cols, rows;
    Bands bands;

    Index col(double x) const { return place(x - west, cols); }
    Index row(double y) const { return place(y - south, rows); }

  private:
    Index place(double distance, Index count) const {
        return static_cast<Index>(std::clamp(std::floor(distance / size), 0.0, count - 1.0));
    }
};

/// Calls put(bucket, t) for the buckets that triangle t can touch.
template <class Put>
void put_into_buckets(const Buckets& buckets, const TriangleTest& test, Index t, Put put) {
    const Index last_row = buckets.row(test.north() + buckets.slack);
    for (Index row = buckets.row(test.south() - buckets.slack); row <= last_row; ++row) {
        const double low = buckets.south + row * buckets.size;
        const auto [west, east] = test.between(low - buckets.slack, low + buckets.size + buckets.slack);
        if (!(west <= east)) continue;
        const Index last_col = buckets.col(east + buckets.slack);
        for (Index col = buckets.col(west - buckets.slack); col <= last_col; ++col) put(row * buckets.cols + col, t);
    }
}

Buckets buckets_over(const Triangulation& plane) {
    const auto [west, east] = std::minmax_element(plane.x.begin(), plane.x.end());
    const auto [south, north] = std::minmax_element(plane.y.begin(), plane.y.end());
    const double width = *east - *west;
    const double height = *north - *south;
    const double longer = std::max(width, height);
    const double wanted = std::sqrt(width * height / static_cast<double>(plane.triangles.size()));
    const double size = std::max({wanted, longer / 1e4, std::numeric_limits<double>::min()});
    const double largest = std::max({std::abs(*west), std::abs(*east), std::abs(*south), std::abs(*north)});
    Buckets buckets{*west, *south, size, slack_for(size, largest), 1, 1, {}};
    buckets.cols = static_cast<Index>(width / buckets.size) + 1;
    buckets.rows = static_cast<Index>(height / buckets.size) + 1;
    buckets.bands = sort_into_bands(std::size_t(buckets.cols) * buckets.rows, [&](auto put) {
        for (Index t = 0; t < plane.triangles.size(); ++t) {
            put_into_buckets(buckets, TriangleTest(plane, plane.triangles[t]), t, put);
        }
    });
    return buckets;
}

Index find_triangle(const Triangulation& plane, const Buckets& buckets, const Point& p) {
    if (!std::isfinite(p.x) || !std::isfinite(p.y)) return none;
    const Index bucket = buckets.row(p.y) * buckets.cols + buckets.col(p.x);
    for (Index at = buckets.bands.start[bucket]; at < buckets.bands.start[bucket + 1]; ++at) {
        const Index t = buckets.bands.triangles[at];
        const TriangleTest test(plane, plane.triangles[t]);
        if (TriangleTest::holds(test.coordinates(p))) return t;
    }
    return none;
}

}  // namespace

TriangleTest::TriangleTest(const Triangulation& plane, const std::array<Index, 3>& corners) {
    for (int k = 0; k < 3; ++k) {
        const Index a = corners[(k + 1) % 3];
        const Index b = corners[(k + 2) % 3];
        const Point low = plane.vertex(std::min(a, b));
        const Point high = plane.vertex(std::max(a, b));
        sides_[k] = {low, high.x - low.x, high.y - low.y, a < b ? 1.0 : -1.0};
    }
    std::tie(south_, north_) = std::minmax({plane.y[corners[0]], plane.y[corners[1]], plane.y[corners[2]]});
}

TriangleTest::Interval TriangleTest::between(double y_low, double y_high) const {
    Interval found{std::numeric_limits<double>::infinity(), -std::numeric_limits<double>::infinity()};
    for (const Side& side : sides_) {
        const double start = side.low.y;
        const double end = start + side.dy;
        if (std::max(start, end) < y_low || std::min(start, end) > y_high) continue;
        for (const double y : {y_low, y_high}) {
            const double share = side.dy == 0 ? (y == y_low ? 0.0 : 1.0) : std::clamp((y - start) / side.dy, 0.0, 1.0);
            const double x = side.low.x + share * side.dx;
            found = {std::min(found.low, x), std::max(found.high, x)};
        }
    }
    return found;
}

void cover(const Triangulation& plane, const Raster& raster, const std::function<void(const Claim&)>& visit) {
    const Centers centers(raster);
    const Bands bands = bands_of_rows(plane, centers);
    const auto claim_bands = [&](Index first_band, Index last_band) {
        Claim claim;
        std::vector<char> taken;
        for (Index band = first_band; band < last_band; ++band) {
            const Range rows{band * rows_per_band, std::min((band + 1) * rows_per_band, centers.rows)};
            taken.assign(std::size_t(rows.last - rows.first) * centers.cols, 0);
            for (Index at = bands.start[band]; at < bands.start[band + 1]; ++at) {
                claim.triangle = bands.triangles[at];
                claim_cells(TriangleTest(plane, plane.triangles[claim.triangle]), centers, rows, taken, claim);
                if (!claim.cells.empty()) visit(claim);
            }
        }
    };
    parallel_for(0, static_cast<Index>(bands.start.size() - 1), claim_bands, 1);
}

std::vector<Index> triangle_of_points(const Triangulation& plane, std::span<const Point> points) {
    std::vector<Index> found(points.size(), none);
    if (plane.triangles.empty()) return found;
    const Buckets buckets = buckets_over(plane);
    parallel_for(0, static_cast<Index>(points.size()), [&](Index first, Index last) {
        for (Index i = first; i < last; ++i) found[i] = find_triangle(plane, buckets, points[i]);
    });
    return found;
}

}  // namespace thalweg::surface
