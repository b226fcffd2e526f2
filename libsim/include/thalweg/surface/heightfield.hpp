// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <span>
#include <vector>

#include "thalweg/core/mesh.hpp"
#include "thalweg/core/raster.hpp"

namespace thalweg::surface {

/// Square cells over the bounding box of the mesh, `resolution` of them along its longer side.
/// Throws Error for no cells, no nodes, or more cells than an `Index` can count.
Grid covering_grid(const Mesh&, Index resolution);

/// The raster of these cells, from the mesh's north-west corner; the plane in metres, values NaN. Throws as above.
Raster covering_raster(const Mesh&, Index resolution);

/// Node values on the centres of the raster's cells by linear (barycentric) interpolation in the triangles; NaN outside
/// the domain. A centre on an edge takes the triangle listed first, so the result does not depend on the threads; the
/// value at a node's place is the node's. Cost: cells plus triangles. Throws Error unless there is one value per node.
void interpolate_linear(const Mesh&, std::span<const double> node_values, Raster&);

/// The same at single places.
std::vector<double> interpolate_linear_at(const Mesh&, std::span<const double> node_values, std::span<const Point>);

/// Mean of the node values weighted by exp(−d²/2σ²), d the distance to the node, on the centres of the raster's cells;
/// NaN outside the domain. Nodes count up to where their weight is e^−12.5 (4e-6) of the nearest node's, so that a cell
/// far from all nodes has a value too: σ → 0 gives the nearest node's. It smooths, also across a narrow gap of the
/// domain, and never leaves the range of the values. Cost: cells times nodes within 5 σ.
/// Throws Error unless there is one value per node, or for a σ that is not a positive number.
void interpolate_gaussian(const Mesh&, std::span<const double> node_values, double sigma_m, Raster&);

/// Natural neighbour interpolation (Sibson 1981) on the centres of the raster's cells; NaN outside the domain. The
/// weight of a node is the area that a new node at the centre would take of its Voronoi cell: the node's value at its
/// place, linear values reproduced to rounding, smooth but at the nodes, never beyond the values around. Cells end at
/// the outline: beyond a gap of the domain nothing counts. The mesh must be Delaunay, as mesh::triangulate makes it.
/// Cost: about ten triangles per cell. Throws Error unless there is one value per node.
void interpolate_natural(const Mesh&, std::span<const double> node_values, Raster&);

/// The node nearest to each cell's centre (of several equally near, one by a fixed rule), `none` outside the domain.
std::vector<Index> nearest_node(const Mesh&, const Raster&);

}  // namespace thalweg::surface
