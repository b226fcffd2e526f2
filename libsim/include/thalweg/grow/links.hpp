// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "thalweg/channel/network.hpp"
#include "thalweg/core/index.hpp"
#include "thalweg/core/point.hpp"

namespace thalweg::grow {

/// Sides as seen looking upstream.
enum class Side : std::uint8_t { left, right };

/// What a line of the subdivided basin is.
enum class EdgeKind : std::uint8_t {
    outline,  ///< of the basin
    channel,  ///< of a link
    divide,   ///< between the valleys of two links that meet
    head      ///< from a source on to the divide: parts the left and right polygon of an exterior link
};

struct Edge {
    Index from;
    Index to;
    EdgeKind kind;
};

/// How a tributary joined its stream, and with what it was drawn. Magnitudes grow later; these stay.
struct Junction {
    Index vertex;
    Index downstream;  ///< link
    Index upstream;    ///< link of the stream that was joined
    Index tributary;   ///< link
    Side side;         ///< of the stream on which the tributary lies
    Index magnitude;   ///< of the downstream link just after the tributary (magnitude 1) had joined
    double angle_rad;  ///< E1, between the tributary and the prolongation of the downstream link
    double turn_rad;   ///< E2, by which the upstream link was turned the other way; 0 if it kept its line
};

/// A grown network: a binary tree of straight links, the left and right drainage polygon of each, and the lines between
/// them. Links are numbered from the outlet up: a link comes after the one it flows into; link 0 ends at the outlet.
///
/// The polygons are a partition of the basin with shared vertices: where a line ends on a side of a polygon, its end is
/// a vertex of that polygon too. So the lines, as constraints, triangulate without further points.
struct Network {
    Point origin;                 ///< where the vertices' (0, 0) is, m: near coordinates keep their digits
    std::vector<Point> vertices;  ///< relative to the origin, m
    std::vector<Edge> edges;      ///< each line once, in no direction

    std::vector<Index> downstream;               ///< link it flows into, `none` at the outlet
    std::vector<std::array<Index, 2>> upstream;  ///< links that flow into it: its stream's, the tributary; or `none`
    std::vector<Index> lower;                    ///< vertex
    std::vector<Index> upper;                    ///< vertex
    std::vector<Index> magnitude;                ///< sources upstream (Shreve 1966)
    std::vector<Index> stream;                   ///< main channel from a source to its mouth; 0 is the trunk
    std::vector<double> length_m;
    std::vector<std::array<double, 2>> sidewall_slope;  ///< of the left and right valley side, m/m
    double sidewall_reach_m =
        std::numeric_limits<double>::infinity();  ///< farther from its link no side rises any more

    std::vector<Index> polygon_offset;    ///< 2 links + 1: left polygon of link i is 2i, right 2i + 1
    std::vector<Index> polygon_vertices;  ///< counter-clockwise; left: lower, upper, …; right: upper, lower, …
    std::vector<double> polygon_area_m2;  ///< 2 links

    std::vector<Junction> junctions;

    Index size() const { return static_cast<Index>(downstream.size()); }
    bool is_exterior(Index link) const { return upstream[link][0] == none; }
    std::span<const Index> polygon(Index link, Side side) const {
        const Index number = 2 * link + static_cast<Index>(side);
        return std::span(polygon_vertices)
            .subspan(polygon_offset[number], polygon_offset[number + 1] - polygon_offset[number]);
    }
    double area_m2(Index link) const { return polygon_area_m2[2 * link] + polygon_area_m2[2 * link + 1]; }
};

/// Sum of the links' lengths, m.
double total_length(const Network&);

/// Sum of the polygons' areas, m².
double total_area(const Network&);

/// The tree as every statistic takes it: same link numbers; the nodes of a link are its upper and lower vertex, its
/// area that of all polygons upstream and its own. `elevation_m` per vertex gives the drops.
channel::StreamNetwork stream_network(const Network&, std::span<const double> elevation_m);

}  // namespace thalweg::grow
