// SPDX-License-Identifier: GPL-3.0-or-later
#include "thalweg/terrain/flats.hpp"

#include <cmath>

#include "terrain/check_sizes.hpp"

namespace thalweg::terrain {
namespace {

/// What the two gradients need of a flat terrain. A cell is stuck if it must flow but has no lower neighbour. Two stuck
/// cells side by side are always of one height (the higher one would flow), so heights are read only at the rims.
struct Flats {
    const Grid& grid;
    std::span<const double> elevation_m;
    std::vector<std::uint8_t> stuck;  // per cell
    std::vector<Index> cells;         // the stuck ones, ascending
};

Flats find_flats(const Grid& grid, std::span<const double> elevation_m, std::span<const Boundary> boundary,
                 const FlowDirections& directions) {
    Flats flats{grid, elevation_m, std::vector<std::uint8_t>(grid.size(), 0), {}};
    for (Index node = 0; node < grid.size(); ++node) {
        const bool stuck =
            directions[node] == no_flow && boundary[node] == Boundary::interior && !std::isnan(elevation_m[node]);
        flats.stuck[node] = stuck;
        if (stuck) flats.cells.push_back(node);
    }
    return flats;
}

bool has_higher_neighbor(const Flats& flats, Index cell) {
    bool found = false;
    flats.grid.neighbors(
        cell, [&](Index other, double, Slot) { found = found || flats.elevation_m[other] > flats.elevation_m[cell]; });
    return found;
}

/// A neighbour of the same height that is not stuck: it flows lower, or the water leaves there.
bool is_way_out(const Flats& flats, Index cell, Index neighbor) {
    return !flats.stuck[neighbor] && flats.elevation_m[neighbor] == flats.elevation_m[cell];
}

bool has_way_out(const Flats& flats, Index cell) {
    bool found = false;
    flats.grid.neighbors(cell, [&](Index other, double, Slot) { found = found || is_way_out(flats, cell, other); });
    return found;
}

/// Steps from the nearest seed (1 there) through stuck cells, breadth first; 0 where no seed is within reach.
std::vector<std::int32_t> steps_from(const Flats& flats, bool (*is_seed)(const Flats&, Index)) {
    std::vector<std::int32_t> steps(flats.grid.size(), 0);
    std::vector<Index> queue;
    queue.reserve(flats.cells.size());
    const auto reach = [&](Index cell, std::int32_t at) {
        steps[cell] = at;
        queue.push_back(cell);
    };
    for (const Index cell : flats.cells) {
        if (is_seed(flats, cell)) reach(cell, 1);
    }
    for (std::size_t next = 0; next < queue.size(); ++next) {
        const Index cell = queue[next];
        flats.grid.neighbors(cell, [&](Index other, double, Slot) {
            if (flats.stuck[other] && steps[other] == 0) reach(other, steps[cell] + 1);
        });
    }
    return steps;
}

/// The neighbour to flow to: a way out if there is one beside the cell, else the lowest on the surface
/// 2·(steps from a way out) − (steps from higher terrain). The first term falls by 2 towards the way out and the second
/// changes by at most 1 from cell to cell, so there always is a lower one. Ties: straight before diagonal, then the
/// lower slot.
Slot slot_in_flat(const Flats& flats, const std::vector<std::int32_t>& to_exit,
                  const std::vector<std::int32_t>& from_higher, Index cell) {
    Slot best = no_flow;
    std::int32_t lowest = 2 * to_exit[cell] - from_higher[cell];
    const auto offer = [&](std::int32_t surface, Slot slot) {
        const bool straighter = best != no_flow && surface == lowest && best % 2 == 1 && slot % 2 == 0;
        if (surface >= lowest && !straighter) return;
        lowest = surface;
        best = slot;
    };
    constexpr std::int32_t below_all = std::numeric_limits<std::int32_t>::min();
    flats.grid.neighbors(cell, [&](Index other, double, Slot slot) {
        if (is_way_out(flats, cell, other)) {
            offer(below_all, slot);
        } else if (flats.stuck[other]) {
            offer(2 * to_exit[other] - from_higher[other], slot);
        }
    });
    return best;
}

}  // namespace

Index resolve_flats(const Grid& grid, std::span<const double> elevation_m, std::span<const Boundary> boundary,
                    FlowDirections& directions) {
    check_sizes(grid.size(), elevation_m.size(), boundary.size());
    check_sizes(grid.size(), directions.size(), directions.size());
    const Flats flats = find_flats(grid, elevation_m, boundary, directions);
    const std::vector<std::int32_t> to_exit = steps_from(flats, has_way_out);
    const std::vector<std::int32_t> from_higher = steps_from(flats, has_higher_neighbor);
    Index resolved = 0;
    for (const Index cell : flats.cells) {
        if (to_exit[cell] == 0) continue;
        directions[cell] = slot_in_flat(flats, to_exit, from_higher, cell);
        ++resolved;
    }
    return resolved;
}

}  // namespace thalweg::terrain
