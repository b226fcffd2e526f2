// SPDX-License-Identifier: GPL-3.0-or-later
#include "thalweg/evolve/simulate.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <optional>

#include "evolve/check_setting.hpp"
#include "evolve/divided_erosion.hpp"
#include "evolve/drainage.hpp"
#include "evolve/erosion.hpp"
#include "evolve/sediment_step.hpp"

namespace thalweg::evolve {
namespace {

/// Steps for which only the same nodes may exchange receivers before they are frozen.
constexpr Index patience = 50;

/// Receivers are frozen only when the landscape has nearly come to rest (mean rate under this share of the mean uplift)
/// and gets no calmer: before that a node that swings to and fro is part of the growth.
constexpr double freezing_share = 0.1;

using Clock = std::chrono::steady_clock;

double seconds_since(Clock::time_point start) { return std::chrono::duration<double>(Clock::now() - start).count(); }

void observe(Slackening& slackening, double moved_m3) {
    ++slackening.steps;
    if (moved_m3 >= 0.5 * slackening.lowest_m3) return;
    slackening.lowest_m3 = moved_m3;
    slackening.steps = 0;
}

void add(MassBalance& total, const MassBalance& step) {
    total.uplifted_m3 += step.uplifted_m3;
    total.eroded_m3 += step.eroded_m3;
    total.talus_m3 += step.talus_m3;
    total.diffused_m3 += step.diffused_m3;
    total.deposited_m3 += step.deposited_m3;
    total.exported_m3 += step.exported_m3;
    total.stored_m3 += step.stored_m3;
}

/// What does not change during a run, and buffers that live as long as it. Nothing in it is state.
template <Topology T>
struct Run {
    const T& topology;
    const Model& model;
    const Setting& setting;
    const TimeOptions& options;
    SlopeSolver solve;
    Drainage drainage = {};
    DrainBuffers buffers = {};
    std::optional<HillslopeSolver> creep = {};
    std::vector<double> before_m = {};  // heights before the step; only with creep
    SedimentBuffers sediment = {};      // only with deposition
    Setting scaled = {};                // the setting of one step, where uplift has a history
    double settled_yr = 0;              // from then on nothing that drives the landscape changes
};

/// The setting of the step that begins now: the uplift's mean over the step, so that the volume uplifted is the
/// history's integral whatever the steps.
template <Topology T>
const Setting& setting_of_step(Run<T>& run, double start_yr) {
    if (run.setting.uplift_factor.value.empty()) return run.setting;
    const double factor = mean_between(run.setting.uplift_factor, start_yr, start_yr + run.options.step_yr);
    const auto& unscaled = run.setting.uplift_m_per_yr;
    for (Index node = 0; node < unscaled.size(); ++node) run.scaled.uplift_m_per_yr[node] = factor * unscaled[node];
    return run.scaled;
}

/// Implicit in time: a step erodes towards the base level at its end.
void move_base_level(const Setting& setting, double end_yr, Landscape& landscape) {
    if (setting.base_level_m.value.empty()) return;
    const double level = value_at(setting.base_level_m, end_yr);
    for (Index node = 0; node < landscape.elevation_m.size(); ++node) {
        const bool moves = setting.boundary[node] == Boundary::base_level && !std::isnan(landscape.elevation_m[node]);
        if (moves) landscape.elevation_m[node] = level;
    }
}

template <Topology T>
Run<T> make_run(const T& topology, const Model& model, const Setting& setting, const TimeOptions& options) {
    Run<T> run{topology, model, setting, options, SlopeSolver(model.river.n)};
    if (model.hillslope.diffusivity_m2_per_yr > 0) run.creep.emplace(topology, model.hillslope, setting);
    run.settled_yr = std::max(last_change_yr(setting.uplift_factor), last_change_yr(setting.base_level_m));
    if (!setting.uplift_factor.value.empty()) run.scaled = setting;
    return run;
}

template <Topology T>
bool drains_as_before(const Run<T>& run, const SimulationState& state) {
    Drainage now;
    DrainBuffers buffers;
    drain_into(run.topology, state.landscape, run.setting, run.model.river, state.exchange.frozen, now, buffers);
    return now.directions == run.drainage.directions;
}

/// Compares the volume that moved in a step with the volume uplifted in it. A receiver that changes at the very end
/// would set the landscape going again: at rest is what drains as it did, or stays calm for one step more.
template <Topology T>
void judge(const Run<T>& run, double moved_m3, double uplifted_m3, SimulationState& state) {
    const bool calm_before = state.calm;
    state.calm = moved_m3 <= run.options.convergence * uplifted_m3;
    if (state.calm && (calm_before || drains_as_before(run, state))) {
        state.converged = true;
        return;
    }
    if (run.model.river.flow == Flow::multiple) return;  // shares change little by little: there is nothing to freeze
    observe(state.exchange, run.drainage.directions);
    observe(state.slackening, moved_m3);
    const bool nearly_at_rest = moved_m3 < freezing_share * uplifted_m3 && state.slackening.steps >= patience;
    if (nearly_at_rest && only_the_same(state.exchange)) {
        freeze(state.exchange);
        state.slackening.steps = 0;
    }
}

/// Creep on what the rivers left. The rates become those of the whole step, from `before_m` on; returns the volume that
/// moved.
template <Topology T>
double creep(Run<T>& run, SimulationState& state, StepReport& report) {
    const HillslopeReport done = run.creep->step(run.options.step_yr, state.landscape);
    state.largest_hillslope_iterations = std::max(state.largest_hillslope_iterations, done.newton_iterations);
    state.unconverged_hillslope_steps += done.converged ? 0 : 1;
    report.mass.diffused_m3 = done.diffused_m3;
    report.mass.exported_m3 += done.diffused_m3;
    report.mass.stored_m3 += done.stored_m3;
    double moved = 0, area = 0, largest = 0;
    for (const Index node : run.drainage.order) {
        if (run.setting.boundary[node] == Boundary::base_level) continue;
        const double change = std::abs(state.landscape.elevation_m[node] - run.before_m[node]);
        area += run.topology.area(node);
        moved += run.topology.area(node) * change;
        largest = std::max(largest, change);
    }
    report.max_rate_m_per_yr = largest / run.options.step_yr;
    report.mean_rate_m_per_yr = area > 0 ? moved / area / run.options.step_yr : 0;
    return moved;
}

/// One step of the model: drain, then each process in turn.
template <Topology T>
StepReport step(Run<T>& run, SimulationState& state) {
    Landscape& landscape = state.landscape;
    const River& river = run.model.river;
    const double start_yr = landscape.time_yr;
    const Setting& setting = setting_of_step(run, start_yr);
    move_base_level(setting, start_yr + run.options.step_yr, landscape);
    if (run.creep) run.before_m = landscape.elevation_m;
    drain_into(run.topology, landscape, setting, river, state.exchange.frozen, run.drainage, run.buffers);
    const StepSums sums = with_flow(run.topology, run.buffers, [&](const auto& edges) {
        if (river.g > 0) {
            return erode_with_sediment(edges, run.drainage, river, run.solve, setting, run.options.step_yr, landscape,
                                       run.sediment);
        }
        return dig(edges, run.drainage, river, run.solve, setting, run.options.step_yr, landscape);
    });
    StepReport report = sums.report(run.options.step_yr);
    const double moved_m3 = run.creep ? creep(run, state, report) : sums.moved;
    ++state.steps;
    state.max_rate_m_per_yr = report.max_rate_m_per_yr;
    state.mean_rate_m_per_yr = report.mean_rate_m_per_yr;
    state.largest_newton_iterations = std::max(state.largest_newton_iterations, report.largest_newton_iterations);
    state.largest_sediment_iterations = std::max(state.largest_sediment_iterations, report.sediment_iterations);
    state.unconverged_sediment_steps += report.sediment_converged ? 0 : 1;
    add(state.mass, report.mass);
    const bool may_be_judged = run.options.convergence > 0 && start_yr >= run.settled_yr;
    if (may_be_judged) judge(run, moved_m3, sums.uplifted.value(), state);
    return report;
}

template <Topology T>
StepRecord record(const T& topology, const SimulationState& state, Index lakes, double seconds) {
    double highest = -std::numeric_limits<double>::infinity();
    CompensatedSum volume, area;
    for (Index node = 0; node < topology.size(); ++node) {
        const double height = state.landscape.elevation_m[node];
        if (std::isnan(height)) continue;
        highest = std::max(highest, height);
        volume.add(topology.area(node) * height);
        area.add(topology.area(node));
    }
    return {.step = state.steps,
            .time_yr = state.landscape.time_yr,
            .lakes = lakes,
            .elevation_max_m = highest,
            .elevation_mean_m = volume.value() / area.value(),
            .max_rate_m_per_yr = state.max_rate_m_per_yr,
            .mean_rate_m_per_yr = state.mean_rate_m_per_yr,
            .seconds = seconds};
}

template <Topology T>
SimulationResult result_of(const Run<T>& run, const SimulationState& state) {
    const auto& elevation_m = state.landscape.elevation_m;
    const auto& boundary = run.setting.boundary;
    FlowDirections directions = terrain::route(run.topology, elevation_m, boundary, run.model.river.receiver);
    SimulationResult result{.steps = state.steps,
                            .stop_reason = state.converged ? StopReason::converged : StopReason::max_steps,
                            .max_rate_m_per_yr = state.max_rate_m_per_yr,
                            .mean_rate_m_per_yr = state.mean_rate_m_per_yr,
                            .frozen_receivers = frozen_count(state.exchange),
                            .frozen = frozen_mask(state.exchange),
                            .mass = state.mass,
                            .largest_newton_iterations = state.largest_newton_iterations,
                            .largest_sediment_iterations = state.largest_sediment_iterations,
                            .unconverged_sediment_steps = state.unconverged_sediment_steps,
                            .largest_hillslope_iterations = state.largest_hillslope_iterations,
                            .unconverged_hillslope_steps = state.unconverged_hillslope_steps};
    result.lakes_final = terrain::drain_lakes(run.topology, elevation_m, boundary, directions);
    return result;
}

template <Topology T>
void check(const T& topology, const Model& model, const Setting& setting, const TimeOptions& options,
           const Landscape& landscape) {
    check_setting(topology.size(), landscape, setting);
    check_river(model.river);
    check_hillslope(model.hillslope);
    check_step(options.step_yr);
}

template <Topology T>
SimulationResult continued(const T& topology, const Model& model, const Setting& setting, const TimeOptions& options,
                           SimulationState& state, const Observer& observer) {
    check(topology, model, setting, options, state.landscape);
    Run<T> run = make_run(topology, model, setting, options);
    while (state.steps < options.max_steps && !state.converged) {
        const auto start = Clock::now();
        step(run, state);
        if (observer) observer(record(topology, state, run.drainage.lakes, seconds_since(start)), state);
    }
    return result_of(run, state);
}

template <Topology T>
SimulationResult simulated(const T& topology, const Model& model, const Setting& setting, const TimeOptions& options,
                           Landscape& landscape, const Observer& observer) {
    check(topology, model, setting, options, landscape);
    SimulationState state = initial_state(std::move(landscape));
    const SimulationResult result = continued(topology, model, setting, options, state, observer);
    landscape = std::move(state.landscape);
    return result;
}

template <class Edges>
std::vector<std::uint8_t> talus_mask(const Edges& edges, const Drainage& drainage, const River& river,
                                     const std::vector<double>& elevation_m) {
    std::vector<std::uint8_t> mask(elevation_m.size(), 0);
    for (const Index node : drainage.order) {
        const Slot slot = drainage.directions[node];
        if (slot == no_flow) continue;
        const auto at_limit = [&](Index receiver, double length) {
            return elevation_m[node] - elevation_m[receiver] >= river.talus_slope * length * (1 - 1e-9);
        };
        mask[node] = at_limit(edges.neighbor(node, slot), edges.length(node, slot));
        if (drainage.flow.size() == 0) continue;
        drainage.flow.receivers(node, [&](Index receiver, double length, double) {
            if (at_limit(receiver, length)) mask[node] = 1;
        });
    }
    return mask;
}

}  // namespace

std::string to_string(StopReason reason) { return reason == StopReason::converged ? "converged" : "max_steps"; }

SimulationState initial_state(Landscape landscape) {
    SimulationState state;
    state.exchange = exchange_watch(static_cast<Index>(landscape.elevation_m.size()), patience);
    state.landscape = std::move(landscape);
    return state;
}

SimulationResult simulate(const Grid& grid, const Model& model, const Setting& setting, const TimeOptions& options,
                          Landscape& landscape, const Observer& observer) {
    return simulated(grid, model, setting, options, landscape, observer);
}

SimulationResult simulate(const Mesh& mesh, const Model& model, const Setting& setting, const TimeOptions& options,
                          Landscape& landscape, const Observer& observer) {
    return simulated(mesh, model, setting, options, landscape, observer);
}

SimulationResult simulate(const Grid& grid, const Model& model, const Setting& setting, const TimeOptions& options,
                          SimulationState& state, const Observer& observer) {
    return continued(grid, model, setting, options, state, observer);
}

SimulationResult simulate(const Mesh& mesh, const Model& model, const Setting& setting, const TimeOptions& options,
                          SimulationState& state, const Observer& observer) {
    return continued(mesh, model, setting, options, state, observer);
}

std::vector<std::uint8_t> at_talus_limit(const Grid& grid, const Drainage& drainage, const River& river,
                                         const Landscape& landscape) {
    return with_edges(grid,
                      [&](const auto& edges) { return talus_mask(edges, drainage, river, landscape.elevation_m); });
}

std::vector<std::uint8_t> at_talus_limit(const Mesh& mesh, const Drainage& drainage, const River& river,
                                         const Landscape& landscape) {
    return talus_mask(mesh, drainage, river, landscape.elevation_m);
}

}  // namespace thalweg::evolve
