// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "thalweg/core/mesh.hpp"
#include "thalweg/core/raster.hpp"

namespace thalweg::surface {

/// Detail below the scale of a mesh's triangles.
struct FractalRoughness {
    double amplitude_m = 1;    ///< standard deviation of the difference in height of two places `reference_m` apart
    double reference_m = 100;  ///< above 0
    double hurst = 0.7;        ///< exponent of that deviation with the distance, in (0, 1): 1 smooth, 0 jagged
    double finest_m = 1;       ///< edges up to that length are not divided; above 0
    std::uint64_t seed = 1;
};

/// Fractal roughness on a triangulation by recursive subdivision (Fournier, Fussell & Carpenter 1982): every triangle
/// is cut into four by the middles of its edges, again and again; a middle lies half-way between its edge's ends in
/// height, and is then displaced by a normal number of variance
///     s(L)²·(2^(−2H) − 1/4)·2/3,    s(L) = amplitude·(L/reference)^H,
/// L the edge's length. The differences in height along the halves of an edge then have a variance of s²/4 + that,
/// those along the edges between two middles s²/4 + twice that; there are as many of the one as of the other, and their
/// mean is s(L/2)². (Fournier et al. displace by the whole of it, what fractional Brownian motion has along a line; in
/// the plane that is too much.) Edges no longer than `finest_m` are not displaced any more; the mesh's own vertices
/// stay at 0. So over distances well above `finest_m` and well below the mesh's edges differences in height grow as
/// distance^H; beyond, no further.
///
/// A displacement is a function of the seed and of the edge, the vertices by their numbers, so the triangles on both
/// sides of an edge have the same: the roughness is continuous, and the same for any number of threads and for places
/// asked for alone. `share` per vertex, interpolated linearly in the mesh's triangles, multiplies it: where it is 0
/// along an edge nothing is displaced there.
///
/// At the centres of the raster's cells, added to its values; outside the mesh nothing is. Nothing is stored but the
/// way down to each place: O(cells × levels); measured on one thread 0.10 and 0.11 µs per cell and level (2.1e6 cells,
/// from 100 m down to 6.25 and to 0.39; 14 to 15 random gathers from memory). Throws Error unless there is one share
/// per vertex, and for numbers beyond those above.
void add_roughness(const Mesh&, std::span<const double> share, const FractalRoughness&, Raster&);

/// The same at single places, m; NaN outside the mesh.
std::vector<double> roughness_at(const Mesh&, std::span<const double> share, const FractalRoughness&,
                                 std::span<const Point>);

}  // namespace thalweg::surface
