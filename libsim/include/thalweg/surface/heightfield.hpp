// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <span>

#include "thalweg/core/mesh.hpp"
#include "thalweg/core/raster.hpp"

namespace thalweg::surface {

/// Square cells over the bounding box of the mesh, `resolution` of them along its longer side; values NaN.
Raster covering_raster(const Mesh&, Index resolution);

/// Node values on the centres of the raster's cells by linear (barycentric) interpolation in the triangles; NaN outside
/// the domain. Cost: cells plus triangles.
void interpolate_linear(const Mesh&, std::span<const double> node_values, Raster&);

/// The node nearest to each cell's centre, `none` outside the domain.
std::vector<Index> nearest_node(const Mesh&, const Raster&);

}  // namespace thalweg::surface
