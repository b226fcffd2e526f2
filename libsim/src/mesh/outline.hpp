// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "thalweg/core/point.hpp"

namespace thalweg::mesh {

/// The outline, counter-clockwise.
/// Throws Error if it is not a simple polygon of positive area with finite corners.
Polygon checked_outline(const Polygon& outline);

}  // namespace thalweg::mesh
