// SPDX-License-Identifier: GPL-3.0-or-later
#include "thalweg/surface/patch.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>

#include "surface/coverage.hpp"
#include "surface/shape.hpp"
#include "thalweg/core/error.hpp"
#include "thalweg/core/parallel.hpp"

namespace thalweg::surface {
namespace {

constexpr double no_data = std::numeric_limits<double>::quiet_NaN();

Triangulation plane_of(const TensionMesh& mesh) { return {mesh.x, mesh.y, mesh.triangles}; }

/// Where a side or a curve from a corner starts and ends: corners k, k + 1 and k + 2 of a triangle.
struct Corners {
    int at, next, last;
};

constexpr std::array<Corners, 3> around{{{0, 1, 2}, {1, 2, 0}, {2, 0, 1}}};

double twice_area(const TensionMesh& mesh, const std::array<Index, 3>& t) {
    return (mesh.x[t[1]] - mesh.x[t[0]]) * (mesh.y[t[2]] - mesh.y[t[0]]) -
           (mesh.y[t[1]] - mesh.y[t[0]]) * (mesh.x[t[2]] - mesh.x[t[0]]);
}

TensionPatch patch_of(const TensionMesh& mesh, const MinimumNormNetwork& network, Index triangle) {
    const std::array<Index, 3>& t = mesh.triangles[triangle];
    TensionPatch patch;
    for (const auto& [k, i, j] : around) {
        const auto rise_at = [&, from = t[k]](Index to) {
            return network.slope_x[from] * (mesh.x[to] - mesh.x[from]) +
                   network.slope_y[from] * (mesh.y[to] - mesh.y[from]) - (mesh.height[to] - mesh.height[from]);
        };
        patch.height[k] = mesh.height[t[k]];
        patch.toward[k] = {rise_at(t[i]), rise_at(t[j])};
        patch.tension[k] = network.edge_tension[network.edges_of_triangle[triangle][k]];
    }
    for (const auto& [k, i, j] : around) {
        const Point side{mesh.x[t[j]] - mesh.x[t[i]], mesh.y[t[j]] - mesh.y[t[i]]};
        const Point start{mesh.x[t[i]] - mesh.x[t[k]], mesh.y[t[i]] - mesh.y[t[k]]};
        patch.foot[k] = (start.x * side.x + start.y * side.y) / (side.x * side.x + side.y * side.y);
        // From the corner straight to the line of the side: start − foot·side, and end − (1 + foot)·side.
        patch.across[k] = {-patch.toward[i][1] - patch.foot[k] * patch.toward[i][0],
                           -patch.toward[j][0] + (1 + patch.foot[k]) * patch.toward[j][1]};
    }
    return patch;
}

/// H_k less the plane: the curve from corner k to the side, `share` from the side's start to its end, at `b` of its
/// way.
template <class Number>
Number curve_from(const TensionPatch& patch, const Corners& corners, const Number& share, const Number& b) {
    const auto& [k, i, j] = corners;
    const Number rest = 1.0 - share;
    const Shape<Number> side = shape_of(number<Number>(patch.tension[k]), share);
    const Number from_start = number<Number>(patch.toward[i][0]);
    const Number from_end = number<Number>(patch.toward[j][1]);
    const Number end = side.value(from_start, from_end);
    const Number start_rise = rest * patch.toward[k][0] + share * patch.toward[k][1];
    const Number end_rise = (share + patch.foot[k]) * side.slope(from_start, from_end) +
                            (rest * patch.across[k][0] + share * patch.across[k][1]);
    const Shape<Number> way = shape_of(rest * patch.tension[j] + share * patch.tension[i], b);
    return b * end + way.value(start_rise - end, end - end_rise);
}

/// The patch less its plane. Barycentric coordinates: none negative, their sum 1.
template <class Number>
Number above_plane(const TensionPatch& patch, const std::array<Number, 3>& b) {
    Number sum = number<Number>(0);
    Number weights = number<Number>(0);
    for (const Corners& corners : around) {
        const auto& [k, i, j] = corners;
        const Number opposite = b[i] + b[j];
        const Number share = b[j] / select(equal(opposite, 0.0), number<Number>(1), opposite);
        const Number weight = b[i] * b[j];
        sum = sum + weight * curve_from(patch, corners, share, opposite);
        weights = weights + weight;
    }
    return sum / select(equal(weights, 0.0), number<Number>(1), weights);  // at a corner nothing above it
}

template <class Number>
Number height_at(const TensionPatch& patch, const std::array<Number, 3>& b) {
    const std::array<double, 3>& z = patch.height;
    Number plane = z[0] + (b[1] * (z[1] - z[0]) + b[2] * (z[2] - z[0]));
    for (int k = 1; k < 3; ++k) plane = select(equal(b[k], 1.0), number<Number>(z[k]), plane);  // to the last bit
    return plane + above_plane(patch, b);
}

/// Unnormalised coordinates become weights; the lanes beyond `count` repeat the last.
void heights_of_lanes(const TensionPatch& patch, const Claim& claim, std::size_t first, std::size_t count,
                      double* out) {
    std::array<Lanes, 3> b;
    for (int k = 0; k < 3; ++k) {
        for (std::size_t lane = 0; lane < lane_count; ++lane) {
            b[k][lane] = claim.at[k][first + std::min(lane, count - 1)];
        }
    }
    const Lanes sum = b[0] + b[1] + b[2];
    const Lanes height = height_at<Lanes>(patch, {b[0] / sum, b[1] / sum, b[2] / sum});
    for (std::size_t lane = 0; lane < count; ++lane) out[lane] = height[lane];
}

void write_heights(const TensionPatch& patch, const Claim& claim, std::vector<double>& values) {
    std::array<double, lane_count> heights;
    for (std::size_t first = 0; first < claim.cells.size(); first += lane_count) {
        const std::size_t count = std::min<std::size_t>(lane_count, claim.cells.size() - first);
        heights_of_lanes(patch, claim, first, count, heights.data());
        for (std::size_t lane = 0; lane < count; ++lane) values[claim.cells[first + lane]] = heights[lane];
    }
}

/// From derivatives along the sides out of corner 0 to those along x and y.
Point gradient_of(const TensionMesh& mesh, const std::array<Index, 3>& t, int k, double along_next, double along_last) {
    const auto& [at, next, last] = around[k];
    const Point u{mesh.x[t[next]] - mesh.x[t[at]], mesh.y[t[next]] - mesh.y[t[at]]};
    const Point v{mesh.x[t[last]] - mesh.x[t[at]], mesh.y[t[last]] - mesh.y[t[at]]};
    const double area = twice_area(mesh, t);
    return {(along_next * v.y - along_last * u.y) / area, (along_last * u.x - along_next * v.x) / area};
}

SurfacePoint corner_of(const TensionMesh& mesh, const TensionPatch& patch, const std::array<Index, 3>& t, int k) {
    const auto& [at, next, last] = around[k];
    const Point gradient = gradient_of(mesh, t, k, patch.toward[at][0] + (patch.height[next] - patch.height[at]),
                                       patch.toward[at][1] + (patch.height[last] - patch.height[at]));
    return {patch.height[at], gradient.x, gradient.y};
}

SurfacePoint point_of(const TensionMesh& mesh, const TensionPatch& patch, const std::array<Index, 3>& t,
                      const Point& p) {
    std::array<double, 3> at = TriangleTest(plane_of(mesh), t).coordinates(p);
    for (double& coordinate : at) coordinate = std::max(coordinate, 0.0);
    const double sum = at[0] + at[1] + at[2];
    for (int k = 0; k < 3; ++k) {  // without area all are 0/0
        if (at[k] / sum == 1) return corner_of(mesh, patch, t, k);
    }
    const Dual height =
        height_at<Dual>(patch, {Dual{at[0] / sum, -1, -1}, Dual{at[1] / sum, 1, 0}, Dual{at[2] / sum, 0, 1}});
    const Point gradient = gradient_of(mesh, t, 0, height.by_u, height.by_v);
    return {height.value, gradient.x, gradient.y};
}

void check_patches(const TensionMesh& mesh, std::size_t patches) {
    if (patches == mesh.triangles.size()) return;
    throw Error(fmt::format("{} patches for the {} triangles of a surface", patches, mesh.triangles.size()));
}

}  // namespace

std::vector<TensionPatch> tension_patches(const TensionMesh& mesh, const MinimumNormNetwork& network) {
    if (network.edges_of_triangle.size() != mesh.triangles.size() || network.slope_x.size() != mesh.x.size()) {
        throw Error(fmt::format("a network of {} vertices and {} triangles for a surface of {} and {}",
                                network.slope_x.size(), network.edges_of_triangle.size(), mesh.x.size(),
                                mesh.triangles.size()));
    }
    std::vector<TensionPatch> patches;
    patches.reserve(mesh.triangles.size());
    for (Index t = 0; t < mesh.triangles.size(); ++t) {
        if (twice_area(mesh, mesh.triangles[t]) < 0) {
            throw Error(fmt::format("triangle {} runs clockwise: a surface needs counter-clockwise ones", t));
        }
        patches.push_back(patch_of(mesh, network, t));
    }
    return patches;
}

SurfacePoint surface_at(const TensionMesh& mesh, std::span<const TensionPatch> patches, Index triangle,
                        const Point& p) {
    return point_of(mesh, patches[triangle], mesh.triangles[triangle], p);
}

std::vector<SurfacePoint> surface_at(const TensionMesh& mesh, std::span<const TensionPatch> patches,
                                     std::span<const Point> points) {
    check_patches(mesh, patches.size());
    const std::vector<Index> triangle = triangle_of_points(plane_of(mesh), points);
    std::vector<SurfacePoint> found(points.size(), {no_data, no_data, no_data});
    parallel_for(
        0, static_cast<Index>(points.size()),
        [&](Index first, Index last) {
            for (Index i = first; i < last; ++i) {
                if (triangle[i] != none) found[i] = surface_at(mesh, patches, triangle[i], points[i]);
            }
        },
        1024);
    return found;
}

void evaluate(const TensionMesh& mesh, std::span<const TensionPatch> patches, Raster& raster) {
    check_patches(mesh, patches.size());
    raster.values.assign(raster.grid.size(), no_data);
    cover(plane_of(mesh), raster,
          [&](const Claim& claim) { write_heights(patches[claim.triangle], claim, raster.values); });
}

}  // namespace thalweg::surface
