// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cmath>
#include <utility>
#include <vector>

#include "support/outlines.hpp"
#include "thalweg/mesh/triangulate.hpp"
#include "thalweg/surface/minimum_norm_network.hpp"

namespace support {

/// Arrays behind a TensionMesh.
struct TensionSurface {
    std::vector<double> x, y, height, tension;
    std::vector<std::array<thalweg::Index, 3>> triangles;
    std::vector<thalweg::surface::ExtraTension> extra;

    thalweg::surface::TensionMesh mesh() const { return {x, y, height, tension, triangles, extra}; }
    thalweg::Point vertex(thalweg::Index i) const { return {x[i], y[i]}; }
    /// The place with the given barycentric coordinates in triangle t.
    thalweg::Point place(thalweg::Index t, double b0, double b1, double b2) const {
        const auto& [i, j, k] = triangles[t];
        return {b0 * x[i] + b1 * x[j] + b2 * x[k], b0 * y[i] + b1 * y[j] + b2 * y[k]};
    }
};

template <class Height>
TensionSurface surface_over(const Polygon& outline, thalweg::Index count, Height height, double tension) {
    const thalweg::Mesh mesh =
        thalweg::mesh::triangulate(outline, thalweg::mesh::poisson_disk_count(outline, count, 1));
    TensionSurface surface{mesh.x, mesh.y, {}, std::vector<double>(mesh.size(), tension), mesh.triangles, {}};
    for (thalweg::Index i = 0; i < mesh.size(); ++i) surface.height.push_back(height(mesh.x[i], mesh.y[i]));
    return surface;
}

/// Heights without any pattern; every tension from the cubic to a stiff one in one mesh, a few edges with more.
inline TensionSurface rough_surface(const Polygon& outline, thalweg::Index count, std::uint64_t seed) {
    thalweg::Random random(seed, 91);
    TensionSurface surface = surface_over(
        outline, count, [&](double, double) { return random.uniform(); }, 0);
    constexpr std::array<double, 7> tensions{0, 0.3, 0.9, 1.2, 5, 20, 300};
    for (double& tension : surface.tension) tension = tensions[random.below(7)];
    for (thalweg::Index t = 0; t < surface.triangles.size(); t += 5) {
        surface.extra.push_back({surface.triangles[t][2], surface.triangles[t][0], 3 * random.uniform()});
    }
    return surface;
}

/// Every second vertex rigid as a channel, the others free as ridges, as the growth of networks asks for.
inline void set_channel_and_ridge_tension(TensionSurface& surface) {
    for (std::size_t i = 0; i < surface.tension.size(); ++i) surface.tension[i] = i % 2 == 0 ? 5 : 0;
}

}  // namespace support
