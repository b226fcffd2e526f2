// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <vector>

#include "thalweg/channel/network.hpp"

namespace thalweg::channel {

/// A chain of links of one Strahler order.
struct StrahlerStream {
    Index order;
    double length_m, drop_m;
    double area_m2;  ///< drainage area at its lower end
};

/// Every stream, outlets first. At most one inflow of a link has the link's own order, so a stream never forks.
std::vector<StrahlerStream> strahler_streams(const StreamNetwork&);

/// Strahler streams of one order: chains of links of that order.
struct OrderStatistics {
    Index order;
    Index streams;
    double mean_length_m;
    double mean_area_m2;  ///< drainage area at the stream's lower end
    double mean_slope;    ///< mean of drop over length of the streams
    double mean_drop_m;
};

std::vector<OrderStatistics> strahler_statistics(const StreamNetwork&);

/// One of Horton's ratios, both ways (NaN where fewer than two orders exist).
struct HortonRatio {
    double regression;  ///< 10^slope of log10(statistic) on order, with the sign that makes it above 1 for the law
    double mean_ratio;  ///< mean of the ratios of successive orders
    double regression_se;                    ///< from the scatter about the line; NaN with fewer than three orders
    std::array<double, 2> regression_ci95;   ///< by Student's t
};

/// Horton's laws (Horton 1945, Schumm 1956): bifurcation, length, area and slope ratio, each above 1 when the law
/// holds.
struct HortonRatios {
    HortonRatio bifurcation, length, area, slope;
};

HortonRatios horton_ratios(const std::vector<OrderStatistics>&);

}  // namespace thalweg::channel
