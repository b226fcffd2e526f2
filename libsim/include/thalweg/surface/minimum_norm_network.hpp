// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <span>
#include <vector>

#include "thalweg/core/index.hpp"

namespace thalweg::surface {

/// Tension of one edge beyond the mean of its ends' tensions, for the edges of a class (a cliff, a terrace).
struct ExtraTension {
    Index a, b;      ///< the edge's vertices, in any order
    double tension;  ///< dimensionless; several for one edge add up
};

/// Heights on a triangulation that a surface under tension goes through. The arrays belong to the caller.
struct TensionMesh {
    std::span<const double> x;                         ///< m
    std::span<const double> y;                         ///< m
    std::span<const double> height;                    ///< m
    std::span<const double> tension;                   ///< per vertex, ≥ 0, dimensionless
    std::span<const std::array<Index, 3>> triangles;   ///< counter-clockwise
    std::span<const ExtraTension> extra_tension = {};  ///< for some edges
    /// Gradients known beforehand, per vertex: NaN where they are to be found; empty: everywhere.
    std::span<const double> given_slope_x = {}, given_slope_y = {};
};

/// The network of curves over the edges, and what the patches between them need.
struct MinimumNormNetwork {
    std::vector<double> slope_x;  ///< per vertex, ∂z/∂x; NaN for a vertex of no triangle
    std::vector<double> slope_y;
    std::vector<std::array<Index, 2>> edges;              ///< each once, the lower vertex first, ascending
    std::vector<double> edge_tension;                     ///< mean of its ends' plus what is extra, dimensionless
    std::vector<std::array<Index, 3>> edges_of_triangle;  ///< number k lies opposite to corner k
    int iterations = 0;
    double last_change = 0;  ///< largest change of a slope in the last iteration, relative to the largest slope
};

/// The gradients for which the curves under tension over all edges (surface/tension_spline.hpp) have together the least
/// energy Σ ∫₀ᴸ [F″² + α²(F′ − s)²] dt (Nielson 1983; Nielson & Franke 1984), each edge's tension σ = αL the mean of
/// its ends'. Linear heights give back their gradient, whatever the tension.
///
/// An edge in direction û with chord slope s has the energy (1/L)(d a² + 2e a c + d c²), a = g_i·û − s and c = g_j·û −
/// s, so the gradients solve [Σ_j (d/L) ûûᵀ] g_i + Σ_j (e/L) ûûᵀ g_j = Σ_j ((d + e)/L) s û at every vertex. As e ≤ d/2,
/// the eigenvalues of this system lie between 1/2 and 3/2 once each vertex is divided by its own 2×2 block, whatever
/// the triangulation, its size and its angles. Chebyshev's iteration with these bounds divides the error by 3.7 in
/// every round: after at most 32 rounds it is under rounding. No fill, no inner product, the same bytes for any number
/// of threads.
///
/// Given gradients stay what they are; the others are then the best beside them. The bounds hold for them as well.
///
/// Where two vertices are much nearer to each other than to the rest and differ in height, the gradient there is steep
/// and is felt over the longer edges as well; a tension that has no unit does little against it.
///
/// Accuracy: 1e-14 relative to the largest slope where the edges at a vertex span the plane; less in the direction in
/// which they do not, by 1/sin² of the widest angle between their lines. Where all of them lie on one line to 1e-6 (a
/// corner of triangles without area) the gradient across it is that of least length: none. Cost: linear; 1e5 vertices
/// with 3e5 edges take 0.1 to 0.2 s. Throws Error for arrays of unequal length, corners that do not exist, an
/// edge of no length, a height or place that is no number, a tension that is negative or no number, extra tension on
/// what is no edge, and given gradients that are not one for each vertex.
MinimumNormNetwork minimum_norm_network(const TensionMesh&);

/// The energy of the curves over all edges if the vertices had these gradients; the network's own are the least.
double network_energy(const TensionMesh&, const MinimumNormNetwork&, std::span<const double> slope_x,
                      std::span<const double> slope_y);

}  // namespace thalweg::surface
