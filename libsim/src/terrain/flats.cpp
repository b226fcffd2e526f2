// SPDX-License-Identifier: GPL-3.0-or-later
#include "thalweg/terrain/flats.hpp"

#include <algorithm>
#include <bit>
#include <limits>
#include <numeric>

#include "terrain/blocks.hpp"
#include "terrain/check_sizes.hpp"
#include "terrain/downhill.hpp"
#include "thalweg/core/parallel.hpp"

namespace thalweg::terrain {
namespace {

/// What has been learnt of a cell. A cell is stuck if it must flow but has no lower neighbour; two stuck cells side by
/// side are always of one height (the higher one would flow).
enum State : std::uint8_t { stuck = 1, has_higher = 2, collected = 4, reached_from_exit = 8, reached_from_rim = 16 };

struct Flats {
    Downhill neighbor;
    std::vector<std::uint8_t> state;
    std::vector<std::uint8_t> level;    // bit 1 << slot for each neighbour of the same height
    std::vector<std::int32_t> surface;  // 2·(steps from a way out) − (steps from higher terrain)
};

template <class Visit>
void visit_level_neighbors(const Flats& flats, Index cell, Visit visit) {
    for (unsigned bits = flats.level[cell]; bits != 0; bits &= bits - 1) {
        const Slot slot = static_cast<Slot>(std::countr_zero(bits));
        visit(flats.neighbor(cell, slot), slot);
    }
}

/// Level bits and rim flags of an inner row's inner columns. Sums of selects, so that the loop vectorises.
void compare_row(const double* here, Index cols, std::uint8_t* level, std::uint8_t* state) {
    const double* above = here - cols;
    const double* below = here + cols;
    for (Index c = 1; c + 1 < cols; ++c) {
        const double height = here[c];
        std::int64_t bits = 0;
        double highest = height;
        const auto offer = [&](double neighbor, std::int64_t bit) {
            bits |= -static_cast<std::int64_t>(neighbor == height) & bit;
            highest = neighbor > highest ? neighbor : highest;
        };
        offer(here[c + 1], 1);
        offer(below[c + 1], 2);
        offer(below[c], 4);
        offer(below[c - 1], 8);
        offer(here[c - 1], 16);
        offer(above[c - 1], 32);
        offer(above[c], 64);
        offer(above[c + 1], 128);
        level[c] = static_cast<std::uint8_t>(bits);
        state[c] = static_cast<std::uint8_t>(-static_cast<std::int64_t>(highest > height) & has_higher);
    }
}

void compare_cell(const Grid& grid, std::span<const double> elevation_m, Index cell, Flats& flats) {
    grid.neighbors(cell, [&](Index other, double, Slot slot) {
        if (elevation_m[other] == elevation_m[cell]) flats.level[cell] |= 1 << slot;
        if (elevation_m[other] > elevation_m[cell]) flats.state[cell] |= has_higher;
    });
}

void compare_rows(const Grid& grid, std::span<const double> elevation_m, Index first_row, Index last_row,
                  Flats& flats) {
    for (Index row = first_row; row < last_row; ++row) {
        const Index first = row * grid.cols;
        const Index last = first + grid.cols;
        if (row == 0 || row + 1 == grid.rows || grid.cols < 3) {
            for (Index cell = first; cell < last; ++cell) compare_cell(grid, elevation_m, cell, flats);
            continue;
        }
        compare_row(elevation_m.data() + first, grid.cols, flats.level.data() + first, flats.state.data() + first);
        compare_cell(grid, elevation_m, first, flats);
        compare_cell(grid, elevation_m, last - 1, flats);
    }
}

/// Adds the stuck flag to `count` cells.
void mark_stuck(const double* elevation_m, const Boundary* boundary, const Slot* directions, Index count,
                std::uint8_t* state) {
    for (Index i = 0; i < count; ++i) {
        const bool has_data = elevation_m[i] == elevation_m[i];
        const bool is_stuck = (directions[i] == no_flow) & (boundary[i] == Boundary::interior) & has_data;
        state[i] = static_cast<std::uint8_t>(state[i] | (is_stuck ? stuck : 0));
    }
}

Flats find_flats(const Grid& grid, std::span<const double> elevation_m, std::span<const Boundary> boundary,
                 const FlowDirections& directions) {
    Flats flats{Downhill(grid), std::vector<std::uint8_t>(grid.size(), 0), std::vector<std::uint8_t>(grid.size(), 0),
                std::vector<std::int32_t>(grid.size(), 0)};
    const auto compare = [&](Index first_row, Index last_row) {
        compare_rows(grid, elevation_m, first_row, last_row, flats);
        const std::size_t first = std::size_t{first_row} * grid.cols;
        mark_stuck(elevation_m.data() + first, boundary.data() + first, directions.data() + first,
                   (last_row - first_row) * grid.cols, flats.state.data() + first);
    };
    parallel_for(0, grid.rows, compare, std::max<Index>(1, 16384 / grid.cols));
    return flats;
}

/// Cells in the order in which they were reached. The memory is kept from flat to flat. A cell may be written and not
/// kept, so that the inner loops need no branch that nobody can predict: there is always room for eight more.
class Queue {
  public:
    void clear() { size_ = 0; }
    bool empty() const { return size_ == 0; }
    std::size_t size() const { return size_; }
    Index operator[](std::size_t at) const { return cells_[at]; }
    void make_room() {
        if (size_ + 8 > cells_.size()) cells_.resize(2 * size_ + 64);
    }
    void push_if(bool wanted, Index cell) {
        cells_[size_] = cell;
        size_ += wanted;
    }

