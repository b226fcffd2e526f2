// SPDX-License-Identifier: GPL-3.0-or-later
#include "terrain/basin_graph.hpp"

#include <algorithm>
#include <bit>
#include <limits>
#include <numeric>
#include <tuple>

namespace thalweg::terrain {
namespace {

/// Union-find by size with path halving. Each piece knows its lowest pit.
class Joined {
  public:
    Joined(std::span<const Index> pit, std::span<const double> elevation_m)
        : parent_(pit.size()), size_(pit.size(), 1), lowest_m_(pit.size(), -std::numeric_limits<double>::infinity()) {
        std::iota(parent_.begin(), parent_.end(), 0u);
        for (Index basin = 1; basin < pit.size(); ++basin) lowest_m_[basin] = elevation_m[pit[basin]];
    }

    Index find(Index basin) {
        while (parent_[basin] != basin) {
            parent_[basin] = parent_[parent_[basin]];
            basin = parent_[basin];
        }
        return basin;
    }

    double lowest_m(Index piece) const { return lowest_m_[piece]; }

    /// Joins two different pieces, each named by what `find` gives.
    void join(Index a, Index b) {
        if (size_[a] < size_[b]) std::swap(a, b);
        parent_[b] = a;
        size_[a] += size_[b];
        lowest_m_[a] = std::min(lowest_m_[a], lowest_m_[b]);
    }

  private:
    std::vector<Index> parent_;
    std::vector<Index> size_;
    std::vector<double> lowest_m_;
};

/// Kruskal's tree, and the number of lakes: where two pieces meet, the one with the higher pit ends as a lake of its
/// own, unless they meet at the very height of that pit and it was only a part of a flat.
struct Kruskal {
    std::vector<Pass> tree;
    Index lakes;
};

Kruskal join_lowest_first(std::vector<Pass> passes, Joined& joined) {
    std::sort(passes.begin(), passes.end(), lower);
    Index lakes = 0;
    std::erase_if(passes, [&](const Pass& pass) {
        const Index a = joined.find(pass.basin);
        const Index b = joined.find(pass.other_basin);
        if (a == b) return true;
        if (pass.height_m > std::max(joined.lowest_m(a), joined.lowest_m(b))) ++lakes;
        joined.join(a, b);
        return false;
    });
    return {std::move(passes), lakes};
}

/// A pass straight out at the lowest pit of every piece that has no outlet.
void open_closed_pieces(Joined& joined, std::span<const Index> pit, std::span<const double> elevation_m,
                        std::vector<Pass>& tree) {
    std::vector<Index> lowest(pit.size(), none);
    for (Index basin = 1; basin < pit.size(); ++basin) {
        Index& best = lowest[joined.find(basin)];
        const auto key = [&](Index b) { return std::tuple(elevation_m[pit[b]], pit[b]); };
        if (best == none || key(basin) < key(best)) best = basin;
    }
    const Index drained = joined.find(outside);
    for (Index piece = 0; piece < pit.size(); ++piece) {
        if (lowest[piece] == none || piece == drained) continue;
        const Index basin = lowest[piece];
        tree.push_back({elevation_m[pit[basin]], basin, pit[basin], outside, none});
    }
}

/// Compressed rows: the passes at each basin.
struct Incidence {
    std::vector<Index> offset;
    std::vector<Index> pass;
};

Incidence passes_by_basin(const std::vector<Pass>& tree, std::size_t basins) {
    Incidence at{std::vector<Index>(basins + 1, 0), std::vector<Index>(2 * tree.size())};
    for (const Pass& pass : tree) {
        ++at.offset[pass.basin + 1];
        ++at.offset[pass.other_basin + 1];
    }
    std::partial_sum(at.offset.begin(), at.offset.end(), at.offset.begin());
    std::vector<Index> next(at.offset.begin(), at.offset.end() - 1);
    for (Index i = 0; i < tree.size(); ++i) {
        at.pass[next[tree[i].basin]++] = i;
        at.pass[next[tree[i].other_basin]++] = i;
    }
    return at;
}

/// The same pass seen from the other side.
Pass reversed(const Pass& pass) { return {pass.height_m, pass.other_basin, pass.other_node, pass.basin, pass.node}; }

SpillTree walk_from_outside(const std::vector<Pass>& tree, std::size_t basins) {
    const Incidence at = passes_by_basin(tree, basins);
    SpillTree spill{std::vector<Pass>(basins), {outside}, 0};
    spill.order.reserve(basins);
    std::vector<std::uint8_t> reached(basins, 0);
    reached[outside] = 1;
    for (std::size_t next = 0; next < spill.order.size(); ++next) {
        const Index basin = spill.order[next];
        for (Index i = at.offset[basin]; i < at.offset[basin + 1]; ++i) {
            const Pass& pass = tree[at.pass[i]];
            const Pass out = pass.basin == basin ? reversed(pass) : pass;
            if (reached[out.basin]) continue;
            reached[out.basin] = 1;
            spill.way_out[out.basin] = out;
            spill.order.push_back(out.basin);
        }
    }
    return spill;
}

}  // namespace

bool lower(const Pass& a, const Pass& b) {
    const auto key = [](const Pass& pass) {
        return std::tuple(pass.height_m, std::min(pass.node, pass.other_node), std::max(pass.node, pass.other_node));
    };
    return key(a) < key(b);
}

LowestPasses::LowestPasses(Index expected) : table_(std::bit_ceil(std::size_t{2} * expected + 16), none) {
    passes_.reserve(expected);
}

std::size_t LowestPasses::find_slot(Index basin, Index other_basin) const {
    const std::uint64_t key = std::uint64_t{basin} << 32 | other_basin;
    const std::size_t mask = table_.size() - 1;
    std::size_t slot = (key * 0x9E3779B97F4A7C15u >> 20) & mask;  // Fibonacci hashing
    while (table_[slot] != none) {
        const Pass& pass = passes_[table_[slot]];
        if (pass.basin == basin && pass.other_basin == other_basin) break;
        slot = (slot + 1) & mask;
    }
    return slot;
}

void LowestPasses::offer(const Pass& offered) {
    const Pass pass = offered.basin < offered.other_basin ? offered : reversed(offered);
    const std::size_t slot = find_slot(pass.basin, pass.other_basin);
    if (table_[slot] != none) {
        Pass& best = passes_[table_[slot]];
        if (lower(pass, best)) best = pass;
        return;
    }
    table_[slot] = static_cast<Index>(passes_.size());
    passes_.push_back(pass);
    if (2 * passes_.size() > table_.size()) grow();
}

void LowestPasses::grow() {
    table_.assign(2 * table_.size(), none);
    for (Index i = 0; i < passes_.size(); ++i) table_[find_slot(passes_[i].basin, passes_[i].other_basin)] = i;
}

SpillTree spill_tree(std::vector<Pass> passes, std::span<const Index> pit, std::span<const double> elevation_m) {
    Joined joined(pit, elevation_m);
    Kruskal kruskal = join_lowest_first(std::move(passes), joined);
    open_closed_pieces(joined, pit, elevation_m, kruskal.tree);
    SpillTree spill = walk_from_outside(kruskal.tree, pit.size());
    spill.lakes = kruskal.lakes;
    return spill;
}

}  // namespace thalweg::terrain
