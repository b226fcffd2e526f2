// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <span>
#include <vector>

#include "thalweg/channel/network.hpp"
#include "thalweg/core/statistics.hpp"
#include "thalweg/terrain/graph.hpp"

namespace thalweg::channel {

/// One measured slope with the drainage area it belongs to, both > 0.
struct SlopeAreaPoint {
    double area_m2;
    double slope;       ///< m/m along the flow
    double weight = 1;  ///< what it counts in a mean: 1 for a node, its length (m) for a segment
    Index node = none;  ///< of the graph: the node itself, or a segment's lowest
};

/// Weighted mean of the points of one bin of area (of their logarithms).
struct SlopeAreaBin {
    double area_m2;   ///< geometric mean
    double slope;     ///< geometric mean
    double slope_se;  ///< standard error of the mean of ln slope, times slope; NaN for a single point
    Index count;
};

/// Steepness law S = ks·A^(−θ) (Flint 1974) fitted on the bins.
struct SlopeArea {
    Estimate theta;  ///< concavity θ
    Estimate ks;     ///< steepness, m^(2θ)
    double r2;
    std::vector<SlopeAreaBin> bins;
};

struct SegmentOptions {
    double drop_m;                    ///< fall of each segment
    double smallest_drop_m = 0;       ///< what a reach between two jumps must fall to be told from rounding of heights
    double largest_area_ratio = 1.6;  ///< a segment never crosses a larger jump of the area
    double smallest_area_m2 = 0;      ///< where channels begin
};

/// Slopes over segments of fixed drop along carved profiles, cut where a tributary makes the area jump (steps
/// of the DEM's vertical quantum make single-cell slopes useless). Each river is walked up from its mouth along the
/// donor of largest area; a node stands for the step to its receiver. `used`: 1 where a node may enter (empty: all).
///
/// A reach between two jumps is cut into pieces that fall at least `drop_m`, or is one piece if it falls less; only
/// reaches that fall less than `smallest_drop_m`, or not at all, are left out. A point has its piece's drop over its
/// length, the geometric mean area along it, and its length as weight. So the lengths and drops of all points add up to
/// those of the reaches, and steep stretches are not preferred. Linear.
///
/// Measured on steady rasters of 160² cells at 90 m (tests/channel/slope_area.cpp, m = 0.35 and 0.5, n = 1 and 1.5):
/// heights as they are: m within 0.0005 and k·A0^m within 0.2 %; rounded to 1 m at a relief of 800 and of 100 m: within
/// 0.01 and 2 %.
std::vector<SlopeAreaPoint> fixed_drop_segments(const terrain::FlowGraph&, std::span<const double> drainage_area_m2,
                                                std::span<const double> carved_elevation_m,
                                                std::span<const std::uint8_t> used, const SegmentOptions&);

/// The slope of every node to its receiver (a mesh, whose geometry is exact). Nodes with slope ≤ 0 or without receiver
/// are left out.
std::vector<SlopeAreaPoint> node_slopes(const terrain::FlowGraph&, std::span<const double> drainage_area_m2,
                                        std::span<const double> elevation_m, std::span<const std::uint8_t> used = {});

/// One point per link: its drop over its length, the geometric mean of the drainage area along it (each step with its
/// upper node's area, by its length, as in a segment) and its length as weight; `node` is the link's last above its
/// end. Links that do not fall are left out.
std::vector<SlopeAreaPoint> link_slopes(const StreamNetwork&, const terrain::FlowGraph&,
                                        std::span<const double> drainage_area_m2);

/// Ten bins per decade of area, averaged in the logarithm.
std::vector<SlopeAreaBin> slope_area_bins(std::span<const SlopeAreaPoint>, int bins_per_decade = 10);

/// The bins of node_slopes where these would be too many to hold, hillslopes and all.
struct NodeSlopeBins {
    std::vector<SlopeAreaBin> bins;
    std::size_t looked_at = 0;  ///< nodes in use with a receiver
    std::size_t level = 0;      ///< of them, those that do not fall, which no bin can hold
};

/// Linear, on several threads, the same bits for any number of them.
NodeSlopeBins node_slope_bins(const terrain::FlowGraph&, std::span<const double> drainage_area_m2,
                              std::span<const double> elevation_m, std::span<const std::uint8_t> used = {});

/// Where hillslopes, which steepen downstream, give way to channels, which flatten: the bin of largest mean slope, of
/// bins of at least five points. NaN where that is the first or the last one, so that one side is not seen.
struct Turnover {
    double area_m2;
    std::array<double, 2>
        range_m2;  ///< of the bins around it whose slope is less by under 1.96 errors of the difference
};
Turnover hillslope_turnover(std::span<const SlopeAreaBin>);

/// Standard error of each bin's mean ln slope, for weighing. A handful of points tells its own scatter badly, and a bin
/// whose points agree by chance would outweigh all others (the 95 % interval of a fit then covers 80 %); so the
/// variance of a point is the mean of the bin's own, which counts as its points − 1, and the one pooled over all bins,
/// which counts 4. Nowhere less than `smallest_se_dex` (in powers of ten: no bin is better than the power law itself).
std::vector<double> bin_errors(std::span<const SlopeAreaBin>, double smallest_se_dex);

/// Weighted regression of ln slope on ln area over the bins; `smallest_se` (dex) is a floor for a bin's error.
SlopeArea fit_slope_area(std::vector<SlopeAreaBin>, double smallest_se_dex = 0.01);

/// Vertical resolution of the heights: the largest q of which (nearly) all their differences are whole multiples, e.g.
/// 1 for integer metres, 0.3048 for whole feet; 0 when there is none above `smallest_m`. One height in a hundred may be
/// off (a patch of other origin), and each may be rounded to single precision. NaN is skipped; heights that are all
/// the same have none. Cost: sorting a sample of at most 65 536 heights.
double vertical_quantum(std::span<const double> elevation_m, double smallest_m = 0.001);

}  // namespace thalweg::channel