  private:
    std::vector<Index> cells_;
    std::size_t size_ = 0;
};

/// One flat: its stuck cells, those beside a way out (a cell of the same height that is not stuck: it flows lower, or
/// the water leaves there), and those beside higher terrain.
struct Flat {
    Queue cells, at_exit, at_rim;
};

/// Puts the stuck neighbours that do not carry `mark` yet into the queue. Returns the flags of all level neighbours
/// that some of them lack.
std::uint8_t reach_from(Flats& flats, Index cell, std::uint8_t mark, Queue& queue) {
    std::uint8_t common = 255;
    queue.make_room();
    visit_level_neighbors(flats, cell, [&](Index other, Slot) {
        const std::uint8_t state = flats.state[other];
        common &= state;
        queue.push_if((state & (stuck | mark)) == stuck, other);
        flats.state[other] = state | mark;
    });
    return static_cast<std::uint8_t>(~common);
}

/// The flat of `start`, as far as it lies within [first, last). False if it may go on beyond: nothing there is touched.
bool collect(Flats& flats, Index start, Index first, Index last, Flat& flat) {
    bool complete = true;
    flat.cells.clear();
    flat.at_exit.clear();
    flat.at_rim.clear();
    flat.cells.make_room();
    flat.cells.push_if(true, start);
    flats.state[start] |= collected;
    for (std::size_t next = 0; next < flat.cells.size(); ++next) {
        const Index cell = flat.cells[next];
        if (cell - first >= last - first) {
            complete = false;
            continue;
        }
        const std::uint8_t lacking = reach_from(flats, cell, collected, flat.cells);
        flat.at_exit.make_room();
        flat.at_exit.push_if(lacking & stuck, cell);
        flat.at_rim.make_room();
        flat.at_rim.push_if(flats.state[cell] & has_higher, cell);
    }
    return complete;
}

/// Adds `weight` times the number of steps from the cells in `queue` (1 there) to the surface, breadth first.
void add_steps(Flats& flats, Queue& queue, std::uint8_t mark, std::int32_t weight) {
    for (std::size_t i = 0; i < queue.size(); ++i) flats.state[queue[i]] |= mark;
    std::size_t next = 0;
    for (std::int32_t step = 1; next < queue.size(); ++step) {
        for (const std::size_t end = queue.size(); next < end; ++next) {
            const Index cell = queue[next];
            flats.surface[cell] += weight * step;
            reach_from(flats, cell, mark, queue);
        }
    }
}

/// The neighbour to flow to: a way out if there is one beside the cell, else the lowest on the surface. Its first term
/// falls by 2 towards the way out and the second changes by at most 1 from cell to cell, so there always is a lower
/// one. Ties: straight before diagonal, then the lower slot.
Slot slot_in_flat(const Flats& flats, Index cell) {
    constexpr std::int64_t below_all = std::numeric_limits<std::int32_t>::min();
    std::int64_t best = std::numeric_limits<std::int64_t>::max();
    visit_level_neighbors(flats, cell, [&](Index other, Slot slot) {
        const std::int64_t surface = flats.state[other] & stuck ? std::int64_t{flats.surface[other]} : below_all;
        best = std::min(best, surface * 16 + (slot & 1) * 8 + slot);
    });
    return static_cast<Slot>(best & 7);
}

/// Gives the cells of a collected flat their directions; returns how many.
Index resolve(Flats& flats, Flat& flat, FlowDirections& directions) {
    if (flat.at_exit.empty()) return 0;
    add_steps(flats, flat.at_exit, reached_from_exit, 2);
    add_steps(flats, flat.at_rim, reached_from_rim, -1);
    for (std::size_t i = 0; i < flat.cells.size(); ++i) {
        directions[flat.cells[i]] = slot_in_flat(flats, flat.cells[i]);
    }
    return static_cast<Index>(flat.cells.size());
}

bool begins_flat(const Flats& flats, Index cell) { return (flats.state[cell] & (stuck | collected)) == stuck; }

/// A flat is often cut by the strip's border into arms that meet beyond it. What lies beyond is forgotten again, so
/// that the next arm finds it too: taken for a flat of its own, it would be resolved with half of its ways out unknown.
void put_off_flat(const Flat& flat, Index first, Index last, Flats& flats, std::vector<Index>& put_off) {
    for (std::size_t i = 0; i < flat.cells.size(); ++i) {
        const Index cell = flat.cells[i];
        put_off.push_back(cell);
        if (cell - first >= last - first) flats.state[cell] &= static_cast<std::uint8_t>(~collected);
    }
}

/// Flats within a strip of rows. The strip's outermost rows belong to no flat here if there are rows beyond, so that
/// no other strip's cells are touched; flats that reach them are put off.
Index resolve_in_strip(const Grid& grid, Index first_row, Index last_row, Flats& flats, FlowDirections& directions,
                       std::vector<Index>& put_off) {
    const Index first = (first_row == 0 ? 0 : first_row + 1) * grid.cols;
    const Index last = (last_row == grid.rows ? grid.rows : last_row - 1) * grid.cols;
    Flat flat;
    Index resolved = 0;
    for (Index start = first; start < last; ++start) {
        if (!begins_flat(flats, start)) continue;
        if (collect(flats, start, first, last, flat)) {
            resolved += resolve(flats, flat, directions);
        } else {
            put_off_flat(flat, first, last, flats, put_off);
        }
    }
    return resolved;
}

/// Flats that cross the borders of strips: those put off, and what begins in the strips' outermost rows.
Index resolve_across_strips(const Grid& grid, const Blocks& strips, const std::vector<std::vector<Index>>& put_off,
                            Flats& flats, FlowDirections& directions) {
    Flat flat;
    Index resolved = 0;
    const auto from = [&](Index start) {
        if (!begins_flat(flats, start)) return;
        collect(flats, start, 0, grid.size(), flat);
        resolved += resolve(flats, flat, directions);
    };
    for (const auto& cells : put_off) {
        for (const Index cell : cells) flats.state[cell] &= static_cast<std::uint8_t>(~collected);
    }
    for (const auto& cells : put_off) {
        for (const Index cell : cells) from(cell);
    }
    for (Index strip = 1; strip < strips.count(); ++strip) {
        const Index border = strips.first(strip) * grid.cols;
        for (Index cell = border - grid.cols; cell < border + grid.cols; ++cell) from(cell);
    }
    return resolved;
}

}  // namespace

Index resolve_flats(const Grid& grid, std::span<const double> elevation_m, std::span<const Boundary> boundary,
                    FlowDirections& directions) {
    check_sizes(grid.size(), elevation_m.size(), boundary.size());
    check_sizes(grid.size(), directions.size(), directions.size());
    Flats flats = find_flats(grid, elevation_m, boundary, directions);
    const Blocks strips = row_blocks(grid);
    std::vector<Index> resolved(strips.count(), 0);
    std::vector<std::vector<Index>> put_off(strips.count());
    strips.for_each([&](Index strip) {
        resolved[strip] =
            resolve_in_strip(grid, strips.first(strip), strips.last(strip), flats, directions, put_off[strip]);
    });
    const Index within = std::accumulate(resolved.begin(), resolved.end(), Index{0});
    return within + resolve_across_strips(grid, strips, put_off, flats, directions);
}

}  // namespace thalweg::terrain
