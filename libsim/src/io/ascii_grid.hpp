// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>

#include "io/gdal_guard.hpp"

namespace thalweg::io {

/// GDAL reads what is no number in an ASCII grid (ArcInfo's, GRASS's) as zero or by its first digits, and numbers by
/// their count whatever the lines say, all in silence. Throws Error for such words and for more or fewer numbers than
/// the header speaks of; other formats pass. One pass over the text.
void check_ascii_grid(GDALDataset&, const std::string& name);

}  // namespace thalweg::io
