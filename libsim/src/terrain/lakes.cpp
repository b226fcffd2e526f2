// SPDX-License-Identifier: GPL-3.0-or-later
#include "thalweg/terrain/lakes.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>

#include "terrain/basin_graph.hpp"
#include "terrain/check_sizes.hpp"
#include "terrain/lake_basins.hpp"
#include "terrain/terrain_view.hpp"
#include "thalweg/core/parallel.hpp"

namespace thalweg::terrain {
namespace {

/// First neighbour of equal height and lower index; `no_flow` if there is none. Flowing along these can never loop:
/// height never rises, and where it stays the index falls.
template <Topology T>
Slot level_slot(const Terrain<T>& terrain, Index node) {
    Slot found = no_flow;
    terrain.topology.neighbors(node, [&](Index neighbor, double, Slot slot) {
        const bool level = neighbor < node && terrain.elevation_m[neighbor] == terrain.elevation_m[node];
        if (found == no_flow && level) found = slot;
    });
    return found;
}

/// First node from `node` on that has no direction, or the number of nodes. The library's byte search, since most calls
/// of a simulation find no pit at all.
Index next_without_flow(const FlowDirections& directions, Index node) {
    const std::size_t left = directions.size() - node;
    const void* found = left == 0 ? nullptr : std::memchr(directions.data() + node, no_flow, left);
    if (found == nullptr) return static_cast<Index>(directions.size());
    return static_cast<Index>(static_cast<const Slot*>(found) - directions.data());
}

/// Leads flats down their indices and returns, after an entry for the outside, the pits that remain: one per basin.
template <Topology T>
std::vector<Index> pits_after_joining_flats(const Terrain<T>& terrain, FlowDirections& directions) {
    std::vector<Index> pits{none};
    for (Index node = next_without_flow(directions, 0); node < directions.size();
         node = next_without_flow(directions, node + 1)) {
        if (terrain.boundary[node] != Boundary::interior || !terrain.has_data(node)) continue;
        directions[node] = level_slot(terrain, node);
        if (directions[node] == no_flow) pits.push_back(node);
    }
    return pits;
}

/// What is known once all water has a way out.
struct Lakes {
    LakeBasins basins;
    SpillTree spill;
};

template <Topology T>
SpillTree join_basins(const Terrain<T>& terrain, const LakeBasins& basins, LakeBuffers& buffers) {
    passes_between(terrain, basins, buffers);
    std::vector<std::vector<Pass>*> lists;
    for (PassBuffers& search : buffers.search) lists.push_back(&search.passes);
    Joined joined(basins.count());
    std::vector<Pass> tree = spanning_passes(lists, joined);
    return spill_tree(std::move(tree), joined, basins.pit, terrain.elevation_m);
}

template <Topology T>
Lakes find_lakes(const Terrain<T>& terrain, FlowDirections& directions, LakeBuffers& buffers) {
    std::vector<Index> pits = pits_after_joining_flats(terrain, directions);
    Lakes lakes{.basins = {}, .spill = {.way_out = {}, .order = {}, .lakes = 0}};
    if (pits.size() == 1) return lakes;
    lakes.basins = lake_basins(terrain.topology, directions, std::move(pits), buffers);
    lakes.spill = join_basins(terrain, lakes.basins, buffers);
    return lakes;
}

/// Water level of every basin: no lower than that of the basin it spills into.
std::vector<double> water_levels(const SpillTree& spill) {
    std::vector<double> level(spill.way_out.size(), -std::numeric_limits<double>::infinity());
    for (const Index basin : spill.order) {
        if (basin == outside) continue;
        const Pass& out = spill.way_out[basin];
        level[basin] = std::max(out.height_m, level[out.other_basin]);
    }
    return level;
}

/// The ground, under water up to its level.
std::vector<double> water_surface(std::span<const double> elevation_m, const Lakes& lakes) {
    std::vector<double> surface(elevation_m.begin(), elevation_m.end());
    const std::vector<double> level = water_levels(lakes.spill);
    const auto some = [&](Index first, Index last) {
        for (Index basin = first; basin < last; ++basin) {
            for (const Index node : lakes.basins.nodes[basin]) surface[node] = std::max(surface[node], level[basin]);
        }
    };
    parallel_for(0, lakes.basins.count(), some, 128);
    return surface;
}

template <Topology T>
std::vector<double> filled(const Terrain<T>& terrain) {
    check_sizes(terrain.topology.size(), terrain.elevation_m.size(), terrain.boundary.size());
    FlowDirections directions = route(terrain.topology, terrain.elevation_m, terrain.boundary);
    LakeBuffers buffers;
    return water_surface(terrain.elevation_m, find_lakes(terrain, directions, buffers));
}

/// Turns round the path from `node` down to its pit, so that `node` flows by `out` and the pit towards `node`.
template <Topology T>
void reverse_path(const T& topology, Index node, Slot out, FlowDirections& directions) {
    while (true) {
        const Slot down = directions[node];
        directions[node] = out;
        if (down == no_flow) return;
        out = topology.reverse(node, down);
        node = topology.neighbor(node, down);
    }
}

template <Topology T>
Slot slot_towards(const T& topology, Index node, Index target) {
    Slot found = no_flow;
    topology.neighbors(node, [&](Index neighbor, double, Slot slot) {
        if (neighbor == target) found = slot;
    });
    return found;
}

/// Returns the lakes, too, good as long as the buffers are.
template <Topology T>
Lakes drained(const Terrain<T>& terrain, FlowDirections& directions, LakeBuffers& buffers) {
    check_sizes(terrain.topology.size(), terrain.elevation_m.size(), terrain.boundary.size());
    check_sizes(terrain.topology.size(), directions.size(), directions.size());
    Lakes lakes = find_lakes(terrain, directions, buffers);
    for (Index basin = 1; basin < lakes.basins.count(); ++basin) {
        const Pass& out = lakes.spill.way_out[basin];
        reverse_path(terrain.topology, out.node, slot_towards(terrain.topology, out.node, out.other_node), directions);
    }
    return lakes;
}

}  // namespace

std::vector<double> fill(const Grid& grid, std::span<const double> elevation_m, std::span<const Boundary> boundary) {
    return filled(Terrain<Grid>{grid, elevation_m, boundary});
}

std::vector<double> fill(const Mesh& mesh, std::span<const double> elevation_m, std::span<const Boundary> boundary) {
    return filled(Terrain<Mesh>{mesh, elevation_m, boundary});
}

Index drain_lakes(const Grid& grid, std::span<const double> elevation_m, std::span<const Boundary> boundary,
                  FlowDirections& directions, LakeBuffers& buffers) {
    return drained(Terrain<Grid>{grid, elevation_m, boundary}, directions, buffers).spill.lakes;
}

Index drain_lakes(const Mesh& mesh, std::span<const double> elevation_m, std::span<const Boundary> boundary,
                  FlowDirections& directions, LakeBuffers& buffers) {
    return drained(Terrain<Mesh>{mesh, elevation_m, boundary}, directions, buffers).spill.lakes;
}

Index drain_lakes(const Grid& grid, std::span<const double> elevation_m, std::span<const Boundary> boundary,
                  FlowDirections& directions) {
    LakeBuffers buffers;
    return drain_lakes(grid, elevation_m, boundary, directions, buffers);
}

Index drain_lakes(const Mesh& mesh, std::span<const double> elevation_m, std::span<const Boundary> boundary,
                  FlowDirections& directions) {
    LakeBuffers buffers;
    return drain_lakes(mesh, elevation_m, boundary, directions, buffers);
}

DrainedAndFilled drain_and_fill(const Grid& grid, std::span<const double> elevation_m,
                                std::span<const Boundary> boundary, FlowDirections& directions) {
    LakeBuffers buffers;
    const Lakes lakes = drained(Terrain<Grid>{grid, elevation_m, boundary}, directions, buffers);
    return {.lakes = lakes.spill.lakes, .filled_m = water_surface(elevation_m, lakes)};
}

}  // namespace thalweg::terrain
