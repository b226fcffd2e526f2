// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <span>
#include <vector>

#include "thalweg/core/raster.hpp"

namespace thalweg::io {

/// The cells of each label 0 … count − 1 as a surface in raster coordinates that covers them and nothing else; empty
/// for a label without cells. Cells that hang together by their sides are one part, so parts touch at corners at most;
/// parts come in the order of their first cells. Outer rings run counter-clockwise, holes clockwise, straight runs are
/// one edge, and all is valid by OGC's rules (Simple Feature Access 1.2.1, 6.1.11 and 6.1.14). Time and memory grow
/// with the number of cells only. Throws Error if there is not one label for each cell.
std::vector<MultiPolygon> cell_outlines(const Raster& frame, std::span<const Index> labels, Index count);

/// The outer ring of the largest part of the cells labelled `label` (the first of equals), its holes covered and its
/// other parts left out: a border for a mesh, not the cells' extent. Empty if there are none.
Polygon cell_outline(const Raster& frame, std::span<const Index> labels, Index label);

/// The ring with details smaller than `tolerance` (its own unit) removed, still a simple polygon (GEOS, topology kept).
Polygon simplify(const Polygon&, double tolerance);

}  // namespace thalweg::io
