// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cmath>
#include <span>

#include "thalweg/core/topology.hpp"

namespace thalweg::terrain {

/// Topology, heights and boundary: what most algorithms here are given together.
template <Topology T>
struct Terrain {
    const T& topology;
    std::span<const double> elevation_m;
    std::span<const Boundary> boundary;

    bool has_data(Index node) const { return !std::isnan(elevation_m[node]); }
};

}  // namespace thalweg::terrain
