// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <span>
#include <vector>

#include "thalweg/core/raster.hpp"
#include "thalweg/surface/minimum_norm_network.hpp"

namespace thalweg::surface {

/// The smooth surface over one triangle: Nielson's side-vertex patch (Nielson 1983; Nielson & Franke 1984) on the
/// curves of a minimum norm network. Let b_k be the barycentric coordinates of a place P, and S_k the point where the
/// line from corner V_k through P meets the opposite side. Then
///     F = Σ w_k H_k,    w_1 = b_2 b_3 / (b_1 b_2 + b_2 b_3 + b_3 b_1), and so on around,
/// H_k the curve under tension from V_k to S_k (surface/tension_spline.hpp) that takes its height and slope at V_k from
/// the network, its height at S_k from the edge's curve, and its slope there from a gradient along the edge: in the
/// edge's direction the derivative of its curve, across it a derivative that is **linear along each edge** between
/// those of the gradients at its ends. The tension of H_k is linear, by the place of S_k, between those of the two
/// sides that meet at V_k.
///
/// On a side w_k = 1, and there all three H agree, so value and gradient are those of the edge, which both triangles
/// share: the surface is C¹. It goes through every vertex with the network's gradient, gives back linear heights
/// whatever the tension, and tends to the plane through the corners for large tension.
///
/// Kept is the surface less that plane, in quantities along the sides that do not change with place, size or direction.
/// Where the plane is the surface they are zero. Corners k, i, j follow each other counter-clockwise.
struct TensionPatch {
    std::array<double, 3> height;   ///< of the corners, m
    std::array<double, 3> tension;  ///< of the side opposite to corner k
    std::array<double, 3> foot;     ///< corner k's foot on the opposite side, from i backwards, in lengths of the side
    /// How far the tangent plane of corner k has risen above the patch's plane at i and at j, m.
    std::array<std::array<double, 2>, 3> toward;
    /// How far the tangent planes of i and of j rise above the patch's plane on the way from corner k to its foot, m.
    std::array<std::array<double, 2>, 3> across;
};

struct SurfacePoint {
    double height;   ///< m
    double slope_x;  ///< ∂z/∂x
    double slope_y;
};

/// One patch per triangle. The network must be the mesh's own; other gradients at its vertices give a surface that is
/// C¹ as well. Throws Error for a triangle that runs clockwise and for a network of another mesh. Triangles without
/// area are allowed: they hold no place.
std::vector<TensionPatch> tension_patches(const TensionMesh&, const MinimumNormNetwork&);

/// Height and gradient at a place in the given triangle or on its sides. Places outside are not asked for; by less than
/// rounding they are drawn to the side. NaN in a triangle without area. Cost: about 1 µs.
SurfacePoint surface_at(const TensionMesh&, std::span<const TensionPatch>, Index triangle, const Point&);

/// Height and gradient at many places, each in the triangle listed first that holds it; NaN outside all. Finding the
/// triangles needs a table as large as the mesh, so ask for all places at once. Cost: about 2 µs per place.
std::vector<SurfacePoint> surface_at(const TensionMesh&, std::span<const TensionPatch>, std::span<const Point>);

/// Heights at the centres of the raster's cells, as `interpolate_linear` gives cells to triangles: a centre on a side
/// takes the triangle listed first; NaN outside all triangles. The same numbers as `surface_at` to the last bit, four
/// at a time. Accuracy: 1e-12 relative to the heights and rises that meet in a triangle (test: against the definition).
/// Cost: triangles plus cells, 0.05 to 0.1 µs per cell; 1e7 cells take about a second. The same bytes for any number of
/// threads.
void evaluate(const TensionMesh&, std::span<const TensionPatch>, Raster&);

}  // namespace thalweg::surface
