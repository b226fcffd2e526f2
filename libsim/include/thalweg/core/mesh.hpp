// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <vector>

#include "thalweg/core/point.hpp"
#include "thalweg/core/topology.hpp"

namespace thalweg {

/// Triangulated irregular network: points, their Delaunay neighbours and Voronoi cell areas, as flat arrays.
///
/// Neighbours are compressed rows: those of node i are neighbor_list[offset[i] … offset[i + 1]), ascending, with the
/// planar distance to each in `length_list`. Nodes are numbered along a Hilbert curve, so that neighbours in space are
/// mostly neighbours in memory. `thalweg/mesh/triangulate.hpp` makes one.
struct Mesh {
    std::vector<double> x;                       ///< m
    std::vector<double> y;                       ///< m
    std::vector<double> cell_area;               ///< Voronoi cell clipped to the domain, m²
    std::vector<Index> offset;                   ///< size() + 1
    std::vector<Index> neighbor_list;
    std::vector<double> length_list;             ///< m
    std::vector<std::uint8_t> on_outline;        ///< 1 for the vertices of the domain's outline
    std::vector<std::array<Index, 3>> triangles; ///< counter-clockwise
    Polygon outline;                             ///< of the domain, counter-clockwise, m

    Index size() const { return static_cast<Index>(x.size()); }
    double area(Index node) const { return cell_area[node]; }
    Index neighbor(Index node, Slot slot) const { return neighbor_list[offset[node] + slot]; }
    double length(Index node, Slot slot) const { return length_list[offset[node] + slot]; }

    /// The slot under which the neighbour knows `node`: a walk over the neighbour's (about six) neighbours.
    Slot reverse(Index node, Slot slot) const {
        const Index other = neighbor(node, slot);
        Slot back = 0;
        while (neighbor(other, back) != node) ++back;
        return back;
    }

    template <class Visit>
    void neighbors(Index node, Visit visit) const {
        const Index first = offset[node];
        for (Index at = first; at < offset[node + 1]; ++at) {
            visit(neighbor_list[at], length_list[at], static_cast<Slot>(at - first));
        }
    }
};

static_assert(Topology<Mesh>);

}  // namespace thalweg
