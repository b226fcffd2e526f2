// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "thalweg/core/mesh.hpp"
#include "thalweg/core/random.hpp"

namespace thalweg::support {

/// Triangular lattice of rows × cols points about `spacing` apart, each moved at random by up to `jitter` spacings, as
/// a mesh made without the mesh module: six neighbours inside, a third of every triangle as cell area.
inline Mesh lattice_mesh(Index rows, Index cols, double spacing_m, double jitter, std::uint64_t seed) {
    Mesh mesh;
    Random random(seed, 77);
    for (Index r = 0; r < rows; ++r) {
        for (Index c = 0; c < cols; ++c) {
            const bool edge = r == 0 || c == 0 || r + 1 == rows || c + 1 == cols;
            const double shift_x = edge ? 0 : jitter * (2 * random.uniform() - 1);
            const double shift_y = edge ? 0 : jitter * (2 * random.uniform() - 1);
            mesh.x.push_back(spacing_m * (c + 0.5 * (r % 2) + shift_x));
            mesh.y.push_back(spacing_m * (std::sqrt(0.75) * r + shift_y));
            mesh.on_outline.push_back(edge);
        }
    }
    const auto node = [&](Index r, Index c) { return r * cols + c; };
    for (Index r = 0; r + 1 < rows; ++r) {
        for (Index c = 0; c + 1 < cols; ++c) {
            const Index here = node(r, c), east = node(r, c + 1), up = node(r + 1, c), up_east = node(r + 1, c + 1);
            if (r % 2 == 0) {
                mesh.triangles.push_back({here, east, up});
                mesh.triangles.push_back({east, up_east, up});
            } else {
                mesh.triangles.push_back({here, up_east, up});
                mesh.triangles.push_back({here, east, up_east});
            }
        }
    }
    std::vector<std::vector<Index>> around(mesh.size());
    mesh.cell_area.assign(mesh.size(), 0.0);
    for (const auto& [a, b, c] : mesh.triangles) {
        const double area = 0.5 * std::abs((mesh.x[b] - mesh.x[a]) * (mesh.y[c] - mesh.y[a]) -
                                           (mesh.x[c] - mesh.x[a]) * (mesh.y[b] - mesh.y[a]));
        for (const auto& [from, to] : {std::pair{a, b}, {b, c}, {c, a}}) {
            around[from].push_back(to);
            around[to].push_back(from);
            mesh.cell_area[from] += area / 3;
        }
    }
    mesh.offset.push_back(0);
    for (Index i = 0; i < mesh.size(); ++i) {
        auto& list = around[i];
        std::sort(list.begin(), list.end());
        list.erase(std::unique(list.begin(), list.end()), list.end());
        for (const Index j : list) {
            mesh.neighbor_list.push_back(j);
            mesh.length_list.push_back(std::hypot(mesh.x[i] - mesh.x[j], mesh.y[i] - mesh.y[j]));
        }
        mesh.offset.push_back(static_cast<Index>(mesh.neighbor_list.size()));
    }
    return mesh;
}

}  // namespace thalweg::support
