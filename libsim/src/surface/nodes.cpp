// SPDX-License-Identifier: GPL-3.0-or-later
#include "surface/nodes.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "thalweg/core/error.hpp"

namespace thalweg::surface {

/// Down the distances over the neighbours. The straight line from a corner of the place's own triangle leaves a node's
/// cell only to a neighbour nearer to the place, so the walk ends at the nearest node, after a step or two.
Index walk_to_nearest(const Mesh& mesh, const std::array<Index, 3>& t, const Point& p) {
    const auto nearer = [&](Index a, Index b) {
        const double to_a = distance2(node_at(mesh, a), p);
        const double to_b = distance2(node_at(mesh, b), p);
        return to_a < to_b || (to_a == to_b && a < b);
    };
    Index nearest = *std::min_element(t.begin(), t.end(), nearer);
    for (Index here = none; here != nearest;) {
        here = nearest;
        mesh.neighbors(here, [&](Index other, double, Slot) {
            if (nearer(other, nearest)) nearest = other;
        });
    }
    return nearest;
}

void check_one_value_per_node(const Mesh& mesh, std::span<const double> node_values) {
    if (node_values.size() != mesh.size()) {
        throw Error(fmt::format("{} values for the {} nodes of the mesh", node_values.size(), mesh.size()));
    }
}

}  // namespace thalweg::surface
