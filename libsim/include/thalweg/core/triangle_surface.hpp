// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <vector>

#include "thalweg/core/index.hpp"

namespace thalweg {

/// Triangles in space, as flat arrays: a terrain's surface, or the hull of a solid. Counter-clockwise seen from outside
/// (from above).
struct TriangleSurface {
    std::vector<double> x, y, z;  ///< of the vertices, m
    std::vector<std::array<Index, 3>> triangles;

    Index size() const { return static_cast<Index>(x.size()); }
};

}  // namespace thalweg
