// SPDX-License-Identifier: GPL-3.0-or-later
#include "thalweg/render/versions.hpp"

#include <embree3/rtcore_config.h>

namespace thalweg::render {

std::vector<std::pair<std::string, std::string>> library_versions() { return {{"Embree", RTC_VERSION_STRING}}; }

}  // namespace thalweg::render
