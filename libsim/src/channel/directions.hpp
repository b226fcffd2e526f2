// SPDX-License-Identifier: GPL-3.0-or-later
// Private: directions of links at junctions.
#pragma once

#include <array>
#include <cmath>
#include <numbers>
#include <span>
#include <vector>

#include "thalweg/channel/links.hpp"

namespace thalweg::channel {

/// Up to two links that flow into each link, and how many there are.
struct JunctionInflows {
    Index count = 0;
    std::array<Index, 2> link{none, none};
};

std::vector<JunctionInflows> junction_inflows(const StreamNetwork&);

/// From the link's lower end up to where its direction is taken: the first node at least `reach_m` along.
Point upstream_direction(std::span<const Index> nodes, const OffsetOf&, double reach_m);

/// From the link's upper end down to where its direction is taken.
Point downstream_direction(std::span<const Index> nodes, const OffsetOf&, double reach_m);

/// Counterclockwise from one direction to another, in [0, 2π).
double turn(const Point& from, const Point& to);

double angle_between(const Point& a, const Point& b);

/// The two inflows of a junction, the main one first.
std::array<Index, 2> main_and_tributary(const StreamNetwork&, const JunctionInflows&);

/// Three links that meet.
struct Meeting {
    Index below, main, tributary;
};

/// Whether the tributary comes from the left of the way from the main inflow to the link below, looking downstream.
bool is_left_of(const StreamNetwork&, const OffsetOf&, double reach_m, const Meeting&);

}  // namespace thalweg::channel
