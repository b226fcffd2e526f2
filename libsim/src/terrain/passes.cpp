// SPDX-License-Identifier: GPL-3.0-or-later
#include "terrain/passes.hpp"

#include "terrain/blocks.hpp"

namespace thalweg::terrain {
namespace {

bool is_inside(Index basin) { return basin != outside && basin != none; }

/// Three rows of heights and basins, and the cell they begin with.
struct Window {
    const double* above;
    const double* here;
    const double* below;
    const Index* basin_above;
    const Index* basin_here;
    const Index* basin_below;
};

Window window_of(const Terrain<Grid>& terrain, std::span<const Index> basin, Index row) {
    const Index cols = terrain.topology.cols;
    const double* here = terrain.elevation_m.data() + std::size_t{row} * cols;
    const Index* basin_here = basin.data() + std::size_t{row} * cols;
    return {here - cols, here, here + cols, basin_here - cols, basin_here, basin_here + cols};
}

/// Height of the lowest pass out of each inner cell of an inner row; infinite where all neighbours are of its basin.
/// Selects only, so that the loop vectorises; NaN is never lower.
void lowest_in_row(const Window& w, Index cols, double* height) {
    for (Index c = 1; c + 1 < cols; ++c) {
        const Index here = w.basin_here[c];
        double lowest = std::numeric_limits<double>::infinity();
        const auto offer = [&](double neighbor, Index there) {
            const double foreign = there == here ? std::numeric_limits<double>::infinity() : neighbor;
            lowest = foreign < lowest ? foreign : lowest;
        };
        offer(w.above[c - 1], w.basin_above[c - 1]);
        offer(w.above[c], w.basin_above[c]);
        offer(w.above[c + 1], w.basin_above[c + 1]);
        offer(w.here[c - 1], w.basin_here[c - 1]);
        offer(w.here[c + 1], w.basin_here[c + 1]);
        offer(w.below[c - 1], w.basin_below[c - 1]);
        offer(w.below[c], w.basin_below[c]);
        offer(w.below[c + 1], w.basin_below[c + 1]);
        height[c] = w.here[c] > lowest ? w.here[c] : lowest;
    }
}

/// The pass out of an inner cell whose height is known: of neighbours as good the lowest, then that of lower number.
Pass way_out_at(const Terrain<Grid>& terrain, std::span<const Index> basin, Index node, double height) {
    const Index here = basin[node];
    Pass best = no_pass;
    for (const Slot slot : {5, 6, 7, 4, 0, 3, 2, 1}) {
        const Index other = terrain.topology.neighbor(node, slot);
        if (basin[other] == here || basin[other] == none) continue;
        const Pass pass = pass_between(terrain.elevation_m, here, node, basin[other], other);
        if (pass.height_m == height && pass.low_m < best.low_m) best = pass;
    }
    return best;
}

/// Lowest passes that one block finds: those of basins whose pit lies in it straight in the common list, which nobody
/// else touches there; those of other basins in its own.
class BlockBest {
  public:
    BlockBest(std::vector<Pass>& best, std::span<const Index> pit, Index first, Index last)
        : best_(best.data()), pit_(pit.data()), first_(first), size_(last - first), foreign_(16) {}

    Pass& of(Index basin) { return pit_[basin] - first_ < size_ ? best_[basin] : foreign_.between(basin, none); }
    std::vector<Pass> take_foreign() { return foreign_.take(); }

