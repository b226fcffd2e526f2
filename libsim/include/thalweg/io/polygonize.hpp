// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <span>
#include <vector>

#include "thalweg/core/raster.hpp"

namespace thalweg::io {

/// Outer ring (raster coordinates, counter-clockwise) around the cells labelled `label`; the largest ring where they do
/// not hang together by their sides. Straight runs are one edge.
Polygon cell_outline(const Raster& frame, std::span<const Index> labels, Index label);

/// All labels' outlines in one pass (labels 0 … count − 1; `none` is outside).
std::vector<Polygon> cell_outlines(const Raster& frame, std::span<const Index> labels, Index count);

/// The ring with details smaller than `tolerance` (its own unit) removed, still a simple polygon (GEOS, topology kept).
Polygon simplify(const Polygon&, double tolerance);

}  // namespace thalweg::io
