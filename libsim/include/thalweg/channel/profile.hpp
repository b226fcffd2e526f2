// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "thalweg/channel/network.hpp"
#include "thalweg/terrain/graph.hpp"

namespace thalweg::channel {

/// The channel nodes alone, each after the one it flows to, as plain rows: what long profiles are made of.
struct Profile {
    std::vector<Index> node;       ///< of the graph
    std::vector<Index> below;      ///< place in these rows of the receiver, `none` at a base
    std::vector<Index> river;      ///< number of the base it flows to, counted from 0
    std::vector<double> length_m;  ///< to the receiver; 0 at a base
    std::vector<double> area_m2;   ///< drainage area
    std::vector<double> elevation_m;

    Index size() const { return static_cast<Index>(node.size()); }
};

/// A base is a channel node whose receiver is no channel (or which has none).
Profile channel_profile(const terrain::FlowGraph&, std::span<const std::uint8_t> channel,
                        std::span<const double> drainage_area_m2, std::span<const double> elevation_m);

/// χ = ∫ (A0/A)^θ dx from the base up (Perron & Royden 2013), in metres. Each step to the receiver counts with its
/// upper node's area, which is the water on it: where S = ks·A^(−θ) at every node, elevation is exactly linear in χ.
std::vector<double> chi(const Profile&, double theta, double reference_area_m2);

/// Steepness ksn = ks for the given θ (m^(2θ)): from each node down along the river to the first node at least
/// `smallest_drop_m` lower, drop over χ times A0^θ (0: to the receiver). NaN at a base and where the river
/// ends before it has fallen so far. `chi_m` as chi() gave it for the same θ and A0.
std::vector<double> steepness(const Profile&, std::span<const double> chi_m, double theta, double reference_area_m2,
                              double smallest_drop_m);

/// Steepness of each link (m^(2θ)): slope of the regression of elevation on χ over those of its nodes that the profile
/// holds, times A0^θ; NaN where fewer than two places in χ are left.
std::vector<double> link_steepness(const StreamNetwork&, const Profile&, std::span<const double> chi_m, double theta,
                                   double reference_area_m2);

}  // namespace thalweg::channel
