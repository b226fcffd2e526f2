// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <span>
#include <vector>

#include "grow/source_order.hpp"
#include "grow/subdivision.hpp"
#include "thalweg/grow/links.hpp"

namespace thalweg::grow {

/// What a link is while the network grows. A split link keeps its number for its lower half.
struct GrowingLink {
    Index edge;  ///< half-edge from its lower to its upper vertex
    Index downstream = none;
    std::array<Index, 2> upstream{none, none};  ///< its stream's, the tributary
    Index stream = 0;
    Index mark = 0;      ///< in the order of sources, before all those upstream
    double start_m = 0;  ///< along its stream, from the mouth
    double length_m = 0;
    std::array<double, 2> area_m2{};         ///< left, right polygon
    std::array<double, 2> sidewall_slope{};  ///< left, right

    double area() const { return area_m2[0] + area_m2[1]; }
    bool is_exterior() const { return upstream[0] == none; }
};

struct GrowingStream {
    double length_m;
    Index junction;  ///< at its mouth; `none` for the trunk
};

struct GrowingTree {
    Subdivision basin;
    std::vector<GrowingLink> links;
    std::vector<GrowingStream> streams;
    std::vector<Junction> junctions;  ///< of link numbers, only `tributary` lasts while the tree grows
    SourceOrder sources;
    double length_m = 0;

    Index magnitude(Index link) const {
        return sources.count(links[link].mark, SourceOrder::source(links[link].stream));
    }
};

/// Brings polygons, streams and marks of some links into the cache, waiting for all at once instead of for one after
/// another. Changes nothing.
void fetch_ahead(const GrowingTree&, std::span<const Index> links);

/// Numbers everything from the outlet up and leaves out what is no longer used.
Network finished(const GrowingTree&, const Point& origin);

}  // namespace thalweg::grow
