// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "thalweg/study/measure.hpp"

namespace thalweg::study {

/// The options with what their rule leaves open decided on this terrain: for `area` and `drop` the channel area, for
/// `slope_area` the heads. `evidence` tells by which tests. Throws Error where no threshold has constant drops.
MeasureOptions with_channels_chosen(const RoutedTerrain&, const MeasureOptions&, ChannelEvidence& evidence);

/// Channels that may enter statistics: of `channel_nodes` those in complete catchments, unless all are asked for.
std::vector<std::uint8_t> channels_in_use(const RoutedTerrain&, const MeasureOptions&, double threshold_m2);

/// What may enter statistics: complete catchments, or (empty) everything.
std::span<const std::uint8_t> nodes_in_use(const RoutedTerrain&, const MeasureOptions&);

}  // namespace thalweg::study
