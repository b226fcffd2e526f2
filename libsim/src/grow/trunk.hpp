// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "grow/growing_tree.hpp"
#include "thalweg/grow/basin.hpp"

namespace thalweg::grow {

/// The basin in coordinates relative to the outlet, cut in two along the trunk and straight on from its source to the
/// edge. The whole trunk is one link still, whose half-edge is its first piece: each bend is to get a junction
/// (`plan_bend`). Throws Error for a source on the outline, or from which straight on the trunk itself lies.
GrowingTree cut_along_trunk(const Basin&, double channel_maintenance_m);

}  // namespace thalweg::grow
