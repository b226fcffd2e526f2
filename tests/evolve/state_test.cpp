// SPDX-License-Identifier: GPL-3.0-or-later
#include <catch2/catch.hpp>

#include "support/lattice_mesh.hpp"
#include "support/settings.hpp"
#include "thalweg/evolve/simulate.hpp"

using namespace thalweg;
using namespace thalweg::evolve;

namespace {

bool same(const MassBalance& a, const MassBalance& b) {
    return a.uplifted_m3 == b.uplifted_m3 && a.eroded_m3 == b.eroded_m3 && a.talus_m3 == b.talus_m3 &&
           a.exported_m3 == b.exported_m3 && a.stored_m3 == b.stored_m3;
}

/// Runs through in one go and records the state after every step.
template <class Topology>
std::vector<SimulationState> states_of_a_run(const Topology& topology, const Model& model, const Setting& setting,
                                             const TimeOptions& options, const Landscape& start) {
    std::vector<SimulationState> states;
    SimulationState state = initial_state(start);
    simulate(topology, model, setting, options, state,
             [&](const StepRecord&, const SimulationState& now) { states.push_back(now); });
    return states;
}

/// From any of those states the run ends with the same numbers, in the same step, for the same reason.
template <class Topology>
void goes_on_from_any_state(const Topology& topology, const Model& model, std::uint64_t seed) {
    const Setting setting = support::island(topology, 1e-3);
    const TimeOptions options{.step_yr = 1e5, .max_steps = 2000, .convergence = 1e-6};
    const auto states = states_of_a_run(topology, model, setting, options, support::rough_start(setting, 1, seed));
    const SimulationState& last = states.back();
    for (std::size_t from = 0; from < states.size(); from += 1 + states.size() / 9) {
        SimulationState state = states[from];
        const SimulationResult result = simulate(topology, model, setting, options, state);
        CHECK(result.steps == states.size());
        CHECK((result.stop_reason == StopReason::converged) == last.converged);
        CHECK(state.landscape.elevation_m == last.landscape.elevation_m);
        CHECK(state.landscape.time_yr == last.landscape.time_yr);
        CHECK(state.exchange.frozen == last.exchange.frozen);
        CHECK(same(result.mass, last.mass));
    }
}

}  // namespace

TEST_CASE("A run continued from the state after any step ends with the same numbers as one that never stopped") {
    for (std::uint64_t seed = 1; seed <= 4; ++seed) {
        goes_on_from_any_state(plane_grid(14, 15, 100, 100), {{.k = 2e-5, .m = 0.45, .n = 1.2}}, seed);
        goes_on_from_any_state(support::lattice_mesh(12, 12, 100, 0.3, seed), {{.k = 2e-5, .talus_slope = 0.6}}, seed);
    }
}

TEST_CASE("Creep, sediment and divided flow hide nothing from one step to the next") {
    const Hillslope linear{.diffusivity_m2_per_yr = 0.01},
        limited{.diffusivity_m2_per_yr = 0.01, .critical_slope = 0.8};
    const River laying_down{.k = 2e-5, .g = 0.7};
    goes_on_from_any_state(plane_grid(12, 11, 100, 100), {.river = laying_down, .hillslope = linear}, 1);
    goes_on_from_any_state(support::lattice_mesh(10, 10, 100, 0.3, 2), {.river = laying_down, .hillslope = limited}, 2);
    goes_on_from_any_state(plane_grid(12, 11, 100, 100), {{.k = 2e-5, .flow = Flow::multiple}}, 3);
}

TEST_CASE("A run that reached its last step goes on when it is given more steps") {
    const Grid grid = plane_grid(12, 12, 100, 100);
    const Setting setting = support::island(grid, 1e-3);
    const Landscape start = support::rough_start(setting, 1, 3);
    Landscape whole = start;
    simulate(grid, {{.k = 2e-5}}, setting, {.step_yr = 1e4, .max_steps = 20, .convergence = 0}, whole);
    SimulationState parts = initial_state(start);
    for (const Index steps : {7u, 7u, 13u, 20u}) {
        const auto result =
            simulate(grid, {{.k = 2e-5}}, setting, {.step_yr = 1e4, .max_steps = steps, .convergence = 0}, parts);
        CHECK(result.steps == steps);
    }
    CHECK(parts.landscape.elevation_m == whole.elevation_m);
}
