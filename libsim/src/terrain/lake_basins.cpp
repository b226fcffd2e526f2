// SPDX-License-Identifier: GPL-3.0-or-later
#include "terrain/lake_basins.hpp"

#include <array>

#include "terrain/blocks.hpp"

namespace thalweg::terrain {
namespace {

/// Donors of a grid's cells, by the directions of the cells around.
class GridDonors {
  public:
    GridDonors(const Grid& grid, const FlowDirections& directions)
        : grid_(grid),
          directions_(directions.data()),
          cols_(grid.cols),
          nodes_(grid.size()),
          last_inner_(grid.size() - grid.cols - 1) {}

    static constexpr Index most(Index) { return 8; }
    static void fetch(Index, Index) {}  // near in memory

    /// Of a lake in a trench each node tells only the next: asks for what comes if it goes straight on. Inlined by
    /// force: what does nothing but ask the compiler would drop.
    [[gnu::always_inline]] void fetch_straight_on(Index before, Index node, const Index* basin) const {
        const Index far = node + 8 * (node - before);  // modulo 2^32, as differences are
        if (far >= nodes_) return;
        __builtin_prefetch(directions_ + far);
        __builtin_prefetch(basin + far, 1);
    }

    /// Writes the donors of `node` from `to` on, where there is room for `most(node)`, and returns where they end.
    /// Cells beyond the west and the east edge are the row before's last and the next row's first; no direction leads
    /// over the edge, so they are never donors and need no test.
    Index* write(Index node, Index* to) const {
        if (node <= cols_ || node >= last_inner_) return write_at_edge(node, to);
        const auto offer = [&](Index donor, Slot slot) {
            *to = donor;
            to += directions_[donor] == slot;
        };
        offer(node + 1, 4);
        offer(node + cols_ + 1, 5);
        offer(node + cols_, 6);
        offer(node + cols_ - 1, 7);
        offer(node - 1, 0);
        offer(node - cols_ - 1, 1);
        offer(node - cols_, 2);
        offer(node - cols_ + 1, 3);
        return to;
    }

  private:
    Index* write_at_edge(Index node, Index* to) const {
        grid_.neighbors(node, [&](Index neighbor, double, Slot slot) {
            if (directions_[neighbor] == grid_.reverse(node, slot)) *to++ = neighbor;
        });
        return to;
    }

    const Grid& grid_;
    const Slot* directions_;
    Index cols_, nodes_, last_inner_;
};

/// Asks for the neighbours of a node that comes soon, and for what says where those of a later one stand. Inlined by
/// force: what does nothing but ask the compiler would drop.
[[gnu::always_inline]] inline void fetch_neighbors(const Mesh& mesh, Index soon, Index later) {
    __builtin_prefetch(&mesh.offset[later]);
    __builtin_prefetch(mesh.neighbor_list.data() + mesh.offset[soon]);
}

class MeshDonors {
  public:
    MeshDonors(const Mesh& mesh, const std::vector<Index>& receiver) : mesh_(mesh), receiver_(receiver.data()) {}

    Index most(Index node) const { return mesh_.offset[node + 1] - mesh_.offset[node]; }
    [[gnu::always_inline]] void fetch(Index soon, Index later) const { fetch_neighbors(mesh_, soon, later); }
    static void fetch_straight_on(Index, Index, const Index*) {}

    Index* write(Index node, Index* to) const {
        mesh_.neighbors(node, [&](Index neighbor, double, Slot) {
            *to = neighbor;
            to += receiver_[neighbor] == node;
        });
        return to;
    }

