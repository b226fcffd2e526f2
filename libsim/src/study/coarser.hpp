// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "thalweg/core/raster.hpp"

namespace thalweg::study {

/// The raster with about that many cells along its longer side: means over blocks of cells, of those with data, no data
/// where fewer than half have any. For pictures: lengths of the new cells are taken at their blocks' middles. A raster
/// that has no more cells than asked for stays itself.
Raster coarser(const Raster&, Index longer_side);

}  // namespace thalweg::study
