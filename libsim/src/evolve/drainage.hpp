// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cmath>
#include <span>

#include "evolve/edges.hpp"
#include "terrain/downhill.hpp"
#include "terrain/lake_buffers.hpp"
#include "terrain/layered_order.hpp"
#include "thalweg/core/parallel.hpp"
#include "thalweg/evolve/river.hpp"
#include "thalweg/terrain/graph.hpp"
#include "thalweg/terrain/lakes.hpp"
#include "thalweg/terrain/route.hpp"

namespace thalweg::evolve {

/// Gives the frozen nodes their direction wherever it still leads strictly down.
template <class Edges>
void keep_frozen(const Edges& edges, const std::vector<double>& elevation_m, const FlowDirections& frozen,
                 FlowDirections& directions) {
    for (Index node = 0; node < frozen.size(); ++node) {
        if (frozen[node] == no_flow) continue;
        if (elevation_m[edges.neighbor(node, frozen[node])] < elevation_m[node]) directions[node] = frozen[node];
    }
}

/// Memory that draining needs; kept from step to step it is allocated once.
struct DrainBuffers {
    terrain::LakeBuffers lakes;
    terrain::OrderBuffers order;
    std::vector<double> length;  ///< per node of a mesh: to the receiver in `lakes`, m
};

inline void note_flow(const Grid&, const FlowDirections&, DrainBuffers&) {}

/// Writes down where every node flows.
inline void note_flow(const Mesh& mesh, const FlowDirections& directions, DrainBuffers& buffers) {
    buffers.lakes.receiver.resize(mesh.size());
    buffers.length.resize(mesh.size());
    parallel_for(0, mesh.size(), [&](Index first, Index last) {
        for (Index node = first; node < last; ++node) {
            const Slot slot = directions[node];
            buffers.lakes.receiver[node] = slot == no_flow ? none : mesh.neighbor(node, slot);
            buffers.length[node] = slot == no_flow ? 0 : mesh.length(node, slot);
        }
    });
}

/// Calls body(edges) as `with_edges` does, but edges know only where the drainage last made leads.
template <class Body>
auto with_flow(const Grid& grid, const DrainBuffers&, Body body) {
    return with_edges(grid, body);
}

template <class Body>
auto with_flow(const Mesh& mesh, const DrainBuffers& buffers, Body body) {
    return body(terrain::MeshFlow(mesh, buffers.lakes.receiver, buffers.length));
}

inline const Grid& flow_of(const Grid& grid, const DrainBuffers&) { return grid; }

inline terrain::MeshFlow flow_of(const Mesh& mesh, const DrainBuffers& buffers) {
    return {mesh, buffers.lakes.receiver, buffers.length};
}

/// Rain on every node's own cell.
template <class Edges>
void collect_rain(const Edges& edges, const std::vector<double>& rainfall, std::vector<double>& area_m2) {
    area_m2.resize(rainfall.size());
    parallel_for(0, static_cast<Index>(rainfall.size()), [&](Index first, Index last) {
        for (Index node = first; node < last; ++node) area_m2[node] = edges.area(node) * rainfall[node];
    });
}

/// Sweeps jump about in memory, but the list says where they will be: this many nodes ahead are asked for early.
inline constexpr std::size_t ahead = 24;

/// Drainage of a landscape into buffers that live as long as the simulation. Nodes without data keep area 0.
template <Topology T>
void drain_into(const T& topology, const Landscape& landscape, const Setting& setting, const River& river,
                const FlowDirections& frozen, Drainage& drainage, DrainBuffers& buffers) {
    const auto& elevation_m = landscape.elevation_m;
    terrain::route(topology, elevation_m, setting.boundary, river.receiver, drainage.directions);
    if (!frozen.empty()) {
        with_edges(topology, [&](const auto& edges) { keep_frozen(edges, elevation_m, frozen, drainage.directions); });
    }
    drainage.lakes = terrain::drain_lakes(topology, elevation_m, setting.boundary, drainage.directions, buffers.lakes);
    note_flow(topology, drainage.directions, buffers);
    with_edges(topology, [&](const auto& edges) { collect_rain(edges, setting.rainfall, drainage.area_m2); });
    if (river.flow == Flow::multiple) {
        const terrain::Division division{.exponent = river.flow_exponent};
        terrain::multiple_flow(topology, elevation_m, drainage.directions, division, drainage.flow, drainage.area_m2);
        drainage.order = drainage.flow.order;
        drainage.layers = {};
        return;
    }
    double* const area_m2 = drainage.area_m2.data();
    terrain::order_by_layers(flow_of(topology, buffers), elevation_m, drainage.directions, buffers.order,
                             drainage.order, drainage.layers,
                             [=](Index donor, Index taker) { area_m2[taker] += area_m2[donor]; });
    if (drainage.order.size() == elevation_m.size()) return;
    for (Index node = 0; node < elevation_m.size(); ++node) {
        if (std::isnan(elevation_m[node])) area_m2[node] = 0;
    }
}

}  // namespace thalweg::evolve
