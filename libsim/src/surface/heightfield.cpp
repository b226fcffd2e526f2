// SPDX-License-Identifier: GPL-3.0-or-later
#include "thalweg/surface/heightfield.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>

#include "thalweg/core/error.hpp"
#include "thalweg/core/parallel.hpp"

namespace thalweg::surface {
namespace {

constexpr Index rows_per_band = 32;

Point node_at(const Mesh& mesh, Index node) { return {mesh.x[node], mesh.y[node]}; }

double distance2(const Point& a, const Point& b) { return (a.x - b.x) * (a.x - b.x) + (a.y - b.y) * (a.y - b.y); }

/// Twice the signed area of (a, b, p), always computed from the lower node, so that the triangles on both sides of an
/// edge agree to the last bit on which of them a place belongs to.
double side_of_edge(const Mesh& mesh, Index a, Index b, const Point& p) {
    const Point low = node_at(mesh, std::min(a, b));
    const Point high = node_at(mesh, std::max(a, b));
    const double cross = (high.x - low.x) * (p.y - low.y) - (high.y - low.y) * (p.x - low.x);
    return a < b ? cross : -cross;
}

/// Unnormalised barycentric coordinates; the place lies in the triangle if none is negative.
std::array<double, 3> coordinates_in(const Mesh& mesh, const std::array<Index, 3>& t, const Point& p) {
    return {side_of_edge(mesh, t[1], t[2], p), side_of_edge(mesh, t[2], t[0], p), side_of_edge(mesh, t[0], t[1], p)};
}

struct Range {
    Index first;
    Index last;  ///< one past
};

/// Cells whose centres lie between `low` and `high` (in cells from the first cell's edge), and a hair beyond: the exact
/// test decides.
Range centers_between(double low, double high, Index cells) {
    constexpr double hair = 1e-6;
    const double first = std::ceil(low - 0.5 - hair);
    const double last = std::floor(high - 0.5 + hair) + 1;
    return {static_cast<Index>(std::clamp(first, 0.0, double(cells))),
            static_cast<Index>(std::clamp(last, 0.0, double(cells)))};
}

struct Window {
    Range rows;
    Range cols;
};

/// The cells whose centres lie in the triangle's bounding box.
Window window_of(const Mesh& mesh, const std::array<Index, 3>& t, const Raster& raster) {
    const Placement& place = raster.placement;
    const auto [west, east] = std::minmax({mesh.x[t[0]], mesh.x[t[1]], mesh.x[t[2]]});
    const auto [south, north] = std::minmax({mesh.y[t[0]], mesh.y[t[1]], mesh.y[t[2]]});
    return {.rows = centers_between((place.north - north) / place.cell_height,
                                    (place.north - south) / place.cell_height, raster.grid.rows),
            .cols = centers_between((west - place.west) / place.cell_width, (east - place.west) / place.cell_width,
                                    raster.grid.cols)};
}

/// Triangles by the bands of rows that their windows touch, ascending in each band.
struct Bands {
    std::vector<Index> start;
    std::vector<Index> triangles;
};

Bands sort_into_bands(const Mesh& mesh, const Raster& raster) {
    Bands bands;
    bands.start.assign((raster.grid.rows + rows_per_band - 1) / rows_per_band + 1, 0);
    const auto visit = [&](auto put) {
        for (Index t = 0; t < mesh.triangles.size(); ++t) {
            const Window window = window_of(mesh, mesh.triangles[t], raster);
            if (window.rows.first >= window.rows.last || window.cols.first >= window.cols.last) continue;
            const Index last = (window.rows.last - 1) / rows_per_band;
            for (Index band = window.rows.first / rows_per_band; band <= last; ++band) put(band, t);
        }
    };
    visit([&](Index band, Index) { ++bands.start[band + 1]; });
    std::partial_sum(bands.start.begin(), bands.start.end(), bands.start.begin());
    bands.triangles.resize(bands.start.back());
    std::vector<Index> next(bands.start.begin(), bands.start.end() - 1);
    visit([&](Index band, Index t) { bands.triangles[next[band]++] = t; });
    return bands;
}

/// Gives the cells of one band that lie in triangle t, and in none before it, to t.
void claim_cells(const Mesh& mesh, const Raster& raster, Index t, const Range& band, std::vector<Index>& owner) {
    const Window window = window_of(mesh, mesh.triangles[t], raster);
    const Index last = std::min(window.rows.last, band.last);
    for (Index row = std::max(window.rows.first, band.first); row < last; ++row) {
        for (Index col = window.cols.first; col < window.cols.last; ++col) {
            Index& cell = owner[row * raster.grid.cols + col];
            if (cell != none) continue;
            const auto at = coordinates_in(mesh, mesh.triangles[t], raster.placement.center(row, col));
            if (at[0] >= 0 && at[1] >= 0 && at[2] >= 0) cell = t;
        }
    }
}

/// For every cell the triangle that holds its centre, the lower one of two that share it; `none` outside the domain.
std::vector<Index> triangle_of_cells(const Mesh& mesh, const Raster& raster) {
    const Bands bands = sort_into_bands(mesh, raster);
    std::vector<Index> owner(raster.grid.size(), none);
    const auto claim = [&](Index first_band, Index last_band) {
        for (Index band = first_band; band < last_band; ++band) {
            const Range rows{band * rows_per_band, std::min((band + 1) * rows_per_band, raster.grid.rows)};
            for (Index at = bands.start[band]; at < bands.start[band + 1]; ++at) {
                claim_cells(mesh, raster, bands.triangles[at], rows, owner);
            }
        }
    };
    parallel_for(0, static_cast<Index>(bands.start.size() - 1), claim, 1);
    return owner;
}

double interpolate(const Mesh& mesh, std::span<const double> values, const std::array<Index, 3>& t, const Point& p) {
    const auto at = coordinates_in(mesh, t, p);
    const double sum = at[0] + at[1] + at[2];
    const std::array<double, 3> v{values[t[0]], values[t[1]], values[t[2]]};
    const double value = at[0] / sum * v[0] + at[1] / sum * v[1] + at[2] / sum * v[2];
    if (std::isnan(value)) return value;
    return std::clamp(value, std::min({v[0], v[1], v[2]}), std::max({v[0], v[1], v[2]}));  // against rounding
}

/// Down the distances over the neighbours. The straight line from a corner of the place's own triangle leaves a node's
/// cell only to a neighbour nearer to the place, so the walk ends at the nearest node, after a step or two.
Index walk_to_nearest(const Mesh& mesh, const std::array<Index, 3>& t, const Point& p) {
    const auto nearer = [&](Index a, Index b) {
        const double to_a = distance2(node_at(mesh, a), p);
        const double to_b = distance2(node_at(mesh, b), p);
        return to_a < to_b || (to_a == to_b && a < b);
    };
    Index nearest = *std::min_element(t.begin(), t.end(), nearer);
    for (Index here = none; here != nearest;) {
        here = nearest;
        mesh.neighbors(here, [&](Index other, double, Slot) {
            if (nearer(other, nearest)) nearest = other;
        });
    }
    return nearest;
}

}  // namespace

Raster covering_raster(const Mesh& mesh, Index resolution) {
    if (resolution == 0) throw Error("a raster needs a resolution of at least one cell along its longer side");
    if (mesh.size() == 0) throw Error("a raster cannot cover a mesh without nodes");
    const auto [west, east] = std::minmax_element(mesh.x.begin(), mesh.x.end());
    const auto [south, north] = std::minmax_element(mesh.y.begin(), mesh.y.end());
    const double width = *east - *west;
    const double height = *north - *south;
    const double cell = std::max(width, height) / resolution;
    const auto cells_across = [&](double length) {
        return static_cast<Index>(std::max(1.0, std::ceil(length / cell - 1e-9)));  // whole numbers stay themselves
    };
    Raster raster;
    raster.grid = plane_grid(cells_across(height), cells_across(width), cell, cell);
    raster.placement.west = *west;
    raster.placement.north = *north;
    raster.placement.cell_width = cell;
    raster.placement.cell_height = cell;
    raster.values.assign(raster.grid.size(), std::numeric_limits<double>::quiet_NaN());
    return raster;
}

void interpolate_linear(const Mesh& mesh, std::span<const double> node_values, Raster& raster) {
    if (node_values.size() != mesh.size()) {
        throw Error(fmt::format("{} values for the {} nodes of the mesh", node_values.size(), mesh.size()));
    }
    const std::vector<Index> owner = triangle_of_cells(mesh, raster);
    raster.values.resize(raster.grid.size());
    parallel_for(0, raster.grid.size(), [&](Index first, Index last) {
        for (Index cell = first; cell < last; ++cell) {
            const Point center = raster.placement.center(raster.grid.row(cell), raster.grid.col(cell));
            raster.values[cell] = owner[cell] == none
                                      ? std::numeric_limits<double>::quiet_NaN()
                                      : interpolate(mesh, node_values, mesh.triangles[owner[cell]], center);
        }
    });
}

std::vector<Index> nearest_node(const Mesh& mesh, const Raster& raster) {
    std::vector<Index> nearest = triangle_of_cells(mesh, raster);
    parallel_for(0, raster.grid.size(), [&](Index first, Index last) {
        for (Index cell = first; cell < last; ++cell) {
            if (nearest[cell] == none) continue;
            const Point center = raster.placement.center(raster.grid.row(cell), raster.grid.col(cell));
            nearest[cell] = walk_to_nearest(mesh, mesh.triangles[nearest[cell]], center);
        }
    });
    return nearest;
}

}  // namespace thalweg::surface
