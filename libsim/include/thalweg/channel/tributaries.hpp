// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "thalweg/channel/links.hpp"
#include "thalweg/channel/main_streams.hpp"
#include "thalweg/channel/network.hpp"
#include "thalweg/core/statistics.hpp"

namespace thalweg::channel {

/// Sides of a river, looking downstream.
enum class Bank : std::uint8_t { left, right };

/// A stream that joins another where exactly two rivers meet.
struct Tributary {
    Index stream;       ///< its number among the streams
    Index link;         ///< its lowest link
    Index parent;       ///< stream that it joins
    double place;       ///< of the junction on the parent: share of its length from the mouth up, 0 to 1
    Bank bank;          ///< of the parent from which it comes
    Index older_below;  ///< in this list: the next older tributary down the same parent, `none` without one
    double division;    ///< where it parted its parent between the next older tributaries (or mouth and source), 0 to 1
};

/// All of them, in order of the links. Which streams there are is for `streams` to say (`straightest_streams` fits how
/// networks grow); banks are told by directions over `reach_m`, as the junction angles are. Of the tributaries of one
/// parent that with the larger drainage area counts as the older one (ties: the lower), for it has had more time to
/// branch. A place where three or more rivers meet has no tributary. Linear.
std::vector<Tributary> tributaries(const StreamNetwork&, const MainStreams& streams, const OffsetOf&, double reach_m);

/// A quantity as the growth of networks draws it, uniform on [mean − delta, mean + delta]: of a sample the mean, and
/// the half-width √3·sd of the uniform distribution that has its standard deviation.
struct UniformDraw {
    Index count;
    Estimate mean;   ///< NaN where there is none; its error is NaN for fewer than two
    Estimate delta;  ///< NaN for fewer than two; error of a uniform sample's
};

/// `weights`, where given, are the sizes of what each value stands for; the errors then are those of (Σw)²/Σw² values.
UniformDraw uniform_draw(std::span<const double> sample, std::span<const double> weights = {});

/// Where tributaries part their parents.
UniformDraw junction_places(std::span<const Tributary>);

/// A share of so many cases, with its binomial standard error.
struct Share {
    Index count;
    double value;  ///< NaN without cases
    double standard_error;
};

/// From which sides tributaries come, by the third of the parent that they join: lower, middle, upper (Flint 1980).
struct SideChoices {
    std::array<Share, 3> obtuse;    ///< on the parent's obtuse side, which faces down the valley that the parent joins
    std::array<Share, 3> opposite;  ///< on the other side than the next older tributary downstream
};

/// The obtuse side of a stream is the bank on the same hand as the bank of its own parent from which it comes; streams
/// that end at an outlet, or where three rivers meet, have none and count for `opposite` alone.
SideChoices side_choices(std::span<const Tributary>);

}  // namespace thalweg::channel
