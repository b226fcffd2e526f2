// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <utility>
#include <vector>

namespace thalweg::render {

/// Name and version of each library this module stands on, for the manifest.
std::vector<std::pair<std::string, std::string>> library_versions();

}  // namespace thalweg::render