  private:
    const Mesh& mesh_;
    const Index* receiver_;
};

/// Basins that one thread takes at a time.
Blocks basin_blocks(Index basins) { return Blocks(basins, 128, 64); }

/// Who goes through a list may read that far beyond it, to ask for what comes next.
constexpr std::size_t read_beyond = 64;

/// Appends the pit and all upstream of it, and labels them. Returns the new end of the list, which is longer.
template <class Donors>
std::size_t walk_up(const Donors& donors, Index pit, Index number, std::size_t end, std::vector<Index>& list,
                    std::vector<Index>& basin) {
    const std::size_t begin = end;
    std::size_t next = begin;
    list.resize(std::max(list.size(), end + 1));
    list[end++] = pit;
    while (next < end) {
        if (next + 16 < end) {
            donors.fetch(list[next + 8], list[next + 16]);
        } else if (next > begin) {
            donors.fetch_straight_on(list[next - 1], list[next], basin.data());
        }
        const Index node = list[next++];
        basin[node] = number;
        const std::size_t room = end + donors.most(node);
        if (room > list.size()) list.resize(2 * room);
        end = static_cast<std::size_t>(donors.write(node, list.data() + end) - list.data());
    }
    return end;
}

template <class Donors>
LakeBasins basins_of(const Donors& donors, Index nodes, std::vector<Index> pit, LakeBuffers& buffers) {
    LakeBasins basins{std::move(pit), {}, {}};
    basins.nodes.resize(basins.pit.size());
    buffers.basin.resize(nodes);
    parallel_for(0, nodes, [&](Index first, Index last) {
        std::fill(buffers.basin.begin() + first, buffers.basin.begin() + last, outside);
    });
    const Blocks blocks = basin_blocks(basins.count());
    buffers.lists.resize(std::max<std::size_t>(buffers.lists.size(), blocks.count()));
    blocks.for_each([&](Index block) {
        std::vector<Index>& list = buffers.lists[block];
        const Index first = std::max<Index>(1, blocks.first(block));
        std::vector<std::size_t> end{0};
        for (Index number = first; number < blocks.last(block); ++number) {
            end.push_back(walk_up(donors, basins.pit[number], number, end.back(), list, buffers.basin));
        }
        if (list.size() < end.back() + read_beyond) list.resize(end.back() + read_beyond);
        for (Index number = first; number < blocks.last(block); ++number) {
            const std::size_t begin = end[number - first];
            basins.nodes[number] = std::span<const Index>(list).subspan(begin, end[number - first + 1] - begin);
        }
    });
    basins.basin = buffers.basin;
    return basins;
}

/// Cells of a grid that have all eight neighbours.
class InnerCells {
  public:
    explicit InnerCells(const Grid& grid)
        : cols_(grid.cols),
          last_inner_(grid.cols < 3 ? 0 : grid.size() - grid.cols),
          per_row_(~std::uint64_t{0} / grid.cols + 1) {}

    /// 2^64·node/cols, whole rows dropped by the overflow, is under 2^64/cols in the first column, and that of the next
    /// node is in the last: a product in place of a division.
    bool contains(Index node) const {
        const std::uint64_t within_row = per_row_ * node;
        return node >= cols_ && node < last_inner_ && within_row >= per_row_ && within_row + per_row_ >= per_row_;
    }

  private:
    Index cols_, last_inner_;
    std::uint64_t per_row_;
};

/// Finds a node's neighbours in basins of lower number. No branch hangs on a comparison: most could not be predicted.
class GridBorders {
  public:
    GridBorders(const Grid& grid, std::span<const Index> basin) : grid_(grid), basin_(basin.data()), inner_(grid) {}

    [[gnu::always_inline]] void fetch(const Index* nodes) const { __builtin_prefetch(basin_ + nodes[16]); }

    /// Writes them from `to` on and returns how many they are.
    Index lower_basins(Index node, Index* to) const {
        const Index here = basin_[node];
        Index count = 0;
        const auto offer = [&](Index neighbor) {
            to[count] = neighbor;
            count += basin_[neighbor] < here;
        };
        if (!inner_.contains(node)) {
            grid_.neighbors(node, [&](Index neighbor, double, Slot) { offer(neighbor); });
            return count;
        }
        const Index above = node - grid_.cols;
        const Index below = node + grid_.cols;
        for (const Index neighbor : {above - 1, above, above + 1, node - 1, node + 1, below - 1, below, below + 1}) {
            offer(neighbor);
        }
        return count;
    }

  private:
    const Grid& grid_;
    const Index* basin_;
    InnerCells inner_;
};

class MeshBorders {
  public:
    MeshBorders(const Mesh& mesh, std::span<const Index> basin) : mesh_(mesh), basin_(basin.data()) {}

    [[gnu::always_inline]] void fetch(const Index* nodes) const { fetch_neighbors(mesh_, nodes[24], nodes[48]); }

