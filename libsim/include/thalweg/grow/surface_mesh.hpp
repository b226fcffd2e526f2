// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "thalweg/grow/divides.hpp"
#include "thalweg/grow/links.hpp"

namespace thalweg::grow {

/// The network with every line cut into equal pieces of at most `longest_m`; the polygons run through the new vertices.
/// What there was keeps its number. Throws Error for a length that is not positive, or more vertices than 32-bit
/// numbers count.
Network subdivided(const Network&, double longest_m);

/// Where the surface's gradient on channels comes from.
enum class Thalweg : std::uint8_t {
    along_channel,  ///< the channel's own, so that it is the lowest line between its sides
    minimum_norm    ///< found like all others: where one side is steeper, the lowest line moves to the other
};

/// Triangles between the lines of a network, for a surface that follows them.
struct SurfaceMesh {
    std::vector<double> x, y;              ///< relative to the network's origin, m
    std::vector<double> height;            ///< m
    std::vector<std::uint8_t> on_channel;  ///< 1 for vertices on links
    /// Per vertex, m/m: on channels the gradient along the link, 0 at junctions; NaN elsewhere.
    std::vector<double> channel_slope_x, channel_slope_y;
    std::vector<Edge> lines;                      ///< pieces of links, divides and outline, by their vertices
    std::vector<std::array<Index, 3>> triangles;  ///< counter-clockwise, the whole basin
    std::vector<Index> vertex_of;                 ///< number here of each vertex of the network

    Index size() const { return static_cast<Index>(x.size()); }
};

/// Constrained Delaunay triangulation of the network's lines, cut into pieces of at most `longest_m`: every polygon is
/// triangulated by itself, so no triangle crosses a channel or a divide, and none lies flat along a channel. Heights
/// are those of `elevations`, which new vertices on divides take from their own place: a divide is as high as the
/// valley sides allow all along, not a straight line between its ends. Where side by side one polygon allows much more
/// than the next, that would make walls, over which no smooth surface goes: so no vertex is higher than the steepest
/// valley side of all rises to it from any neighbour, unless it must be to lie above its channels. Where a polygon goes
/// on beyond the reach of its valley side, there are also vertices within it, on a square lattice of half that reach
/// or `longest_m`, whichever is more. Vertices are numbered along a Hilbert curve. Cost: about 1 µs per vertex. Throws
/// Error as `subdivided`.
SurfaceMesh surface_mesh(const Network&, const Flint&, double base_level_m, double longest_m);

}  // namespace thalweg::grow
