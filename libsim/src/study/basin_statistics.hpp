// SPDX-License-Identifier: GPL-3.0-or-later
// Private: what is told of each basin.
#pragma once

#include <span>
#include <vector>

#include "thalweg/study/measure.hpp"

namespace thalweg::study {

/// One row per basin; takes the labels, the network, the slope–area points and the long profiles of the statistics.
/// Perimeters stay NaN.
std::vector<BasinStatistics> basin_statistics(const RoutedTerrain&, std::span<const double> ground_m,
                                              std::span<const terrain::Basin>, const Statistics&);

}  // namespace thalweg::study
