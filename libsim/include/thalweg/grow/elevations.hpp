// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "thalweg/grow/divides.hpp"
#include "thalweg/grow/links.hpp"

namespace thalweg::grow {

/// What the valley sides around a vertex say of its height, m; both the same on channels.
struct HeightRange {
    double least;    ///< above all channels that it drains to
    double allowed;  ///< the lowest that a sidewall reaches; may lie under `least`, which counts then
};

/// The bounds of which `elevations` takes one.
std::vector<HeightRange> height_ranges(const Network&, const Flint&, double base_level_m);

/// Elevation of every vertex (m).
///
/// Channels rise from the base level by Flint's gradient at their final magnitude: z2 = z1 + S·L (Kelley et al. 1988,
/// eq. 7). A ridge vertex belongs to several polygons. In each, the line from the nearest point of its link rises by
/// the sidewall slope, up to the sidewalls' reach and from there on level: what that side allows. It gets the lowest of
/// these heights, but in no polygon less than a tenth of the way from the link's point up to what that side allows, so
/// that it lies above every channel it drains to. Linear.
std::vector<double> elevations(const Network&, const Flint&, double base_level_m);

}  // namespace thalweg::grow
