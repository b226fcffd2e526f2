// SPDX-License-Identifier: GPL-3.0-or-later
// Private: pictures of a network while it grows.
#pragma once

#include <filesystem>

#include "study/report_json.hpp"
#include "thalweg/study/grow.hpp"

namespace thalweg::study {

/// Numbers of links at which `frames` pictures show a network that grows to `links`: from the trunk alone to the whole,
/// each so many times the one before; fewer pictures where numbers coincide. Throws Error for networks too large to be
/// drawn (1e5 links; a picture has some 500 bytes for each).
std::vector<Index> links_shown(Index links, Index frames);

/// A network in plan, an SVG: the polygons left and right of each link in two colours, divides as thin lines, channels
/// as wide as the cube root of their magnitude, what streams are numbered from `new_from` on in red. 1000 pixels along
/// the longer side of the basin, whatever the stage.
std::string plan_of(const grow::Network&, Index new_from);

/// Writes frames/frame_0001.svg and so on; gives what stands in each, for the summary.
Json write_frames(const GrownTerrain&, const std::filesystem::path& folder);

}  // namespace thalweg::study
