// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>

#include "thalweg/channel/profile.hpp"
#include "thalweg/core/statistics.hpp"

namespace thalweg::channel {

struct ConcavityOptions {
    Index smallest_river = 20;  ///< nodes below which a river does not count
    Index smallest_sample = 5;  ///< rivers (or tributaries) below which there is no error
    Index resamples = 500;
    Index most_sorted = 20000;  ///< nodes with which the bootstrap of the disorder works: every so many-th is enough
    std::uint64_t seed = 1;
};

/// The concavity θ of rivers by three rules, each evaluated for θ = 0 to 1.5 by steps of 0.025, its least refined by a
/// parabola; NaN where the least lies at an end.
///
/// - `linearity`: elevation is most nearly linear in χ (Perron & Royden 2013), trunk and tributaries alike: the least
///   sum over the rivers of nodes·(1 − R²), each river (all that flows to one base) with a line of its own. Needs
///   uniform uplift and rock all along a river.
/// - `collinearity`: tributaries lie on their trunk in χ–elevation (Mudd et al. 2018): the least mean square of the
///   difference in elevation between a tributary's node and the trunk (the main stream by drainage area) at the same χ,
///   over the nodes whose χ the trunk reaches. Holds also where trunk and tributaries share a transient.
/// - `disorder`: nodes in the order of their elevation have χ in order too (Goren et al. 2014, Hergarten & Robl 2016):
///   the least mean over the rivers, by nodes, of (Σ|χ_(i+1) − χ_i| − range of χ)/range of χ. Free of any line.
///
/// The interval are the 2.5 and 97.5 % quantiles of a bootstrap over the rivers, the error half its width over 1.96:
/// both are of the same, where few blocks give a skewed lot with outliers, whose standard deviation may be twice as
/// large. A resample whose least lies at an end of the range counts there; an interval that ends at 0 or 1.5 may go on
/// beyond and has no error. Only rivers that say anything of θ are drawn (for collinearity and disorder those with
/// tributaries). Where there are fewer than `smallest_sample` of them, collinearity and disorder resample the
/// trunks' tributaries instead: the trunk's own scatter is then not in the error, which is too small (with slopes
/// scattered by a factor of 1.35 from node to node the interval held the truth in about 60 of 100 single rivers; with
/// twenty of them, in 90 for collinearity and 75 for disorder, whose least itself is shifted by scatter). NaN for fewer
/// than `smallest_sample` of those as well, and where an end of the interval is the estimate or lies on its other side,
/// as when one of a few tributaries decides all. Cost: 61 passes over the nodes.
struct Concavity {
    Estimate linearity, collinearity, disorder;
};

Concavity concavity(const Profile&, const ConcavityOptions& = {});

}  // namespace thalweg::channel
