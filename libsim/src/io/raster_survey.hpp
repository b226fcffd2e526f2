// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <vector>

#include "thalweg/core/raster.hpp"

namespace thalweg::io {

struct HeightsNoticed {
    std::vector<std::string> warnings;
    Index void_cells = 0;  ///< without data inside the terrain
};

/// What in the heights would make a measurement silently wrong, one sentence each: a border of one value that is not
/// declared as no data, holes, heights below the sea or above all mountains.
HeightsNoticed notice_heights(const Raster&, const std::string& name);

}  // namespace thalweg::io
