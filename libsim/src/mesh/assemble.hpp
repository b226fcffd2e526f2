// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "thalweg/core/mesh.hpp"

namespace thalweg::mesh {

/// Puts the triangles in one order whatever the triangulator's: each starts with its lowest node, all ascending.
void sort_triangles(Mesh&);

/// Fills `offset`, `neighbor_list` and `length_list` from the triangles.
/// Throws Error if a node has more neighbours than a slot can count.
void connect_neighbors(Mesh&);

/// Fills `cell_area` from the triangles: each edge vw of a triangle gives |vw|² cot(u) / 8 to both its ends, u the
/// angle opposite (Meyer et al. 2003). Signed, so the sums are the Voronoi cells clipped to the domain wherever no
/// angle opposite the outline is obtuse.
void measure_cells(Mesh&);

}  // namespace thalweg::mesh