    Index lower_basins(Index node, Index* to) const {
        const Index here = basin_[node];
        Index count = 0;
        for (Index at = mesh_.offset[node]; at < mesh_.offset[node + 1]; ++at) {
            to[count] = mesh_.neighbor_list[at];
            count += basin_[mesh_.neighbor_list[at]] < here;
        }
        return count;
    }

  private:
    const Mesh& mesh_;
    const Index* basin_;
};

GridBorders borders_of(const Grid& grid, std::span<const Index> basin) { return {grid, basin}; }
MeshBorders borders_of(const Mesh& mesh, std::span<const Index> basin) { return {mesh, basin}; }

/// The lowest passes from one basin at a time to those of lower number; the others see theirs to it.
template <Topology T>
class PassSearch {
  public:
    PassSearch(const Terrain<T>& terrain, const LakeBasins& basins, PassBuffers& buffers)
        : terrain_(terrain),
          basins_(basins),
          borders_(borders_of(terrain.topology, basins.basin)),
          place_(buffers.place),
          passes_(buffers.passes) {
        place_.assign(basins.count(), none);
        passes_.clear();
    }

    void search(Index basin) {
        begin_ = static_cast<Index>(passes_.size());
        std::array<Index, no_flow> lower;
        for (const Index& node : basins_.nodes[basin]) {
            borders_.fetch(&node);
            __builtin_prefetch(&terrain_.boundary[(&node)[16]]);
            const Index count = borders_.lower_basins(node, lower.data());
            for (Index i = 0; i < count; ++i) offer(basin, node, lower[i]);
            if (terrain_.boundary[node] == Boundary::open) {
                keep_lower(outside, pass_straight_out(terrain_.elevation_m, basin, node));
            }
        }
    }

  private:
    void offer(Index basin, Index node, Index neighbor) {
        if (!terrain_.has_data(neighbor)) return;
        const Index other = basins_.basin[neighbor];
        keep_lower(other, pass_between(terrain_.elevation_m, basin, node, other, neighbor));
    }

    /// Places of the passes of earlier basins lie before `begin_`.
    void keep_lower(Index other, const Pass& pass) {
        const Index place = place_[other];
        if (place == none || place < begin_) {
            place_[other] = static_cast<Index>(passes_.size());
            passes_.push_back(pass);
        } else if (lower(pass, passes_[place])) {
            passes_[place] = pass;
        }
    }

    const Terrain<T>& terrain_;
    const LakeBasins& basins_;
    decltype(borders_of(terrain_.topology, std::span<const Index>())) borders_;
    std::vector<Index>& place_;  // per basin: where the pass to it stands
    std::vector<Pass>& passes_;
    Index begin_ = 0;
};

template <Topology T>
void all_passes(const Terrain<T>& terrain, const LakeBasins& basins, LakeBuffers& buffers) {
    const Blocks blocks(basins.count(), 1024);
    buffers.search.resize(blocks.count());
    blocks.for_each([&](Index block) {
        PassSearch<T> passes(terrain, basins, buffers.search[block]);
        for (Index basin = std::max<Index>(1, blocks.first(block)); basin < blocks.last(block); ++basin) {
            passes.search(basin);
        }
    });
}

}  // namespace

LakeBasins lake_basins(const Grid& grid, const FlowDirections& directions, std::vector<Index> pit,
                       LakeBuffers& buffers) {
    return basins_of(GridDonors(grid, directions), grid.size(), std::move(pit), buffers);
}

LakeBasins lake_basins(const Mesh& mesh, const FlowDirections& directions, std::vector<Index> pit,
                       LakeBuffers& buffers) {
    buffers.receiver.resize(mesh.size());
    parallel_for(0, mesh.size(), [&](Index first, Index last) {
        for (Index node = first; node < last; ++node) {
            buffers.receiver[node] = directions[node] == no_flow ? none : mesh.neighbor(node, directions[node]);
        }
    });
    return basins_of(MeshDonors(mesh, buffers.receiver), mesh.size(), std::move(pit), buffers);
}

void passes_between(const Terrain<Grid>& terrain, const LakeBasins& basins, LakeBuffers& buffers) {
    all_passes(terrain, basins, buffers);
}

void passes_between(const Terrain<Mesh>& terrain, const LakeBasins& basins, LakeBuffers& buffers) {
    all_passes(terrain, basins, buffers);
}

}  // namespace thalweg::terrain
