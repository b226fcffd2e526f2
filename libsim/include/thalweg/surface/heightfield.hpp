// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <span>

#include "thalweg/core/mesh.hpp"
#include "thalweg/core/raster.hpp"

namespace thalweg::surface {

/// Square cells over the bounding box of the mesh, from its north-west corner, `resolution` of them along its longer
/// side; the plane in metres, values NaN. Throws Error for no cells or no nodes.
Raster covering_raster(const Mesh&, Index resolution);

/// Node values on the centres of the raster's cells by linear (barycentric) interpolation in the triangles; NaN outside
/// the domain. A centre on an edge takes the triangle listed first, so the result does not depend on the threads; the
/// value at a node's place is the node's. Cost: cells plus triangles. Throws Error unless there is one value per node.
void interpolate_linear(const Mesh&, std::span<const double> node_values, Raster&);

/// The node nearest to each cell's centre (of several equally near, one by a fixed rule), `none` outside the domain.
std::vector<Index> nearest_node(const Mesh&, const Raster&);

}  // namespace thalweg::surface
