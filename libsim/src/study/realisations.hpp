// SPDX-License-Identifier: GPL-3.0-or-later
// Private: what a model makes with other seeds.
#pragma once

#include <filesystem>

#include "thalweg/study/analyze.hpp"

namespace thalweg::study {

/// The terrain that the experiment of a simulate or grow folder makes with a seed that is higher by `number`, as its
/// elevation.tif would hold it. `scratch` names a folder that is not there and will not be afterwards. Throws Error
/// where the experiment cannot be run again (a file that it names is gone).
NamedRaster realisation(const std::filesystem::path& model, Index number, const std::filesystem::path& scratch);

}  // namespace thalweg::study
