// SPDX-License-Identifier: GPL-3.0-or-later
#include "thalweg/infer/versions.hpp"

#include <ceres/version.h>

namespace thalweg::infer {

std::vector<std::pair<std::string, std::string>> library_versions() { return {{"Ceres", CERES_VERSION_STRING}}; }

}  // namespace thalweg::infer
