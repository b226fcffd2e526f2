// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <vector>

#include "thalweg/core/raster.hpp"

namespace thalweg::io {

/// What in the heights would make a measurement silently wrong, one sentence each: a border of one value that is not
/// declared as no data, holes, heights below the sea.
std::vector<std::string> survey_heights(const Raster&, const std::string& name);

}  // namespace thalweg::io
