// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "thalweg/terrain/graph.hpp"

namespace thalweg::channel {

/// Mean drops of Strahler streams when channels begin at a threshold (Broscoe 1959).
struct DropTest {
    double threshold;
    Index first_order, higher_order;  ///< streams
    double first_mean_m, higher_mean_m;
    double t;  ///< of the difference of the means, pooled variance; NaN for fewer than two streams on either side
};

/// One test per threshold: channels are the nodes where `measure` (drainage area, or area times a power of slope made
/// to grow downstream) reaches it, and `used` (empty: all).
std::vector<DropTest> drop_analysis(const terrain::FlowGraph&, std::span<const double> measure,
                                    std::span<const double> drainage_area_m2, std::span<const double> elevation_m,
                                    std::span<const std::uint8_t> used, std::span<const double> thresholds);

/// The smallest threshold at which the mean drops of first-order streams do not differ from those of higher ones,
/// |t| < 2. Where larger ones differ again the mean drops may only cross there, from first-order streams that fall
/// further to such that fall less.
std::optional<double> first_threshold_by_drops(std::span<const DropTest>);

/// The smallest threshold from which on they do not differ. Tests with fewer than five streams on either side say
/// nothing, neither for nor against. Of the larger thresholds one may say otherwise with |t| < 3: of ten tests of
/// streams that fall alike, one comes to 2 in four cases of ten by chance.
std::optional<double> lasting_threshold_by_drops(std::span<const DropTest>);

/// The lasting threshold, the finest network that obeys the law of constant drops as all coarser ones do (Tarboton,
/// Bras & Rodriguez-Iturbe 1991); where there is none, the first.
std::optional<double> threshold_by_drops(std::span<const DropTest>);

/// The slope–area product A·S² (m²; Montgomery & Dietrich 1992), the largest at or upstream of each node, so that a
/// channel once begun goes on. S is the slope to the receiver on the conditioned surface; 0 where nothing falls.
std::vector<double> slope_area_product(const terrain::FlowGraph&, std::span<const double> drainage_area_m2,
                                       std::span<const double> elevation_m);

}  // namespace thalweg::channel
