// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "thalweg/grow/divides.hpp"
#include "thalweg/grow/links.hpp"
#include "thalweg/study/measure.hpp"

namespace thalweg::study {

/// What is counted and fitted on a grown tree: by the same functions as on the channels of a terrain.
struct TreeStatistics {
    ChannelStatistics channels;  ///< threshold and source areas NaN; `nodes`: the links' vertices
    std::vector<channel::OrderStatistics> strahler;
    channel::HortonRatios horton;
    NetworkStatistics laws;   ///< area_exceedance NaN: a tree has no cells
    PowerLawFit flint_links;  ///< Flint's law over single links instead of classes of magnitude
};

TreeStatistics tree_statistics(const grow::Network&, const channel::StreamNetwork&);

/// Angles between each tributary and the prolongation of the link below, rad: as drawn (E1 at the magnitudes that the
/// junction had then), and Howard's at the final magnitudes.
struct TributaryAngles {
    Index count;
    double drawn_mean, drawn_sd;
    double howard_mean, howard_sd;
};

TributaryAngles tributary_angles(const grow::Network&, const grow::Flint&);

/// How much of a tree an analysis of its terrain finds again.
struct Recovery {
    Index grown, found, recovered;  ///< junctions of the tree; of the analysis; of the tree's those found again
    Index unmatched;                ///< junctions of the analysis that the tree does not have
    double tree_length_m, found_length_m;
};

/// A junction is found again if the analysis has one within `within_m` of it, and false if the tree has none that near.
/// Positions are in the coordinates of the places.
Recovery recovery(std::span<const Point> grown_junctions, double tree_length_m, const channel::StreamNetwork& found,
                  const std::function<Point(Index)>& position, double within_m);

}  // namespace thalweg::study
