// SPDX-License-Identifier: GPL-3.0-or-later
#include "terrain/basin_graph.hpp"

#include <algorithm>
#include <atomic>
#include <limits>
#include <numeric>
#include <tuple>

#include "thalweg/core/parallel.hpp"

namespace thalweg::terrain {
namespace {

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
        tree.push_back(pass_straight_out(elevation_m, basin, pit[basin]));
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
Pass reversed(const Pass& pass) {
    return {pass.height_m, pass.low_m, pass.other_basin, pass.other_node, pass.basin, pass.node};
}

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

/// Lakes in a finished tree. A pass at the very height of the higher of its two pits joins no lake: if the other pit is
/// lower the water runs off freely, if it is as high they are one flat.
Index count_lakes(const std::vector<Pass>& tree, std::span<const Index> pit, std::span<const double> elevation_m) {
    const auto pit_m = [&](Index basin) {
        return basin == outside ? -std::numeric_limits<double>::infinity() : elevation_m[pit[basin]];
    };
    const Index basins = static_cast<Index>(pit.size());
    Joined flats(basins);
    std::vector<Index> level_ways;
    for (Index i = 0; i < tree.size(); ++i) {
        const double a = pit_m(tree[i].basin);
        const double b = pit_m(tree[i].other_basin);
        if (tree[i].height_m > std::max(a, b)) continue;
        if (a == b) flats.join(tree[i].basin, tree[i].other_basin);
        if (a != b) level_ways.push_back(a > b ? tree[i].basin : tree[i].other_basin);
    }
    std::vector<std::uint8_t> is_lake(basins, 0);
    for (Index basin = 1; basin < basins; ++basin) is_lake[flats.find(basin)] = 1;
    for (const Index basin : level_ways) is_lake[flats.find(basin)] = 0;
    return static_cast<Index>(std::count(is_lake.begin(), is_lake.end(), 1));
}

/// Puts a pass in the place of a higher one, whatever other threads do: which pass is lowest does not hang on the
/// order.
void offer(const Pass& pass, const Pass*& best) {
    const std::atomic_ref place(best);
    const Pass* seen = place.load(std::memory_order_acquire);
    while (seen == nullptr || lower(pass, *seen)) {
        if (place.compare_exchange_weak(seen, &pass, std::memory_order_acq_rel)) return;
    }
}

/// Keeps the passes that lead from one piece to another, and offers each to both.
void forget_inner_passes(const std::vector<Index>& piece, std::vector<const Pass*>& lowest, std::vector<Pass>& passes) {
    std::size_t kept = 0;
    for (const Pass& pass : passes) {
        const Index a = piece[pass.basin];
        const Index b = piece[pass.other_basin];
        if (a == b) continue;
        passes[kept] = pass;
        offer(passes[kept], lowest[a]);
        offer(passes[kept], lowest[b]);
        ++kept;
    }
    passes.erase(passes.begin() + static_cast<std::ptrdiff_t>(kept), passes.end());
}

}  // namespace

Joined::Joined(Index basins) : parent_(basins), size_(basins, 1) { std::iota(parent_.begin(), parent_.end(), 0u); }

Index Joined::find(Index basin) {
    while (parent_[basin] != basin) {
        parent_[basin] = parent_[parent_[basin]];
        basin = parent_[basin];
    }
    return basin;
}

bool Joined::join(Index a, Index b) {
    a = find(a);
    b = find(b);
    if (a == b) return false;
    if (size_[a] < size_[b]) std::swap(a, b);
    parent_[b] = a;
    size_[a] += size_[b];
    return true;
}

std::vector<Pass> spanning_passes(std::span<std::vector<Pass>* const> lists, Joined& joined) {
    std::vector<Pass> tree;
    tree.reserve(joined.size());
    std::vector<Index> piece(joined.size());                  // per basin
    std::vector<const Pass*> lowest(joined.size(), nullptr);  // per piece
    const auto some = [&](Index first, Index last) {
        for (Index list = first; list < last; ++list) forget_inner_passes(piece, lowest, *lists[list]);
    };
    for (std::size_t before = none; before != tree.size();) {
        before = tree.size();
        for (Index basin = 0; basin < joined.size(); ++basin) piece[basin] = joined.find(basin);
        parallel_for(0, static_cast<Index>(lists.size()), some, 1);
        for (const Pass*& pass : lowest) {
            if (pass != nullptr && joined.join(pass->basin, pass->other_basin)) tree.push_back(*pass);
            pass = nullptr;
        }
    }
    return tree;
}

SpillTree spill_tree(std::vector<Pass> tree, Joined& joined, std::span<const Index> pit,
                     std::span<const double> elevation_m) {
    open_closed_pieces(joined, pit, elevation_m, tree);
    SpillTree spill = walk_from_outside(tree, pit.size());
    spill.lakes = count_lakes(tree, pit, elevation_m);
    return spill;
}

}  // namespace thalweg::terrain
