// SPDX-License-Identifier: GPL-3.0-or-later
#include "thalweg/evolve/river.hpp"

#include "evolve/check_setting.hpp"
#include "evolve/drainage.hpp"
#include "evolve/erosion.hpp"

namespace thalweg::evolve {
namespace {

template <Topology T>
Drainage drained(const T& topology, const Landscape& landscape, const Setting& setting, terrain::Receiver receiver,
                 const FlowDirections& frozen) {
    check_setting(topology.size(), landscape, setting);
    check_frozen(topology.size(), frozen);
    Drainage drainage;
    drain_into(topology, landscape, setting, receiver, frozen, drainage);
    return drainage;
}

template <Topology T>
StepReport eroded(const T& topology, const Drainage& drainage, const River& river, const Setting& setting, double dt_yr,
                  Landscape& landscape) {
    check_setting(topology.size(), landscape, setting);
    check_river(river);
    check_step(dt_yr);
    return with_edges(topology, [&](const auto& edges) {
        return erode_along(edges, drainage, river, SlopeSolver(river.n), setting, dt_yr, landscape).report(dt_yr);
    });
}

}  // namespace

Drainage drain(const Grid& grid, const Landscape& landscape, const Setting& setting, terrain::Receiver receiver,
               const FlowDirections& frozen) {
    return drained(grid, landscape, setting, receiver, frozen);
}

Drainage drain(const Mesh& mesh, const Landscape& landscape, const Setting& setting, terrain::Receiver receiver,
               const FlowDirections& frozen) {
    return drained(mesh, landscape, setting, receiver, frozen);
}

StepReport erode(const Grid& grid, const Drainage& drainage, const River& river, const Setting& setting, double dt_yr,
                 Landscape& landscape) {
    return eroded(grid, drainage, river, setting, dt_yr, landscape);
}

StepReport erode(const Mesh& mesh, const Drainage& drainage, const River& river, const Setting& setting, double dt_yr,
                 Landscape& landscape) {
    return eroded(mesh, drainage, river, setting, dt_yr, landscape);
}

}  // namespace thalweg::evolve
