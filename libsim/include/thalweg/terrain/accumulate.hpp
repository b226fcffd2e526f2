// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <span>
#include <vector>

#include "thalweg/terrain/graph.hpp"

namespace thalweg::terrain {

/// Sum of `amount` over each node and everything upstream of it. With cell areas (m²) this is the drainage area (m²).
/// Donors are added in a fixed order. Nodes without data stay 0.
std::vector<double> accumulate(const FlowGraph&, std::span<const double> amount);

/// Area of every node's cell, m².
std::vector<double> cell_areas(const Grid&);
std::vector<double> cell_areas(const Mesh&);

/// Smallest value of `elevation_m` at or upstream of each node: the carved surface, which falls along every flow path
/// without ever having been filled (breaching: what stands in the way of lower water is cut through).
std::vector<double> carve(const FlowGraph&, std::span<const double> elevation_m);

/// Largest value at or upstream of each node: what it takes for a threshold, once passed, to stay passed downstream.
/// Nodes without data keep theirs.
std::vector<double> largest_upstream(const FlowGraph&, std::span<const double> values);

}  // namespace thalweg::terrain
