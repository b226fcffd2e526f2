// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>

#include "thalweg/core/grid.hpp"
#include "thalweg/core/mesh.hpp"

namespace thalweg::terrain {

/// Neighbour by slot, as `topology.neighbor`, but on a grid by one table look-up.
class Downhill {
  public:
    explicit Downhill(const Grid& grid) {
        const Index middle = 0;
        for (Slot slot = 0; slot < 8; ++slot) offset_[slot] = grid.neighbor(middle, slot);
    }
    Index operator()(Index node, Slot slot) const { return node + offset_[slot]; }

  private:
    std::array<Index, 8> offset_;  // modulo 2^32, as node numbers are
};

class DownhillOnMesh {
  public:
    explicit DownhillOnMesh(const Mesh& mesh) : mesh_(mesh) {}
    Index operator()(Index node, Slot slot) const { return mesh_.neighbor(node, slot); }

  private:
    const Mesh& mesh_;
};

inline Downhill downhill(const Grid& grid) { return Downhill(grid); }
inline DownhillOnMesh downhill(const Mesh& mesh) { return DownhillOnMesh(mesh); }

}  // namespace thalweg::terrain
