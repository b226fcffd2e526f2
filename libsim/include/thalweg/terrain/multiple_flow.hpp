// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <concepts>
#include <span>
#include <vector>

#include "thalweg/core/grid.hpp"
#include "thalweg/core/mesh.hpp"

namespace thalweg::terrain {

/// Flow that divides: a node gives its water to any number of neighbours. Compressed rows: the receivers of node i
/// stand at offset[i] … offset[i + 1] of the three lists. An outlet and a node without data have none.
struct MultipleFlow {
    std::vector<Index> offset;  ///< size() + 1
    std::vector<Index> receiver;
    std::vector<double> length;  ///< distance to the receiver, m
    std::vector<double> share;   ///< of the node's water that goes there, ≥ 0; those of one node add up to 1
    std::vector<Index> order;    ///< every node with data once, each after all its receivers

    Index size() const { return offset.empty() ? 0 : static_cast<Index>(offset.size() - 1); }

    /// Calls visit(receiver, length_m, share) for each receiver of the node, slots ascending.
    template <class Visit>
    void receivers(Index node, Visit visit) const {
        for (Index at = offset[node]; at < offset[node + 1]; ++at) visit(receiver[at], length[at], share[at]);
    }
};

/// What algorithms along the flow need, whether it divides or not: `FlowGraph` and `MultipleFlow` both model it.
/// Walking `order` forward goes upstream (receivers first), backward downstream.
template <class G>
concept ReceiverGraph = requires(const G& graph, Index node) {
    { graph.size() } -> std::same_as<Index>;
    { graph.order } -> std::convertible_to<std::span<const Index>>;
    graph.receivers(node, [](Index, double, double) {});
};

static_assert(ReceiverGraph<MultipleFlow>);

/// How slopes become shares.
struct Division {
    double exponent = 1.1;  ///< p > 0 on the slope: 1 (Quinn et al. 1991), 1.1 (Freeman 1991), 4 to 6 (Holmgren 1994)
    enum class Contour {
        equal,  ///< slope alone (Freeman, Holmgren)
        quinn   ///< times the contour length area/(2·length): 0.5 d straight and 0.354 d diagonal on square cells
    } contour = Contour::equal;
};

/// Divides the water of every node among its lower neighbours: share ∝ (contour length)·S^p, S the slope of the ground
/// to each. `single` are directions without loops (of `route`, `resolve_flats`, `drain_lakes`), and where flow cannot
/// divide it follows them: out of pits, through lakes, over flats and over passes.
///
/// No loops: let the water level of a node be the highest ground on its way out along `single`. Dry nodes (ground at
/// the level) give water to those neighbours whose level is lower, if there are any; every other node follows `single`,
/// along which the level never rises. So with each step either the level falls, or it stays and the step is one of
/// `single`, which has no loops. Where `single` comes from `drain_lakes`, the level is that of `fill`, and a dry node
/// off the shores has all its lower neighbours as receivers.
///
/// Linear in the nodes; the same bytes for any number of threads. Throws Error if sizes do not fit, or the exponent is
/// not a positive number. `into` is overwritten and its memory reused. `upstream` (or nothing) holds each node's own
/// amount and gets what `accumulate` makes of it.
MultipleFlow multiple_flow(const Grid&, std::span<const double> elevation_m, const FlowDirections& single,
                           Division = {});
MultipleFlow multiple_flow(const Mesh&, std::span<const double> elevation_m, const FlowDirections& single,
                           Division = {});
void multiple_flow(const Grid&, std::span<const double> elevation_m, const FlowDirections& single, Division,
                   MultipleFlow& into, std::span<double> upstream = {});
void multiple_flow(const Mesh&, std::span<const double> elevation_m, const FlowDirections& single, Division,
                   MultipleFlow& into, std::span<double> upstream = {});

/// Sum of `amount` over each node and everything upstream, divided as the flow is. With cell areas (m²) this is the
/// drainage area (m²), and the outlets' add up to the whole to rounding. Nodes without data stay 0.
std::vector<double> accumulate(const MultipleFlow&, std::span<const double> amount);

/// Highest ground on the way out of each node along `single` (receivers before donors in `order`), itself included: the
/// level of its water. NaN stays NaN.
std::vector<double> water_level(const Grid&, std::span<const double> elevation_m, const FlowDirections& single,
                                std::span<const Index> order);
std::vector<double> water_level(const Mesh&, std::span<const double> elevation_m, const FlowDirections& single,
                                std::span<const Index> order);

}  // namespace thalweg::terrain
