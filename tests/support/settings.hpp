// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "thalweg/core/grid.hpp"
#include "thalweg/core/mesh.hpp"
#include "thalweg/core/random.hpp"
#include "thalweg/evolve/landscape.hpp"

namespace thalweg::support {

inline std::vector<Boundary> rim(const Grid& grid) {
    std::vector<Boundary> boundary(grid.size(), Boundary::interior);
    for (Index node = 0; node < grid.size(); ++node) {
        const Index r = grid.row(node), c = grid.col(node);
        const bool edge = r == 0 || c == 0 || r + 1 == grid.rows || c + 1 == grid.cols;
        if (edge) boundary[node] = Boundary::base_level;
    }
    return boundary;
}

inline std::vector<Boundary> rim(const Mesh& mesh) {
    std::vector<Boundary> boundary(mesh.size(), Boundary::interior);
    for (Index node = 0; node < mesh.size(); ++node) {
        if (mesh.on_outline[node]) boundary[node] = Boundary::base_level;
    }
    return boundary;
}

/// Even uplift and rain, the whole rim at base level.
template <class T>
evolve::Setting island(const T& topology, double uplift_m_per_yr) {
    return {.uplift_m_per_yr = std::vector<double>(topology.size(), uplift_m_per_yr),
            .rainfall = std::vector<double>(topology.size(), 1.0),
            .boundary = rim(topology)};
}

/// Heights at random between 0 and `amplitude_m`, 0 at base level.
inline evolve::Landscape rough_start(const evolve::Setting& setting, double amplitude_m, std::uint64_t seed) {
    evolve::Landscape landscape;
    for (Index node = 0; node < setting.boundary.size(); ++node) {
        const bool base = setting.boundary[node] == Boundary::base_level;
        landscape.elevation_m.push_back(base ? 0.0 : amplitude_m * uniform_at(seed, 5, node));
    }
    return landscape;
}

}  // namespace thalweg::support
