// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstring>
#include <vector>

#include "thalweg/core/raster.hpp"
#include "thalweg/mesh/triangulate.hpp"

namespace support {

using namespace thalweg;

inline Mesh poisson_mesh(const Polygon& outline, Index count, std::uint64_t seed = 1) {
    return mesh::triangulate(outline, mesh::poisson_disk_count(outline, count, seed));
}

template <class Height>
std::vector<double> node_values(const Mesh& mesh, Height height) {
    std::vector<double> values(mesh.size());
    for (Index node = 0; node < mesh.size(); ++node) values[node] = height(mesh.x[node], mesh.y[node]);
    return values;
}

/// visit(cell, centre)
template <class Visit>
void visit_centers(const Raster& raster, Visit visit) {
    for (Index cell = 0; cell < raster.grid.size(); ++cell) {
        visit(cell, raster.placement.center(raster.grid.row(cell), raster.grid.col(cell)));
    }
}

inline bool same_bytes(const std::vector<double>& a, const std::vector<double>& b) {
    return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size() * sizeof(double)) == 0;
}

}  // namespace support
