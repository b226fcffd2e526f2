// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <span>
#include <vector>

#include "thalweg/core/grid.hpp"
#include "thalweg/core/mesh.hpp"
#include "thalweg/terrain/receivers.hpp"

namespace thalweg::terrain {

/// How an order may be swept by several nodes and threads at a time: from the outlets up, part 0 (the trunk) must come
/// first, and then the other parts are independent of each other; within a part, layer by layer, and no node of a layer
/// flows to another of the same layer. A function of the directions alone.
struct FlowLayers {
    std::vector<Index> begin;  ///< position in the order where each layer begins, and the end
    std::vector<Index> part;   ///< number of the layer with which each part begins, and the number of layers
};

/// Where all water goes: from here on the geometry is not needed, and a DEM, a simulated mesh and a grown network look
/// the same to every statistic.
struct FlowGraph {
    Receivers receiver;        ///< per node; `none` at outlets and nodes without data
    ReceiverLengths length;    ///< per node: distance to the receiver (m); 0 where there is none
    std::vector<Index> order;  ///< every node with data once, each after its receiver
    FlowLayers layers = {};    ///< of the order; empty where nobody knows them

    Index size() const { return static_cast<Index>(receiver.size()); }

    /// Calls visit(receiver, length_m, share) where the node has a receiver; the share is 1.
    template <class Visit>
    void receivers(Index node, Visit visit) const {
        if (receiver[node] != none) visit(receiver[node], length[node], 1.0);
    }
};

/// Nodes with data (elevation not NaN), each after its receiver. Linear, without recursion; a function of the
/// directions alone. `directions` must be free of loops.
std::vector<Index> downstream_first_order(const Grid&, std::span<const double> elevation_m, const FlowDirections&);
std::vector<Index> downstream_first_order(const Mesh&, std::span<const double> elevation_m, const FlowDirections&);

/// The directions of a topology as a graph.
FlowGraph flow_graph(const Grid&, std::span<const double> elevation_m, FlowDirections);
FlowGraph flow_graph(const Mesh&, std::span<const double> elevation_m, const FlowDirections&);

/// A graph and the drainage area (m²) of each of its nodes; 0 without data.
struct GraphAndArea {
    FlowGraph graph;
    std::vector<double> drainage_area_m2;
};

/// `flow_graph` of a grid, and `accumulate` of its cells' areas in the same walk: the same numbers in less time.
GraphAndArea graph_and_area(const Grid&, std::span<const double> elevation_m, FlowDirections);

}  // namespace thalweg::terrain
