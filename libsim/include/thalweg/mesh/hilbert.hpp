// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <span>
#include <vector>

#include "thalweg/core/index.hpp"
#include "thalweg/core/point.hpp"

namespace thalweg::mesh {

/// The points' numbers in the order of a Hilbert curve of 65536² cells over their bounding square; points of one cell
/// by their number.
std::vector<Index> hilbert_order(std::span<const Point> points);

}  // namespace thalweg::mesh
