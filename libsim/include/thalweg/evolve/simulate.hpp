// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <functional>
#include <limits>
#include <string>

#include "thalweg/evolve/exchange_watch.hpp"
#include "thalweg/evolve/model.hpp"

namespace thalweg::evolve {

struct TimeOptions {
    double step_yr;
    Index max_steps;
    double convergence = 1e-3;  ///< stop when the mean rate falls below this times the mean uplift; 0: never
};

/// Whether the volume moved per step still falls: under half its lowest value so far at least once in some steps.
struct Slackening {
    double lowest_m3 = std::numeric_limits<double>::infinity();
    Index steps = 0;  ///< since it fell last
};

/// All that one step hands to the next: a copy of it, continued later or elsewhere, gives the same bytes. Whatever is
/// to survive a step stands here and nowhere else; buffers that only save time are no state.
struct SimulationState {
    Landscape landscape;
    Index steps = 0;
    bool converged = false;
    double max_rate_m_per_yr = 0, mean_rate_m_per_yr = 0;  ///< of the last step
    int largest_newton_iterations = 0;
    int largest_sediment_iterations = 0;    ///< of a step with deposition
    Index unconverged_sediment_steps = 0;   ///< steps with deposition that used up their iterations
    int largest_hillslope_iterations = 0;   ///< Newton iterations of a step of nonlinear creep
    Index unconverged_hillslope_steps = 0;  ///< steps of creep that used up their iterations
    MassBalance mass;                       ///< of all steps
    bool calm = false;                      ///< the last step moved no more than convergence asks for
    ExchangeWatch exchange;
    Slackening slackening;
};

/// The state before the first step.
SimulationState initial_state(Landscape);

/// After each step, for the history, progress and snapshots.
struct StepRecord {
    Index step;  ///< from 1
    double time_yr;
    Index lakes;
    double elevation_max_m, elevation_mean_m;  ///< mean weighted by cell area
    double max_rate_m_per_yr, mean_rate_m_per_yr;
    double seconds;  ///< wall time of this step; the only member that differs between equal runs
};

enum class StopReason { converged, max_steps };
std::string to_string(StopReason);

struct SimulationResult {
    Index steps = 0;
    StopReason stop_reason = StopReason::max_steps;
    double max_rate_m_per_yr = 0;
    double mean_rate_m_per_yr = 0;
    Index frozen_receivers = 0;
    std::vector<std::uint8_t> frozen;  ///< 1 at nodes whose receiver was frozen
    Index lakes_final = 0;
    MassBalance mass;
    int largest_newton_iterations = 0;
    int largest_sediment_iterations = 0;
    Index unconverged_sediment_steps = 0;
    int largest_hillslope_iterations = 0;
    Index unconverged_hillslope_steps = 0;
};

using Observer = std::function<void(const StepRecord&, const SimulationState&)>;

/// Steps until the landscape is steady or the steps are used up. The processes of a step follow one another (first
/// order in time), in the order of `Model`: uplift with river incision and the talus limit in one sweep, then creep.
///
/// Steady: the mean rate Σa·|Δh|/dt is at most `convergence` times Σa·u, and the new heights drain the same way as
/// those before the step (or the rate stays as low for one step more), so that no receiver that changes at the very end
/// sets the landscape going again. The bound is on the mean: in a landscape of N nodes one node may be N times further
/// off. For slopes right to 1e-8 at every one of N nodes ask for convergence = 1e-8/N; 1e-14 is within the reach of
/// doubles.
///
/// If for 50 steps only the same nodes exchanged their receivers, while the mean rate was under a tenth of the mean
/// uplift and no longer fell to half, those receivers are frozen (as long as they lead down) and counted. With
/// convergence = 0 nothing is frozen.
///
/// Histories in the setting: a step takes the mean uplift over itself (the exact integral of the history, so that the
/// volume uplifted does not depend on the steps) and the base level at its end (first order, as the step itself). Base
/// level is in no term of the mass balance, wherever it goes: its fall exports nothing by itself, its rise stores
/// nothing. Whether the landscape is steady is not asked, and no receiver frozen, before a step that begins after the
/// last change.
SimulationResult simulate(const Grid&, const Model&, const Setting&, const TimeOptions&, Landscape&,
                          const Observer& = {});
SimulationResult simulate(const Mesh&, const Model&, const Setting&, const TimeOptions&, Landscape&,
                          const Observer& = {});

/// The same from any state: what is left until it is steady or has `max_steps` steps, those before counted in.
SimulationResult simulate(const Grid&, const Model&, const Setting&, const TimeOptions&, SimulationState&,
                          const Observer& = {});
SimulationResult simulate(const Mesh&, const Model&, const Setting&, const TimeOptions&, SimulationState&,
                          const Observer& = {});

struct SteadyResult {
    Index sweeps;
    bool converged;
    Index frozen_receivers;
    std::vector<std::uint8_t> frozen;
};

/// Steady state directly: under fixed receivers every slope is min(talus, ((u + G·U/A)/(k·A^m))^(1/n)), U the uplift
/// (m³/yr) of the node and everything upstream, integrated up the trees;
/// re-routed until no receiver changes (those that cycle are kept after 20 repeats and counted). Where u > 0 and k·A^m
/// is 0 the talus limit must be on, else Error.
/// On ground that hardly rises below ground that rises fast, channels with sediment shift for ever: then `converged` is
/// false or many receivers are frozen.
SteadyResult solve_steady(const Grid&, const River&, const Setting&, Index max_sweeps, Landscape&);
SteadyResult solve_steady(const Mesh&, const River&, const Setting&, Index max_sweeps, Landscape&);

/// 1 where the slope to the receiver stands at the talus limit (relative tolerance 1e-9).
std::vector<std::uint8_t> at_talus_limit(const Grid&, const Drainage&, const River&, const Landscape&);
std::vector<std::uint8_t> at_talus_limit(const Mesh&, const Drainage&, const River&, const Landscape&);

}  // namespace thalweg::evolve
