// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <span>
#include <vector>

#include "thalweg/core/index.hpp"

namespace thalweg::surface {

/// Which triangles lie side by side. Side k lies opposite to corner k: it runs from corner k + 1 to corner k + 2.
class TriangleSides {
  public:
    /// Throws Error if more than two triangles share a side, or two run along it in the same direction.
    TriangleSides(Index vertices, std::span<const std::array<Index, 3>> triangles);

    /// The triangles across the three sides; `none` where there is none.
    const std::array<Index, 3>& across(Index triangle) const { return across_[triangle]; }

  private:
    std::vector<std::array<Index, 3>> across_;
};

}  // namespace thalweg::surface
