// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <span>

#include "surface/coverage.hpp"
#include "thalweg/core/mesh.hpp"

namespace thalweg::surface {

inline Point node_at(const Mesh& mesh, Index node) { return {mesh.x[node], mesh.y[node]}; }

inline double distance2(const Point& a, const Point& b) {
    return (a.x - b.x) * (a.x - b.x) + (a.y - b.y) * (a.y - b.y);
}

inline Triangulation plane_of(const Mesh& mesh) { return {mesh.x, mesh.y, mesh.triangles}; }

/// The node nearest to a place inside triangle t, the lower number of equals.
Index walk_to_nearest(const Mesh&, const std::array<Index, 3>& t, const Point&);

/// Throws Error.
void check_one_value_per_node(const Mesh&, std::span<const double> node_values);

}  // namespace thalweg::surface
