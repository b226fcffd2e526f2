// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <limits>
#include <span>
#include <vector>

#include "thalweg/core/grid.hpp"
#include "thalweg/core/mesh.hpp"
#include "thalweg/evolve/landscape.hpp"
#include "thalweg/terrain/graph.hpp"
#include "thalweg/terrain/multiple_flow.hpp"
#include "thalweg/terrain/route.hpp"

namespace thalweg::evolve {

/// Whether a node gives its water to one neighbour or divides it among its lower ones.
enum class Flow { single, multiple };

/// Stream-power incision dh/dt = u − k·A^m·S^n (Whipple & Tucker 1999), with the talus limit of Musgrave et al. 1989.
///
/// Where flow divides, S^n is averaged over where the water goes, Σ w_r·S_r^n with the shares w_r of
/// `terrain::multiple_flow` at the beginning of the step, and A is the divided area. With all receivers equally steep
/// that is the law of one receiver, whatever their number (decisions/2026-11-22-multiple-flow.md).
///
/// With G > 0 rivers lay down part of what they carry (Davy & Lague 2009; Yuan et al. 2019): dh/dt = u − k·A^m·S^n +
/// (G/A)·Q, Q the rate at which all cells upstream lose volume, the node's own included.
struct River {
    double k = 0;                                                  ///< erodibility, m^(1−2m)/yr
    double m = 0.5;                                                ///< area exponent
    double n = 1;                                                  ///< slope exponent, 0.3 … 5
    double talus_slope = std::numeric_limits<double>::infinity();  ///< tan of the steepest stable angle; infinity: off
    terrain::Receiver receiver = terrain::Receiver::steepest;
    Flow flow = Flow::single;
    double flow_exponent = 1.1;  ///< of the slopes in the shares (Freeman 1991)
    double g = 0;                ///< G ≥ 0, dimensionless: deposition; 0: off
};

/// Volumes moved in one step or many (m³), each summed from its own law and not from the difference it should close.
/// Base-level nodes are in no term.
struct MassBalance {
    double uplifted_m3 = 0;   ///< Σ a·dt·u
    double eroded_m3 = 0;     ///< Σ a·dt·k·A^m·S^n at the slopes at the end of the step
    double talus_m3 = 0;      ///< what the talus limit took
    double diffused_m3 = 0;   ///< what hillslope diffusion carried into base-level nodes, net
    double deposited_m3 = 0;  ///< Σ a·dt·(G/A)·Q, what rivers laid down
    double exported_m3 = 0;   ///< eroded + talus + diffused − deposited: what left through the outlets
    double stored_m3 = 0;     ///< Σ a·(h_end − h_start)

    /// (uplifted − exported − stored) / uplifted; over exported where nothing was uplifted; 0 where nothing moved.
    double relative_residual() const;
};

/// Where the water goes in a landscape, lakes led over their passes.
struct Drainage {
    FlowDirections directions;
    std::vector<Index> order;     ///< receivers before donors
    terrain::FlowLayers layers;   ///< of the order
    std::vector<double> area_m2;  ///< effective drainage area: rainfall-weighted
    Index lakes = 0;
    terrain::MultipleFlow flow = {};  ///< where flow divides; else empty
};

/// Routes, leads lakes over their passes, orders the nodes and adds up the rain: linear in the nodes but for the
/// sorting of passes. `frozen`: direction each node keeps as long as it is downhill, `no_flow` for the free ones;
/// empty: all are free.
Drainage drain(const Grid&, const Landscape&, const Setting&, terrain::Receiver, const FlowDirections& frozen = {});
Drainage drain(const Mesh&, const Landscape&, const Setting&, terrain::Receiver, const FlowDirections& frozen = {});

/// The same with the flow of the river: if it divides, `directions` are the single ones that lakes and flats follow,
/// and order and area those of the divided flow.
Drainage drain(const Grid&, const Landscape&, const Setting&, const River&, const FlowDirections& frozen = {});
Drainage drain(const Mesh&, const Landscape&, const Setting&, const River&, const FlowDirections& frozen = {});

/// What a step did besides changing the landscape.
struct StepReport {
    double max_rate_m_per_yr;
    double mean_rate_m_per_yr;  ///< Σ a·|Δh| / (dt·Σ a), base level left out
    int largest_newton_iterations;
    MassBalance mass;
    int sediment_iterations = 0;  ///< until heights and sediment agreed; 0 without deposition
    bool sediment_converged = true;
};

/// One implicit step (Braun & Willett 2013) along the given drainage, from the outlets up: with b = h + dt·u, a node
/// stays at b where its receiver ends no lower, else x solves x = b − dt·k·A^m·((x − h_receiver)/d)^n in (h_receiver,
/// b); then the talus limit. First order in time, stable for every dt; linear in the nodes, one call of pow per node
/// where n ≠ 1 (and one where m is neither 0.5 nor 1).
///
/// Along divided flow x solves x = b − dt·k·A^m·Σ w_r·((x − h_r)/d_r)^n over the receivers that end below x: there is
/// one such x, in closed form for n = 1, else by Newton's rule in a bracket (one pow per receiver and iteration). The
/// talus limit holds towards the steepest receiver.
///
/// With deposition (g > 0) all is solved together at the heights of the step's end: h' = b − dt·k·A^m·S'^n − talus +
/// (G/A)·q, with q = Σ a·(b − h') over the node and everything upstream (what the talus limit took included). These
/// equations form a tree: a node's height hangs on its receiver's and on the sediment that its donors send. Each
/// iteration sweeps down and finds for every node how the sediment that leaves it answers to the height of its receiver
/// (a straight line; for n ≠ 1 the tangent), then up, and solves every node's own equation with that answer in it. That
/// is Newton's rule with the elimination done by hand: exact after one iteration for n = 1 outside of lakes, a few
/// otherwise, at most 100, whatever dt and G. A node that begins the step in a lake (below ground that its water has to
/// pass) is filled at most to the level that the lake has at the step's end, unless uplift alone lifts it out; what
/// finds no room goes on with the water. Where no water runs (no rain) nothing is laid down.
///
/// Along divided flow sediment divides as the water does, and the equations form no tree: the same two sweeps, with the
/// answer found as if all receivers of a node moved together, are iterated until no height changes by more than 1e-12
/// of the relief, at most 200 times (about 15 times for G = 0.5, 30 for 2 and 55 for 5).
///
/// A node without receiver keeps its height and is in no term: base level, an `open` node with no lower neighbour, and
/// the lowest node of a connected piece that has no outlet at all. Nodes without data (NaN) stay as they are.
/// Throws Error if sizes do not fit, k or m is negative, n is outside [0.3, 5], the talus slope or dt is not
/// positive, or G is negative.
StepReport erode(const Grid&, const Drainage&, const River&, const Setting&, double dt_yr, Landscape&);
StepReport erode(const Mesh&, const Drainage&, const River&, const Setting&, double dt_yr, Landscape&);

/// Slope of every node along its flow as the law sees it: S to the receiver, or (Σ w_r·S_r^n)^(1/n) over several;
/// uphill counts as 0. Steady nodes stand at (u/k)^(1/n)·A^(−m/n). NaN without receiver.
std::vector<double> slopes_along_flow(const Grid&, const Drainage&, const River&, const Landscape&);
std::vector<double> slopes_along_flow(const Mesh&, const Drainage&, const River&, const Landscape&);

}  // namespace thalweg::evolve
