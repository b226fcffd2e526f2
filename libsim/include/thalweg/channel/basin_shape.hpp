// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <span>
#include <vector>

#include "thalweg/channel/links.hpp"
#include "thalweg/channel/main_streams.hpp"
#include "thalweg/channel/network.hpp"
#include "thalweg/terrain/basins.hpp"

namespace thalweg::channel {

/// Numbers without a unit that tell a basin's shape; NaN where a measure that one needs is not known, or is 0.
struct BasinShape {
    double form_factor;   ///< A/L² (Horton 1932)
    double circularity;   ///< 4πA/P² (Miller 1953): 1 for a circle
    double elongation;    ///< 2·√(A/π)/L (Schumm 1956): diameter of the circle of the same area over the length
    double relief_ratio;  ///< H/L (Schumm 1956)
    double ruggedness;    ///< H/√A (Melton 1965)
};

/// Of area A (m²), straight length L from the mouth, perimeter P and relief H (m).
BasinShape basin_shape(double area_m2, double length_m, double perimeter_m, double relief_m);

/// Straight distance (m) from each basin's outlet to the farthest of its nodes. `offset` as for the angles: on a
/// geographic grid on the plane that touches the earth there. Linear.
std::vector<double> basin_lengths(const terrain::BasinNodes&, std::span<const terrain::Basin>, const OffsetOf&);

/// Area (m²) that reaches a basin's trunk from either side, looking downstream.
struct TrunkSides {
    double left_m2, right_m2;

    /// Asymmetry factor, 100·right/(left + right) (Hare & Gardner 1985): 50 % where the trunk runs in the middle; NaN
    /// where nothing reaches it.
    double asymmetry_percent() const { return 100 * right_m2 / (left_m2 + right_m2); }
};

/// The trunk is the main stream (largest area at each junction) that ends in the basin's outlet. What flows into it
/// comes from the left or the right of its course there; what flows into its source, or into an outlet from which the water
/// goes nowhere, and the trunk's own cells, from neither. Both are 0 where no link ends in the outlet. Linear.
std::vector<TrunkSides> trunk_sides(const terrain::FlowGraph&, std::span<const double> drainage_area_m2,
                                    const StreamNetwork&, const MainStreams& of_links, std::span<const terrain::Basin>,
                                    const OffsetOf&);

}  // namespace thalweg::channel
