// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <optional>

#include "grow/growing_tree.hpp"
#include "thalweg/grow/grow.hpp"

namespace thalweg::grow {

/// Where the divides of a junction run between the two links that each one parts.
struct DivideShares {
    double across;  ///< from the downstream link to the upstream one
    double below;   ///< from the downstream link to the tributary
    double above;   ///< from the tributary to the upstream link
};

/// The drawn part of a new tributary.
struct TributaryDraw {
    double share_of_link;  ///< from the lower end; a bend is where it is
    Side side;             ///< a bend's is the outer one
    double share_of_way;   ///< to the polygon's edge
    std::array<double, 2> sidewall_slope;
    std::optional<DivideShares> divides;  ///< nothing: by the slopes
    double shortest_m;                    ///< no room for less
    double longest_m;                     ///< a longer one is cut
};

/// What leaves a junction other than the downstream link.
enum class Arm : std::uint8_t { divide, tributary, upstream_link };

struct PlannedRay {
    Arm arm;
    double angle_rad;  ///< from the link's upstream direction, counter-clockwise
    Ray ray;
    Hit hit;
};

/// A tributary that fits, with all the lines that come with it.
struct JunctionPlan {
    Index link;
    TributaryDraw draw;
    Index magnitude;  ///< of the link before
    Point place;
    double angle_rad;
    double turn_rad;
    std::array<PlannedRay, 5> rays;  ///< counter-clockwise from the downstream link
    Index ray_count = 0;
    Index bend_of = none;  ///< for a bend of the trunk: half-edge of the next piece
    double tributary_length_m = 0;
    double lower_length_m = 0;
    double upstream_length_m = 0;
};

/// A plan, or nothing if the tributary or a turned upstream link would be too short, or the lines too close to tell
/// apart.
std::optional<JunctionPlan> plan_junction(const GrowingTree&, const Dials&, Index link, const TributaryDraw&);

/// Whether a link is one straight piece: the trunk is not before each of its bends has a junction.
bool is_straight(const GrowingTree&, Index link);

/// The same at the first bend of a trunk, whose tributary goes to the outer side. Its divides are not drawn but halve
/// the angles, so that no draw keeps a trunk from being; those that would run into the trunk itself are turned until
/// they do not; nothing if none can be, or if the tributary cannot reach the basin's edge.
std::optional<JunctionPlan> plan_bend(const GrowingTree&, const Dials&, Index link, TributaryDraw);

/// Carries it out: three links where there was one. The lower half keeps the link's number, the upper half and the
/// tributary get the next two.
void make_junction(GrowingTree&, const JunctionPlan&);

/// Half-edge from an exterior link's source on to the divide.
inline Index head_of(const GrowingTree& tree, Index link) { return tree.basin.next(tree.links[link].edge); }

}  // namespace thalweg::grow