  private:
    Pass* best_;
    const Index* pit_;
    Index first_, size_;
    LowestPasses foreign_;
};

/// Scans the blocks, each by scan(first, last, best), and then joins what they found.
template <class Scan>
std::vector<Pass> lowest_by_blocks(Index nodes, const Blocks& blocks, Index nodes_per_step, std::span<const Index> pit,
                                   Scan scan) {
    std::vector<Pass> best(pit.size(), no_pass);
    std::vector<std::vector<Pass>> foreign(blocks.count());
    blocks.for_each([&](Index block) {
        BlockBest of_block(best, pit, blocks.first(block) * nodes_per_step,
                           std::min(nodes, blocks.last(block) * nodes_per_step));
        scan(blocks.first(block), blocks.last(block), of_block);
        foreign[block] = of_block.take_foreign();
    });
    for (const std::vector<Pass>& passes : foreign) {
        for (const Pass& pass : passes) {
            if (pass.basin != none) keep_lower(best[pass.basin], pass);
        }
    }
    return best;
}

/// Looks closely only at the cells whose pass may be the lowest of their basin.
void scan_inner_row(const Terrain<Grid>& terrain, std::span<const Index> basin, Index row, std::vector<double>& height,
                    BlockBest& best) {
    const Index cols = terrain.topology.cols;
    lowest_in_row(window_of(terrain, basin, row), cols, height.data());
    for (Index c = 1; c + 1 < cols; ++c) {
        const Index node = row * cols + c;
        if (!is_inside(basin[node])) continue;
        Pass& lowest = best.of(basin[node]);
        if (height[c] <= lowest.height_m) keep_lower(lowest, way_out_at(terrain, basin, node, height[c]));
        if (terrain.boundary[node] == Boundary::open) {
            keep_lower(lowest, pass_straight_out(terrain.elevation_m, basin[node], node));
        }
    }
}

/// Offers the pass between two neighbours, named by basin and kept by piece.
void offer_between(std::span<const double> elevation_m, std::span<const Index> basin, std::span<const Index> piece,
                   Index node, Index other, LowestPasses& passes) {
    passes.offer(piece[basin[node]], piece[basin[other]],
                 pass_between(elevation_m, basin[node], node, basin[other], other));
}

template <Topology T>
void offer_straight_out(const Terrain<T>& terrain, std::span<const Index> basin, std::span<const Index> piece,
                        Index node, LowestPasses& passes) {
    if (!is_inside(basin[node]) || terrain.boundary[node] != Boundary::open) return;
    const Index here = piece[basin[node]];
    if (here != outside) passes.offer(here, outside, pass_straight_out(terrain.elevation_m, basin[node], node));
}

/// Pieces of a row's cells; `none` stays.
void pieces_of_row(std::span<const Index> basin, std::span<const Index> piece, Index first, std::vector<Index>& row) {
    for (Index c = 0; c < row.size(); ++c) {
        const Index here = basin[first + c];
        row[c] = here == none ? none : piece[here];
    }
}

/// Offers what leads from a row's cells to the east and to the row below, whose pieces are given (`none`: no such
/// cell).
void offer_from_row(const Terrain<Grid>& terrain, std::span<const Index> basin, std::span<const Index> piece, Index row,
                    const std::vector<Index>& here, const std::vector<Index>& below, LowestPasses& passes) {
    const Index cols = terrain.topology.cols;
    const auto offer = [&](Index node, Index own, Index there, Index other) {
        if (own == there || there == none) return;
        offer_between(terrain.elevation_m, basin, piece, node, other, passes);
    };
    for (Index c = 0; c < cols; ++c) {
        const Index own = here[c];
        if (own == none) continue;
        const Index node = row * cols + c;
        offer_straight_out(terrain, basin, piece, node, passes);
        if (c > 0) offer(node, own, below[c - 1], node + cols - 1);
        offer(node, own, below[c], node + cols);
        if (c + 1 == cols) continue;
        offer(node, own, below[c + 1], node + cols + 1);
        offer(node, own, here[c + 1], node + 1);
    }
}

/// Offers every way out of the nodes' basins, one by one.
template <Topology T>
void scan_one_by_one(const Terrain<T>& terrain, std::span<const Index> basin, Index first, Index last,
                     BlockBest& best) {
    for (Index node = first; node < last; ++node) {
        if (is_inside(basin[node])) offer_ways_out(terrain, basin, node, best.of(basin[node]));
    }
}

/// The passes that each block finds by scan(first, last, passes), one block after the other: two blocks may both name
/// the lowest pass they see between the same two pieces.
template <class Scan>
std::vector<Pass> between_by_blocks(const Blocks& blocks, Index pieces, Scan scan) {
    std::vector<std::vector<Pass>> found(blocks.count());
    blocks.for_each([&](Index block) {
        LowestPasses passes(3 * (pieces / blocks.count()) + 16);
        scan(blocks.first(block), blocks.last(block), passes);
        found[block] = passes.take();
    });
    for (Index block = 1; block < blocks.count(); ++block) {
        found[0].insert(found[0].end(), found[block].begin(), found[block].end());
    }
    return std::move(found[0]);
}

}  // namespace

std::vector<Pass> lowest_pass_of_each_basin(const Terrain<Grid>& terrain, std::span<const Index> basin,
                                            std::span<const Index> pit) {
    const Grid& grid = terrain.topology;
    const auto scan = [&](Index first_row, Index last_row, BlockBest& best) {
        std::vector<double> height(grid.cols);
        for (Index row = first_row; row < last_row; ++row) {
            const Index first = row * grid.cols;
            const Index last = first + grid.cols;
            if (row == 0 || row + 1 == grid.rows || grid.cols < 3) {
                scan_one_by_one(terrain, basin, first, last, best);
                continue;
            }
            scan_one_by_one(terrain, basin, first, first + 1, best);
            scan_inner_row(terrain, basin, row, height, best);
            scan_one_by_one(terrain, basin, last - 1, last, best);
        }
    };
    return lowest_by_blocks(grid.size(), row_blocks(grid), grid.cols, pit, scan);
}

std::vector<Pass> lowest_pass_of_each_basin(const Terrain<Mesh>& terrain, std::span<const Index> basin,
                                            std::span<const Index> pit) {
    const Index nodes = terrain.topology.size();
    return lowest_by_blocks(nodes, Blocks(nodes), 1, pit, [&](Index first, Index last, BlockBest& best) {
        scan_one_by_one(terrain, basin, first, last, best);
    });
}

std::vector<Pass> passes_between_pieces(const Terrain<Grid>& terrain, std::span<const Index> basin,
                                        std::span<const Index> piece, Index pieces) {
    const Grid& grid = terrain.topology;
    const auto scan = [&](Index first_row, Index last_row, LowestPasses& passes) {
        std::vector<Index> here(grid.cols), below(grid.cols);
        pieces_of_row(basin, piece, first_row * grid.cols, here);
        for (Index row = first_row; row < last_row; ++row) {
            if (row + 1 < grid.rows) {
                pieces_of_row(basin, piece, (row + 1) * grid.cols, below);
            } else {
                std::fill(below.begin(), below.end(), none);
            }
            offer_from_row(terrain, basin, piece, row, here, below, passes);
            std::swap(here, below);
        }
    };
    return between_by_blocks(row_blocks(grid), pieces, scan);
}

std::vector<Pass> passes_between_pieces(const Terrain<Mesh>& terrain, std::span<const Index> basin,
                                        std::span<const Index> piece, Index pieces) {
    const auto scan = [&](Index first, Index last, LowestPasses& passes) {
        for (Index node = first; node < last; ++node) {
            if (basin[node] == none) continue;
            offer_straight_out(terrain, basin, piece, node, passes);
            terrain.topology.neighbors(node, [&](Index other, double, Slot) {
                if (other > node || basin[other] == none || piece[basin[other]] == piece[basin[node]]) return;
                offer_between(terrain.elevation_m, basin, piece, node, other, passes);
            });
        }
    };
    return between_by_blocks(Blocks(terrain.topology.size()), pieces, scan);
}

}  // namespace thalweg::terrain
