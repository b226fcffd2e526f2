// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <memory>

#include "thalweg/core/grid.hpp"
#include "thalweg/core/mesh.hpp"
#include "thalweg/evolve/landscape.hpp"

namespace thalweg::evolve {

/// Soil creep dh/dt = −∇·q: linear, q = −D·∇h, or with a critical slope (Roering, Kirchner & Dietrich 1999),
/// q = −D·∇h / (1 − (|∇h|/Sc)²), which no slope can pass.
struct Hillslope {
    double diffusivity_m2_per_yr = 0;  ///< D ≥ 0; 0: off
    double critical_slope = 0;         ///< Sc, m/m; 0: linear
};

/// What one step of diffusion did.
struct HillslopeReport {
    double diffused_m3 = 0;     ///< carried into base-level nodes (net), from the fluxes at the end of the step
    double stored_m3 = 0;       ///< Σ a·Δh; −diffused but for rounding
    double moved_m3 = 0;        ///< volume taken where the ground fell: Σ a·max(0, −Δh)
    double steepest_slope = 0;  ///< |∇h| after the step, base-level nodes among themselves left out
    int newton_iterations = 0;  ///< 1 for linear diffusion
    int linear_iterations = 0;  ///< of the conjugate gradients, in all
    bool converged = true;      ///< false: the iterations were used up
};

/// Takes implicit (backward Euler) steps of diffusion on one topology, and keeps between them what does not change.
///
/// In space: two-point finite volumes, written as sums over patches with one gradient each. On a mesh the patches are
/// the triangles, and for linear diffusion the flux along an edge is D·(h_i − h_j)·width/length with the width of the
/// Voronoi face (half the sum of the cotangents opposite, times the length). These are never negative on Delaunay
/// meshes whose outline has the Gabriel property, as `triangulate` makes them, so that no heights arise that lay
/// outside the old ones. On a grid they are the four corners of every cell, with the two lengths of its row and gap:
/// five points when linear, nine with a critical slope. The outer faces of the domain and those to nodes without data
/// let nothing pass. Second order in space, first in time (`validation/hillslope.cpp`).
///
/// Linear steps solve one symmetric system by conjugate gradients with a multigrid preconditioner (smoothed
/// aggregation) to a residual of 1e-13 of the right-hand side: stable for every dt, about 10 to 30 iterations whatever
/// the number of nodes. With a critical slope a step minimises a convex energy that is infinite from Sc on, by Newton's
/// rule from within, so that every slope ends below Sc, even where the step begins far above (rivers cut, and heights
/// that were read, may be steeper). It starts from the linear step, and where that leaves slopes above Sc from a
/// longer, smoother one and comes back by factors of 10: 4 to 50 iterations, at most 300, until a step is under 1e-8 of
/// the relief. Only base-level nodes with prescribed heights can force steeper ground between them; there Sc is raised
/// to 1.5 times the slope that they force. At last all heights are shifted by one amount of the size of these
/// tolerances that closes the mass balance to rounding.
///
/// Base-level nodes keep their heights; all others diffuse. Without data (NaN) nodes stay as they are, and which they
/// are must not change from step to step. Time is not counted on: the river's part of the step does that.
/// The same bytes for any number of threads. Throws Error if D or Sc is negative or sizes or dt make no sense.
class HillslopeSolver {
  public:
    /// The topology and setting must outlive the solver.
    HillslopeSolver(const Grid&, const Hillslope&, const Setting&);
    HillslopeSolver(const Mesh&, const Hillslope&, const Setting&);
    ~HillslopeSolver();
    HillslopeSolver(HillslopeSolver&&) noexcept;
    HillslopeSolver& operator=(HillslopeSolver&&) noexcept;

    HillslopeReport step(double dt_yr, Landscape&);

    class Steps;

  private:
    std::unique_ptr<Steps> steps_;
};

/// One step by itself.
HillslopeReport diffuse(const Grid&, const Hillslope&, const Setting&, double dt_yr, Landscape&);
HillslopeReport diffuse(const Mesh&, const Hillslope&, const Setting&, double dt_yr, Landscape&);

}  // namespace thalweg::evolve
