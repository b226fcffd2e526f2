// SPDX-License-Identifier: GPL-3.0-or-later
#include "thalweg/evolve/river.hpp"

#include "evolve/check_setting.hpp"
#include "evolve/divided_erosion.hpp"
#include "evolve/drainage.hpp"
#include "evolve/erosion.hpp"
#include "evolve/sediment_step.hpp"

namespace thalweg::evolve {
namespace {

template <Topology T>
Drainage drained(const T& topology, const Landscape& landscape, const Setting& setting, const River& river,
                 const FlowDirections& frozen) {
    check_setting(topology.size(), landscape, setting);
    check_frozen(topology.size(), frozen);
    Drainage drainage;
    DrainBuffers buffers;
    drain_into(topology, landscape, setting, river, frozen, drainage, buffers);
    return drainage;
}

template <Topology T>
StepReport eroded(const T& topology, const Drainage& drainage, const River& river, const Setting& setting, double dt_yr,
                  Landscape& landscape) {
    check_setting(topology.size(), landscape, setting);
    check_river(river);
    check_step(dt_yr);
    const SlopeSolver solve(river.n);
    return with_edges(topology, [&](const auto& edges) {
        if (river.g == 0) return dig(edges, drainage, river, solve, setting, dt_yr, landscape).report(dt_yr);
        SedimentBuffers buffers;
        return erode_with_sediment(edges, drainage, river, solve, setting, dt_yr, landscape, buffers).report(dt_yr);
    });
}

template <class Edges>
std::vector<double> slopes(const Edges& edges, const Drainage& drainage, const River& river,
                           std::span<const double> elevation_m) {
    std::vector<double> slope(elevation_m.size(), std::numeric_limits<double>::quiet_NaN());
    const auto fall = [&](Index node, Index receiver, double length) {
        return std::max(0.0, elevation_m[node] - elevation_m[receiver]) / length;
    };
    for (const Index node : drainage.order) {
        const Slot slot = drainage.directions[node];
        if (slot == no_flow) continue;
        slope[node] = fall(node, edges.neighbor(node, slot), edges.length(node, slot));
        if (drainage.flow.size() == 0 || drainage.flow.offset[node + 1] - drainage.flow.offset[node] < 2) continue;
        double power = 0;
        drainage.flow.receivers(node, [&](Index receiver, double length, double share) {
            power += share * std::pow(fall(node, receiver, length), river.n);
        });
        slope[node] = std::pow(power, 1 / river.n);
    }
    return slope;
}

}  // namespace

double MassBalance::relative_residual() const {
    const double turned_over = uplifted_m3 > 0 ? uplifted_m3 : exported_m3;
    return turned_over > 0 ? (uplifted_m3 - exported_m3 - stored_m3) / turned_over : 0;
}

Drainage drain(const Grid& grid, const Landscape& landscape, const Setting& setting, terrain::Receiver receiver,
               const FlowDirections& frozen) {
    return drained(grid, landscape, setting, {.receiver = receiver}, frozen);
}

Drainage drain(const Mesh& mesh, const Landscape& landscape, const Setting& setting, terrain::Receiver receiver,
               const FlowDirections& frozen) {
    return drained(mesh, landscape, setting, {.receiver = receiver}, frozen);
}

Drainage drain(const Grid& grid, const Landscape& landscape, const Setting& setting, const River& river,
               const FlowDirections& frozen) {
    return drained(grid, landscape, setting, river, frozen);
}

Drainage drain(const Mesh& mesh, const Landscape& landscape, const Setting& setting, const River& river,
               const FlowDirections& frozen) {
    return drained(mesh, landscape, setting, river, frozen);
}

std::vector<double> slopes_along_flow(const Grid& grid, const Drainage& drainage, const River& river,
                                      const Landscape& landscape) {
    return slopes(grid, drainage, river, landscape.elevation_m);
}

std::vector<double> slopes_along_flow(const Mesh& mesh, const Drainage& drainage, const River& river,
                                      const Landscape& landscape) {
    return slopes(mesh, drainage, river, landscape.elevation_m);
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
