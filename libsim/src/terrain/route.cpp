// SPDX-License-Identifier: GPL-3.0-or-later
#include "thalweg/terrain/route.hpp"

#include <algorithm>
#include <cmath>

#include "terrain/check_sizes.hpp"
#include "terrain/route_nodes.hpp"
#include "thalweg/core/parallel.hpp"

namespace thalweg::terrain {
namespace {

/// Three rows of heights and what turns drops into slopes between them.
struct RowWindow {
    const double* above;
    const double* here;
    const double* below;
    double per_east_west, per_north, per_south, per_diagonal_north, per_diagonal_south;  // 1 / length, 1/m
};

RowWindow window_of(const Grid& grid, const double* elevation_m, Index row) {
    const double* here = elevation_m + std::size_t{row} * grid.cols;
    return {.above = here - grid.cols,
            .here = here,
            .below = here + grid.cols,
            .per_east_west = 1 / grid.east_west[row],
            .per_north = 1 / grid.north_south[row - 1],
            .per_south = 1 / grid.north_south[row],
            .per_diagonal_north = 1 / grid.diagonal[row - 1],
            .per_diagonal_south = 1 / grid.diagonal[row]};
}

/// Inner columns of an inner row. Slope and slot are carried as doubles and chosen by selects, so the loop vectorises.
void steepest_in_row(const RowWindow& w, Index cols, Slot* out) {
    for (Index c = 1; c + 1 < cols; ++c) {
        const double height = w.here[c];
        double best = 0;
        double slot = no_flow;
        const auto offer = [&](double neighbor, double per_length, double number) {
            const double slope = (height - neighbor) * per_length;
            slot = slope > best ? number : slot;
            best = slope > best ? slope : best;
        };
        offer(w.here[c + 1], w.per_east_west, 0);
        offer(w.below[c + 1], w.per_diagonal_south, 1);
        offer(w.below[c], w.per_south, 2);
        offer(w.below[c - 1], w.per_diagonal_south, 3);
        offer(w.here[c - 1], w.per_east_west, 4);
        offer(w.above[c - 1], w.per_diagonal_north, 5);
        offer(w.above[c], w.per_north, 6);
        offer(w.above[c + 1], w.per_diagonal_north, 7);
        out[c] = static_cast<Slot>(static_cast<int>(slot));
    }
}

void clear_base_level(const Boundary* boundary, Index cols, Slot* out) {
    for (Index c = 0; c < cols; ++c) out[c] = boundary[c] == Boundary::base_level ? no_flow : out[c];
}

void route_row(const Grid& grid, std::span<const double> elevation_m, std::span<const Boundary> boundary, Index row,
               FlowDirections& directions) {
    const Index first = row * grid.cols;
    const Index last = first + grid.cols;
    if (row == 0 || row + 1 == grid.rows || grid.cols < 3) {
        route_nodes(grid, elevation_m, boundary, Receiver::steepest, first, last, directions);
        return;
    }
    steepest_in_row(window_of(grid, elevation_m.data(), row), grid.cols, directions.data() + first);
    clear_base_level(boundary.data() + first, grid.cols, directions.data() + first);
    route_nodes(grid, elevation_m, boundary, Receiver::steepest, first, first + 1, directions);
    route_nodes(grid, elevation_m, boundary, Receiver::steepest, last - 1, last, directions);
}

}  // namespace

void route(const Grid& grid, std::span<const double> elevation_m, std::span<const Boundary> boundary, Receiver receiver,
           FlowDirections& directions) {
    check_sizes(grid.size(), elevation_m.size(), boundary.size());
    directions.resize(grid.size());
    if (receiver == Receiver::lowest) {
        parallel_for(0, grid.size(), [&](Index first, Index last) {
            route_nodes(grid, elevation_m, boundary, receiver, first, last, directions);
        });
        return;
    }
    const Index rows_per_piece = std::max<Index>(1, 16384 / grid.cols);
    parallel_for(
        0, grid.rows,
        [&](Index first, Index last) {
            for (Index row = first; row < last; ++row) route_row(grid, elevation_m, boundary, row, directions);
        },
        rows_per_piece);
}

void route(const Mesh& mesh, std::span<const double> elevation_m, std::span<const Boundary> boundary, Receiver receiver,
           FlowDirections& directions) {
    check_sizes(mesh.size(), elevation_m.size(), boundary.size());
    directions.resize(mesh.size());
    parallel_for(0, mesh.size(), [&](Index first, Index last) {
        route_nodes(mesh, elevation_m, boundary, receiver, first, last, directions);
    });
}

FlowDirections route(const Grid& grid, std::span<const double> elevation_m, std::span<const Boundary> boundary,
                     Receiver receiver) {
    FlowDirections directions;
    route(grid, elevation_m, boundary, receiver, directions);
    return directions;
}

FlowDirections route(const Mesh& mesh, std::span<const double> elevation_m, std::span<const Boundary> boundary,
                     Receiver receiver) {
    FlowDirections directions;
    route(mesh, elevation_m, boundary, receiver, directions);
    return directions;
}

std::vector<Boundary> data_edge(const Grid& grid, std::span<const double> elevation_m) {
    check_sizes(grid.size(), elevation_m.size(), elevation_m.size());
    std::vector<Boundary> boundary(grid.size(), Boundary::interior);
    parallel_for(0, grid.size(), [&](Index first, Index last) {
        for (Index node = first; node < last; ++node) {
            if (std::isnan(elevation_m[node])) continue;
            int with_data = 0;
            grid.neighbors(node,
                           [&](Index neighbor, double, Slot) { with_data += !std::isnan(elevation_m[neighbor]); });
            if (with_data < 8) boundary[node] = Boundary::open;
        }
    });
    return boundary;
}

}  // namespace thalweg::terrain
