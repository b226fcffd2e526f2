// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <vector>

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

/// Where the water of a mesh goes, node by node: sweeps jump about, and lists of all neighbours and all their lengths
/// are many times as long. Knows the neighbour and the length of the node's own direction only.
class MeshFlow {
  public:
    MeshFlow(const Mesh& mesh, const std::vector<Index>& receiver, const std::vector<double>& length)
        : receiver_(receiver.data()), length_(length.data()), cell_area_(mesh.cell_area.data()), nodes_(mesh.size()) {}

    Index size() const { return nodes_; }
    Index neighbor(Index node, Slot) const { return receiver_[node]; }
    double length(Index node, Slot) const { return length_[node]; }
    double area(Index node) const { return cell_area_[node]; }

    /// Asks for what a sweep will need of a node. Inlined by force: what does nothing but ask the compiler would drop.
    [[gnu::always_inline]] void fetch(Index node) const {
        __builtin_prefetch(receiver_ + node);
        __builtin_prefetch(length_ + node);
        __builtin_prefetch(cell_area_ + node);
    }

  private:
    const Index* receiver_;
    const double* length_;
    const double* cell_area_;
    Index nodes_;
};

class DownhillAlong {
  public:
    explicit DownhillAlong(const MeshFlow& flow) : flow_(flow) {}
    Index operator()(Index node, Slot slot) const { return flow_.neighbor(node, slot); }

  private:
    MeshFlow flow_;
};

inline Downhill downhill(const Grid& grid) { return Downhill(grid); }
inline DownhillOnMesh downhill(const Mesh& mesh) { return DownhillOnMesh(mesh); }
inline DownhillAlong downhill(const MeshFlow& flow) { return DownhillAlong(flow); }

}  // namespace thalweg::terrain
