// SPDX-License-Identifier: GPL-3.0-or-later
#include "thalweg/mesh/versions.hpp"

#include <CGAL/version.h>

namespace thalweg::mesh {

std::vector<std::pair<std::string, std::string>> library_versions() { return {{"CGAL", CGAL_VERSION_STR}}; }

}  // namespace thalweg::mesh
