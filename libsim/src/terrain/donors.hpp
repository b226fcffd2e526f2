// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "terrain/downhill.hpp"
#include "thalweg/core/grid.hpp"
#include "thalweg/core/mesh.hpp"

namespace thalweg::terrain {

/// How many neighbours flow to each node.
void count_donors(const Grid&, const FlowDirections&, std::vector<std::uint8_t>& donors);
void count_donors(const Mesh&, const FlowDirections&, std::vector<std::uint8_t>& donors);
void count_donors(const MeshFlow&, const FlowDirections&, std::vector<std::uint8_t>& donors);

}  // namespace thalweg::terrain
