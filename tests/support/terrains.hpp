// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "thalweg/core/grid.hpp"
#include "thalweg/core/mesh.hpp"
#include "thalweg/core/random.hpp"

namespace thalweg::support {

/// A terrain to test on, with a name to read when a property fails.
struct TestTerrain {
    std::string name;
    Grid grid;
    std::vector<double> elevation_m;
};

inline constexpr double nodata = std::numeric_limits<double>::quiet_NaN();

/// Heights height(row, col) on a plane with cells of dx by dy metres.
template <class Height>
TestTerrain terrain_of(std::string name, Index rows, Index cols, Height height, double dx_m = 1, double dy_m = 1) {
    TestTerrain terrain{std::move(name), plane_grid(rows, cols, dx_m, dy_m), {}};
    for (Index r = 0; r < rows; ++r) {
        for (Index c = 0; c < cols; ++c) terrain.elevation_m.push_back(height(r, c));
    }
    return terrain;
}

/// Independent uniform heights: pits everywhere, no ties.
inline TestTerrain noise_terrain(Index rows, Index cols, std::uint64_t seed) {
    Random random(seed, 1);
    return terrain_of("noise " + std::to_string(seed), rows, cols, [&](Index, Index) { return random.uniform(); });
}

/// Whole heights from 0 to levels − 1: full of ties and flats.
inline TestTerrain stepped_terrain(Index rows, Index cols, Index levels, std::uint64_t seed) {
    Random random(seed, 2);
    return terrain_of("steps " + std::to_string(seed), rows, cols,
                      [&](Index, Index) { return static_cast<double>(random.below(levels)); });
}

/// Takes the data from a share of the cells.
inline TestTerrain with_holes(TestTerrain terrain, double share, std::uint64_t seed) {
    Random random(seed, 3);
    for (double& height : terrain.elevation_m) {
        if (random.uniform() < share) height = nodata;
    }
    terrain.name += " with holes";
    return terrain;
}

inline TestTerrain flat_terrain(Index rows, Index cols) {
    return terrain_of("flat", rows, cols, [](Index, Index) { return 3.0; });
}

namespace detail {
inline double radius(Index rows, Index cols, Index r, Index c) {
    return std::hypot(r - 0.5 * (rows - 1), c - 0.5 * (cols - 1));
}
}  // namespace detail

inline TestTerrain bowl(Index rows, Index cols) {
    return terrain_of("bowl", rows, cols, [=](Index r, Index c) { return detail::radius(rows, cols, r, c); });
}

inline TestTerrain cone(Index rows, Index cols) {
    return terrain_of("cone", rows, cols, [=](Index r, Index c) { return -detail::radius(rows, cols, r, c); });
}

/// Two planes falling west and east from a ridge in the middle column.
inline TestTerrain two_catchments(Index rows, Index cols) {
    return terrain_of("two catchments", rows, cols,
                      [=](Index r, Index c) { return -std::abs(0.5 * cols - c) + 0.001 * r; });
}

/// Ring walls around ring moats, each lower than the next one out: every moat spills into the next larger bowl.
inline TestTerrain bowl_of_bowls(Index rows, Index cols) {
    return terrain_of("bowl of bowls", rows, cols, [=](Index r, Index c) {
        const double distance = detail::radius(rows, cols, r, c);
        return distance + 3 * std::abs(std::sin(distance)) + 0.5 * std::sin(0.9 * c) * std::sin(1.1 * r);
    });
}

/// Parallel trenches that are joined only at one end, above their floors.
inline TestTerrain comb(Index rows, Index cols) {
    return terrain_of("comb", rows, cols, [=](Index r, Index c) {
        const bool rim = r == 0 || c == 0 || r + 1 == rows || c + 1 == cols;
        if (rim) return 100.0;
        return c % 2 == 1 ? 0.001 * r : (r == 1 ? 1.0 + 0.1 * c : 50.0);
    });
}

/// Lengths and areas that change from row to row, as on an ellipsoid.
inline Grid uneven_grid(Index rows, Index cols) {
    Grid grid = plane_grid(rows, cols, 30, 20);
    for (Index r = 0; r < rows; ++r) {
        grid.east_west[r] = 30 - 0.25 * r;
        grid.cell_area[r] = 20 * grid.east_west[r];
    }
    for (Index r = 0; r + 1 < rows; ++r) {
        grid.north_south[r] = 20 + 0.125 * r;
        grid.diagonal[r] = std::hypot(grid.north_south[r], 0.5 * (grid.east_west[r] + grid.east_west[r + 1]));
    }
    return grid;
}

/// A few of every kind, the sizes small enough for slow oracles. `seed` changes the random ones.
inline std::vector<TestTerrain> assorted_terrains(std::uint64_t seed) {
    Random random(seed, 4);
    const Index rows = 1 + random.below(14);
    const Index cols = 1 + random.below(14);
    std::vector<TestTerrain> terrains{
        noise_terrain(rows, cols, seed),
        stepped_terrain(rows, cols, 2 + random.below(8), seed),
        with_holes(noise_terrain(rows, cols, seed + 1000), 0.2, seed),
        with_holes(stepped_terrain(rows, cols, 3, seed + 1000), 0.4, seed),
        stepped_terrain(1, cols, 3, seed),
        stepped_terrain(rows, 1, 3, seed),
        stepped_terrain(rows + 6, cols + 6, 2, seed),
    };
    terrains.push_back({"noise on uneven cells", uneven_grid(rows, cols), noise_terrain(rows, cols, seed).elevation_m});
    return terrains;
}

inline std::vector<TestTerrain> shaped_terrains() {
    return {flat_terrain(1, 1),
            flat_terrain(7, 9),
            bowl(11, 12),
            cone(11, 12),
            bowl(1, 9),
            two_catchments(8, 11),
            bowl_of_bowls(25, 27),
            comb(12, 15),
            flat_terrain(2, 2),
            with_holes(flat_terrain(6, 6), 1.0, 1),
            with_holes(cone(15, 15), 0.1, 5)};
}

/// The same graph as a mesh: neighbours ascending (so slots differ from the grid's), same lengths and areas.
inline Mesh mesh_of(const Grid& grid) {
    Mesh mesh;
    mesh.offset.push_back(0);
    for (Index node = 0; node < grid.size(); ++node) {
        mesh.x.push_back(grid.col(node));
        mesh.y.push_back(-1.0 * grid.row(node));
        mesh.cell_area.push_back(grid.area(node));
        mesh.on_outline.push_back(0);
        for (const Slot slot : {5, 6, 7, 4, 0, 3, 2, 1}) {
            grid.neighbors(node, [&](Index neighbor, double length_m, Slot at) {
                if (at != slot) return;
                mesh.neighbor_list.push_back(neighbor);
                mesh.length_list.push_back(length_m);
            });
        }
        mesh.offset.push_back(static_cast<Index>(mesh.neighbor_list.size()));
    }
    return mesh;
}

}  // namespace thalweg::support
