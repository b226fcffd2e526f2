// SPDX-License-Identifier: GPL-3.0-or-later
#include "thalweg/study/simulate.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "study/forcing.hpp"
#include "study/model.hpp"
#include "study/noting.hpp"
#include "study/report_json.hpp"
#include "study/simulation_outputs.hpp"
#include "study/snapshots.hpp"
#include "study/stopwatch.hpp"
#include "study/terrain_files.hpp"
#include "thalweg/core/error.hpp"
#include "thalweg/evolve/simulate.hpp"
#include "thalweg/study/output_folder.hpp"
#include "thalweg/terrain/accumulate.hpp"

namespace thalweg::study {
namespace {

constexpr double nan = std::numeric_limits<double>::quiet_NaN();

/// Where a run writes, and where it saves itself (nowhere: null).
struct Places {
    std::filesystem::path results;
    CheckpointFolder* checkpoints;
};

/// The state to begin with: that of the stopped run if there is one to be resumed, else the domain's start.
Checkpoint beginning(const Experiment& e, Domain& domain, CheckpointFolder* checkpoints, const std::string& identity,
                     const Messages& messages) {
    std::optional<Checkpoint> saved = checkpoints != nullptr ? checkpoints->load(identity) : std::nullopt;
    if (!saved) {
        if (checkpoints != nullptr && checkpoints->resumes()) {
            messages.warning(fmt::format("no stopped run was found in '{}', so this one began at its beginning",
                                         checkpoints->path().string()));
        }
        return {evolve::initial_state(std::move(domain.start)), {}};
    }
    if (saved->state.steps > e.time.max_steps) {
        throw Error(fmt::format("the stopped run has taken {} steps already, more than time.max_steps = {}",
                                saved->state.steps, e.time.max_steps));
    }
    return std::move(*saved);
}

std::optional<Frames> frames_of(const Experiment& e, const Places& places, const evolve::SimulationState& state) {
    if (!e.output.snapshots_every) return std::nullopt;
    const bool kept = places.checkpoints != nullptr && (e.output.checkpoint_every || state.steps > 0);
    Frames frames(kept ? places.checkpoints->frames() : places.results / ".frames", state.steps);
    if (state.steps == 0) frames.keep(0, state.landscape);
    return frames;
}

Outcome outcome_of(const evolve::SimulationResult& r, const evolve::SimulationState& state,
                   std::vector<evolve::StepRecord> history) {
    Outcome o;
    o.steps = r.steps;
    o.time_yr = state.landscape.time_yr;
    o.converged = r.stop_reason == evolve::StopReason::converged;
    o.stop_reason = evolve::to_string(r.stop_reason);
    o.max_rate_m_per_yr = r.max_rate_m_per_yr;
    o.mean_rate_m_per_yr = r.mean_rate_m_per_yr;
    o.frozen_receivers = r.frozen_receivers;
    o.mass = r.mass;
    o.largest_sediment_iterations = r.largest_sediment_iterations;
    o.unconverged_sediment_steps = r.unconverged_sediment_steps;
    o.largest_hillslope_iterations = r.largest_hillslope_iterations;
    o.unconverged_hillslope_steps = r.unconverged_hillslope_steps;
    o.history = std::move(history);
    return o;
}

std::string in_words(const evolve::StepRecord& record) {
    return fmt::format("step {}: highest {:.1f} m, mean rate {:.3g} m/yr, {} lakes", record.step,
                       record.elevation_max_m, record.mean_rate_m_per_yr, record.lakes);
}

/// A history that the run does not live to see is most likely a mistake in its times.
void warn_of_unseen_changes(const evolve::Setting& setting, double end_yr, const Messages& messages) {
    const auto warn = [&](const char* key, const evolve::History& history) {
        const double last = evolve::last_change_yr(history);
        if (last <= end_yr) return;
        messages.warning(
            fmt::format("{} changes until the year {}, but the run ends in the year {}", key, last, end_yr));
    };
    warn("uplift.history", setting.uplift_factor);
    warn("base_level.history", setting.base_level_m);
}

template <class Topology>
void write_snapshots(const Frames& frames, const Topology& topology, const Domain& domain, const Experiment& e,
                     Index steps, const std::filesystem::path& results) {
    const auto raster_of = [&](const std::vector<double>& heights) {
        return elevation_raster(topology, domain, heights, e);
    };
    frames.write(steps, domain.start, raster_of, results / "snapshots");
    std::filesystem::remove_all(results / ".frames");
}

template <class Topology>
Outcome step_through_time(const Topology& topology, const evolve::Model& model, const Experiment& e, Domain& domain,
                          const Places& places, const Messages& messages) {
    const std::string identity = places.checkpoints != nullptr ? identity_of(e) : "";
    Checkpoint at = beginning(e, domain, places.checkpoints, identity, messages);
    std::optional<Frames> frames = frames_of(e, places, at.state);
    const auto observe = [&](const evolve::StepRecord& record, const evolve::SimulationState& state) {
        at.history.push_back(record);
        if (record.step % 50 == 0) messages.progress(in_words(record));
        if (frames && record.step % *e.output.snapshots_every == 0) frames->keep(record.step, state.landscape);
        const bool save = e.output.checkpoint_every && record.step % *e.output.checkpoint_every == 0;
        if (save) places.checkpoints->save(state, at.history, identity);
    };
    const evolve::TimeOptions time{e.time.step_yr, e.time.max_steps, e.time.convergence};
    const evolve::SimulationResult r = evolve::simulate(topology, model, domain.setting, time, at.state, observe);
    if (places.checkpoints != nullptr) places.checkpoints->set_at_rest(at.state.converged);
    if (e.output.checkpoint_every) places.checkpoints->save(at.state, at.history, identity);
    Outcome o = outcome_of(r, at.state, std::move(at.history));
    domain.start = std::move(at.state.landscape);
    warn_of_unseen_changes(domain.setting, o.time_yr, messages);
    if (frames) write_snapshots(*frames, topology, domain, e, o.steps, places.results);
    return o;
}

template <class Topology>
Outcome solve_directly(const Topology& topology, const evolve::River& river, const Experiment& e, Domain& domain) {
    const evolve::SteadyResult r =
        evolve::solve_steady(topology, river, domain.setting, e.time.max_steps, domain.start);
    Outcome o;
    o.steps = r.sweeps;
    o.converged = r.converged;
    o.stop_reason = r.converged ? "receivers no longer change" : "all sweeps used";
    o.frozen_receivers = r.frozen_receivers;
    return o;
}

/// Rain-weighted area of the trees of single flow.
std::vector<double> rain_along(const RoutedTerrain& terrain, const evolve::Setting& setting) {
    std::vector<double> rain = terrain.cell_area_m2.list();
    for (std::size_t node = 0; node < rain.size(); ++node) rain[node] *= setting.rainfall[node];
    return terrain::accumulate(terrain.graph, rain);
}

/// Area and slope of the nodes that the talus limit leaves to the river.
std::vector<channel::SlopeAreaPoint> river_slopes(const Finished& f) {
    std::vector<channel::SlopeAreaPoint> points;
    for (std::size_t node = 0; node < f.law_slope.size(); ++node) {
        const bool falls = f.law_slope[node] > 0 && f.law_area_m2[node] > 0;
        if (falls && !f.talus_limited[node]) points.push_back({f.law_area_m2[node], f.law_slope[node]});
    }
    return points;
}

template <class Topology>
Finished finish(const Topology& topology, const evolve::Model& model, const Domain& domain, const Experiment& e) {
    Finished f;
    const evolve::River& river = model.river;
    const evolve::Drainage drainage = evolve::drain(topology, domain.start, domain.setting, river);
    f.lakes = drainage.lakes;
    f.talus_limited = evolve::at_talus_limit(topology, drainage, river, domain.start);
    f.terrain.graph = terrain::flow_graph(topology, domain.start.elevation_m, drainage.directions);
    f.terrain.elevation_m = domain.start.elevation_m;
    f.terrain.cell_area_m2 = terrain::cell_areas(topology);
    f.law_area_m2 = drainage.area_m2;
    f.law_slope = evolve::slopes_along_flow(topology, drainage, river, domain.start);
    f.terrain.drainage_area_m2 = drainage.area_m2;
    if (river.flow == evolve::Flow::multiple) {
        f.terrain.divided_area_m2 = drainage.area_m2;
        f.terrain.drainage_area_m2 = rain_along(f.terrain, domain.setting);
    }
    f.terrain.complete.assign(topology.size(), 1);
    f.terrain.offset_m = channel::offsets(topology);
    f.river_slopes = river_slopes(f);
    MeasureOptions options;
    options.channel_area_m2 = e.study.channel_area_m2;
    f.statistics = measure(f.terrain, f.terrain.elevation_m, options, f.river_slopes,
                           measure_chi(f.terrain, options, channel_threshold(f.terrain, options), 0));
    return f;
}

Json mass_json(const Outcome& o, std::vector<std::string>& notes) {
    if (!o.mass) {
        notes.push_back("mass_balance: the steady solver takes no steps through time, so nothing is moved");
        Json empty;
        for (const char* key : {"uplifted_m3", "eroded_m3", "talus_m3", "diffused_m3", "deposited_m3", "exported_m3",
                                "stored_m3", "relative_residual"}) {
            empty[key] = nullptr;
        }
        return empty;
    }
    const evolve::MassBalance& m = *o.mass;
    return {{"uplifted_m3", m.uplifted_m3},   {"eroded_m3", m.eroded_m3},
            {"talus_m3", m.talus_m3},         {"diffused_m3", m.diffused_m3},
            {"deposited_m3", m.deposited_m3}, {"exported_m3", m.exported_m3},
            {"stored_m3", m.stored_m3},       {"relative_residual", number(m.relative_residual())}};
}

TerrainInput input_of(const Domain& domain, const Finished& f) {
    TerrainInput input;
    input.geographic = domain.placement.geographic;
    input.valid_cells = static_cast<Index>(f.terrain.graph.order.size());
    input.nodata_cells = f.terrain.graph.size() - input.valid_cells;
    for (const Index node : f.terrain.graph.order) input.area_m2 += f.terrain.cell_area_m2[node];
    if (const Grid* grid = std::get_if<Grid>(&domain.topology)) {
        input.rows = grid->rows;
        input.cols = grid->cols;
        input.dx_m = mean(grid->east_west);
        input.dy_m = mean(grid->north_south);
    }
    return input;
}

Json summary_json(const Domain& domain, const Outcome& o, const Finished& f, const PositionOf& position) {
    std::vector<std::string> notes = domain.warnings;
    const TerrainInput input = input_of(domain, f);
    if (input.rows == 0) notes.push_back("input: a triangulated mesh has no rows, columns or cell size");
    notes.push_back("input: a simulated terrain is no file and has no checksum");
    notes.push_back("conditioning: a simulated terrain drains over its passes as it is");
    if (!o.converged) notes.push_back("converged: the steps were used up before the landscape was steady");
    if (o.unconverged_sediment_steps > 0) {
        notes.push_back(fmt::format("deposition: {} steps used up their iterations", o.unconverged_sediment_steps));
    }
    if (o.unconverged_hillslope_steps > 0) {
        notes.push_back(
            fmt::format("hillslope: {} steps of creep used up their iterations", o.unconverged_hillslope_steps));
    }
    if (std::isnan(o.time_yr)) notes.push_back("time_yr and rates: undefined for the steady solver");
    Json summary{{"nodes", input.valid_cells},
                 {"steps", o.steps},
                 {"time_yr", number(o.time_yr)},
                 {"converged", o.converged},
                 {"stop_reason", o.stop_reason},
                 {"max_rate_m_per_yr", number(o.max_rate_m_per_yr)},
                 {"mean_rate_m_per_yr", number(o.mean_rate_m_per_yr)},
                 {"frozen_receivers", o.frozen_receivers},
                 {"largest_sediment_iterations", o.largest_sediment_iterations},
                 {"largest_hillslope_iterations", o.largest_hillslope_iterations},
                 {"domain_area_m2", domain.area_m2},
                 {"cell_area_sum_m2", input.area_m2},
                 {"elevation_max_m", number(f.statistics.hypsometry.maximum_m)},
                 {"elevation_mean_m", number(f.statistics.hypsometry.mean_m)},
                 {"lakes_final", f.lakes},
                 {"mass_balance", mass_json(o, notes)}};
    summary["terrain"] = terrain_json(input, f.statistics, position, nullptr, notes);
    summary["terrain"]["measured_on"] = "mesh";
    summary["terrain"]["routing"] = f.terrain.divided_area_m2.empty() ? "single" : "multiple";
    summary["notes"] = notes;
    return summary;
}

/// Cells without data and those outside of an outline are not simulated.
Index simulated_nodes(const Domain& domain) {
    return static_cast<Index>(std::ranges::count_if(domain.start.elevation_m, [](double z) { return !std::isnan(z); }));
}

template <class Topology>
std::string run(const Topology& topology, const Experiment& e, Domain& domain, double mesh_seconds,
                const Places& places, const Messages& messages) {
    const std::filesystem::path& folder = places.results;
    const evolve::Model model = model_of(e);
    messages.progress(fmt::format("simulating {} nodes", simulated_nodes(domain)));
    const Stopwatch simulating;
    std::vector<std::string> warnings;
    const Outcome outcome = e.time.solver == Solver::steady
                                ? solve_directly(topology, model.river, e, domain)
                                : step_through_time(topology, model, e, domain, places, noting(messages, warnings));
    const double simulate_seconds = simulating.seconds();

    messages.progress("measuring and writing");
    const Stopwatch writing;
    Finished finished = finish(topology, model, domain, e);
    const Heightfield h = heightfield(topology, domain, finished, e);
    const auto basins = static_cast<Index>(finished.statistics.basins.size());
    add_perimeters(terrain::basin_perimeters(h.elevation.grid, h.basin_of, basins), finished.statistics);
    const PositionOf position = map_positions(domain);
    write_results(h, finished, outcome, position, e, folder);
    const Json terrain_files = write_terrain_files(topology, domain, h, finished, e, folder);
    write_text(folder / "experiment.toml", to_toml(e));
    Json summary = summary_json(domain, outcome, finished, position);
    for (const std::string& warning : warnings) summary["notes"].push_back(warning);
    summary.update(terrain_files);
    if (!outcome.converged && e.time.convergence > 0) {
        messages.warning(fmt::format("not steady after {} steps: a fit of k and m to this landscape assumes that it is",
                                     outcome.steps));
    }
    const double output_seconds = writing.seconds();
    summary["seconds"] = {{"mesh", mesh_seconds},
                          {"simulate", simulate_seconds},
                          {"output", output_seconds},
                          {"total", mesh_seconds + simulate_seconds + output_seconds}};
    summary["seconds_per_node_step"] = simulate_seconds / (static_cast<double>(finished.terrain.graph.order.size()) *
                                                           std::max<Index>(1, outcome.steps));
    std::string text = text_of(summary);
    write_text(folder / "summary.json", text);
    return text;
}

void check_saving(const Experiment& e, const Places& places) {
    if (e.output.checkpoint_every && places.checkpoints == nullptr) {
        throw Error(
            "output.checkpoint_every is for thalweg simulate alone: what goes on with --resume is one simulation");
    }
    const bool saves = e.output.checkpoint_every || e.output.snapshots_every;
    const bool resumes = places.checkpoints != nullptr && places.checkpoints->resumes();
    if (e.time.solver == Solver::steady && (saves || resumes)) {
        throw Error(
            "time.solver = \"steady\" takes no steps through time: checkpoints, snapshots and --resume need "
            "\"implicit\"");
    }
}

template <class MakeDomain>
std::string simulate_on(const Experiment& e, const Places& places, const Messages& messages, MakeDomain make) {
    model_of(e);
    check_terrain_files(e);
    check_saving(e, places);
    const Forcing forcing = read_forcing(e);
    messages.progress("making the mesh");
    const Stopwatch meshing;
    Domain domain = make(with_forced_rate(e, forcing));
    drive_in_time(domain, e, forcing);
    const double mesh_seconds = meshing.seconds();
    // The topology is moved out, so that the solver can change the rest of the domain beside it.
    const auto topology = std::move(domain.topology);
    domain.topology = std::holds_alternative<Grid>(topology) ? std::variant<Grid, Mesh>(std::get<Grid>(topology))
                                                             : std::variant<Grid, Mesh>(Mesh{});
    return std::visit(
        [&](const auto& t) {
            check_heightfield(t, domain, e);
            return run(t, e, domain, mesh_seconds, places, messages);
        },
        topology);
}

}  // namespace

std::string simulate(const Experiment& e, const std::filesystem::path& folder, const Messages& messages,
                     CheckpointFolder* checkpoints) {
    return simulate_on(e, {folder, checkpoints}, messages,
                       [&](const Experiment& forced) { return make_domain(forced, messages); });
}

std::string simulate(const Experiment& e, const Catchment& catchment, const std::filesystem::path& folder,
                     const Messages& messages) {
    return simulate_on(e, {folder, nullptr}, messages,
                       [&](const Experiment& forced) { return make_domain(forced, catchment); });
}

}  // namespace thalweg::study
