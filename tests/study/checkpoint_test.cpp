// SPDX-License-Identifier: GPL-3.0-or-later
#include <catch2/catch.hpp>

#include <fstream>
#include <set>

#include "support/temp_folder.hpp"
#include "thalweg/core/error.hpp"
#include "thalweg/study/checkpoint.hpp"
#include "thalweg/study/manifest.hpp"
#include "thalweg/study/output_folder.hpp"
#include "thalweg/study/simulate.hpp"

using namespace thalweg;
using namespace thalweg::study;
using test::error_of;
using test::TempFolder;
namespace fs = std::filesystem;

namespace {

Experiment island(MeshKind mesh) {
    Experiment e;
    e.domain.size_m = {4000, 3000};
    e.domain.nodes = 400;
    e.domain.mesh = mesh;
    e.uplift.rate_m_per_yr = 5e-4;
    e.river.k = 2e-5;
    e.river.m = 0.45;
    e.river.n = 1.3;
    e.hillslope.talus_angle_deg = 25;
    e.time.step_yr = 5e4;
    e.time.max_steps = 60;
    e.time.convergence = 1e-9;
    return e;
}

/// Runs into `folder` as the command does, but for its renaming.
void run(const Experiment& e, const fs::path& folder, StoppedRun mode, std::vector<std::string>* warnings = nullptr) {
    fs::create_directories(folder);
    CheckpointFolder checkpoints(folder, mode);
    const Messages messages{.progress = [](const std::string&) {},
                            .warning =
                                [&](const std::string& text) {
                                    if (warnings) warnings->push_back(text);
                                }};
    simulate(e, folder, messages, &checkpoints);
    checkpoints.results_are_written();
}

/// SHA-256 of every file but those that hold seconds, by relative path.
std::vector<std::string> fingerprints(const fs::path& folder) {
    std::set<std::string> found;
    for (const auto& entry : fs::recursive_directory_iterator(folder)) {
        const std::string name = fs::relative(entry.path(), folder).generic_string();
        const bool timed = name == "summary.json" || name == "history.csv" || name == "experiment.toml";
        if (entry.is_regular_file() && !timed) found.insert(name + " " + sha256_of(entry.path()));
    }
    return {found.begin(), found.end()};
}

evolve::SimulationState full_state() {
    evolve::SimulationState s = evolve::initial_state({.time_yr = 1.5, .elevation_m = {1, 2.25, -3}});
    s.steps = 7;
    s.converged = true;
    s.max_rate_m_per_yr = 0.1;
    s.mean_rate_m_per_yr = 0.01;
    s.largest_newton_iterations = 5;
    s.mass = {.uplifted_m3 = 1, .eroded_m3 = 2, .talus_m3 = 3, .exported_m3 = 4, .stored_m3 = 5};
    s.calm = true;
    s.exchange.step = 9;
    s.exchange.last_new_change = 8;
    s.exchange.last_any_change = 6;
    s.exchange.last_change = {3, 0, 1};
    s.exchange.before = {1, 2, no_flow};
    s.exchange.frozen = {no_flow, 2, no_flow};
    s.slackening = {.lowest_m3 = 12.5, .steps = 4};
    return s;
}

}  // namespace

TEST_CASE("A checkpoint gives back every bit of the state and the history") {
    const TempFolder temp;
    const evolve::SimulationState s = full_state();
    const std::vector<evolve::StepRecord> history{{1, 1e3, 4, 10, 5, 0.1, 0.05, 0.2},
                                                  {2, 2e3, 3, 11, 6, 0.1, 0.04, 0.3}};
    save_checkpoint(s, history, "identity", temp / "state");
    const Checkpoint back = load_checkpoint(temp / "state", "identity");
    const evolve::SimulationState& b = back.state;
    CHECK(b.landscape.time_yr == s.landscape.time_yr);
    CHECK(b.landscape.elevation_m == s.landscape.elevation_m);
    CHECK(b.steps == s.steps);
    CHECK(b.converged == s.converged);
    CHECK(b.calm == s.calm);
    CHECK(b.max_rate_m_per_yr == s.max_rate_m_per_yr);
    CHECK(b.mean_rate_m_per_yr == s.mean_rate_m_per_yr);
    CHECK(b.largest_newton_iterations == s.largest_newton_iterations);
    CHECK(b.mass.uplifted_m3 == 1);
    CHECK(b.mass.stored_m3 == 5);
    CHECK(b.exchange.patience == s.exchange.patience);
    CHECK(b.exchange.last_change == s.exchange.last_change);
    CHECK(b.exchange.before == s.exchange.before);
    CHECK(b.exchange.frozen == s.exchange.frozen);
    CHECK(b.slackening.lowest_m3 == s.slackening.lowest_m3);
    REQUIRE(back.history.size() == 2);
    CHECK(back.history[1].elevation_mean_m == 6);
    CHECK(back.history[1].seconds == 0.3);
    CHECK_FALSE(fs::exists(temp / "state.new"));
}

TEST_CASE("A checkpoint that is damaged in any byte, cut short, empty or of something else is refused") {
    const TempFolder temp;
    save_checkpoint(full_state(), {}, "identity", temp / "state");
    const std::string whole = read_text(temp / "state");
    for (std::size_t at = 0; at < whole.size(); at += 1 + whole.size() / 50) {
        std::string bent = whole;
        bent[at] ^= 4;
        write_text(temp / "bent", bent);
        CHECK(error_of([&] { load_checkpoint(temp / "bent", "identity"); }).find("damaged") != std::string::npos);
        write_text(temp / "cut", whole.substr(0, at));
        CHECK(error_of([&] { load_checkpoint(temp / "cut", "identity"); }).find("damaged") != std::string::npos);
    }
    CHECK(error_of([&] { load_checkpoint(temp / "none", "identity"); }).find("damaged") != std::string::npos);
    save_frame({.time_yr = 0, .elevation_m = {1, 2}}, temp / "frame");
    CHECK(error_of([&] { load_checkpoint(temp / "frame", "identity"); }).find("version") != std::string::npos);
    CHECK(error_of([&] { load_checkpoint(temp / "state", "other"); }).find("another experiment") != std::string::npos);
}

TEST_CASE("What a stopped run must share with its continuation is every value and every named file, not the steps") {
    const TempFolder temp;
    write_text(temp / "uplift.csv", "time_yr,factor\n0,1\n");
    Experiment e = island(MeshKind::tin);
    e.uplift.history = temp / "uplift.csv";
    const std::string identity = identity_of(e);
    Experiment longer = e;
    longer.time.max_steps = 1000;
    longer.output.checkpoint_every = 3;
    CHECK(identity_of(longer) == identity);
    Experiment other = e;
    other.river.k = 2.1e-5;
    CHECK(identity_of(other) != identity);
    save_checkpoint(full_state(), {}, identity, temp / "state");
    const std::string refusal = error_of([&] { load_checkpoint(temp / "state", identity_of(other)); });
    CHECK(refusal.find("[river] k = 2e-05 is now k = 2.1e-05") != std::string::npos);
    CHECK(refusal.find('\n') == std::string::npos);
    write_text(temp / "uplift.csv", "time_yr,factor\n0,2\n");
    CHECK(identity_of(e) != identity);
    CHECK(error_of([&] { load_checkpoint(temp / "state", identity_of(e)); }).find("uplift.history") !=
          std::string::npos);
}

TEST_CASE("A stopped run also shares every file of a list, and what stands beside a file to give it its place") {
    const TempFolder temp;
    for (const char* name :
         {"rivers.geojson", "ridges.shp", "ridges.prj", "rain.png", "rain.png.aux.xml", "rain.pgw"}) {
        write_text(temp / name, "as it was");
    }
    Experiment e = island(MeshKind::tin);
    e.uplift.lines = {temp / "rivers.geojson", temp / "ridges.shp"};
    e.rainfall.field = temp / "rain.png";
    const std::string identity = identity_of(e);
    write_text(temp / "rain.txt", "a note about it");
    CHECK(identity_of(e) == identity);
    for (const char* name :
         {"rivers.geojson", "ridges.shp", "ridges.prj", "rain.png", "rain.png.aux.xml", "rain.pgw"}) {
        INFO(name);
        write_text(temp / name, "changed");
        CHECK(identity_of(e) != identity);
        write_text(temp / name, "as it was");
        CHECK(identity_of(e) == identity);
    }
}

TEST_CASE("How often a run saves itself, and whether it does, changes no result") {
    for (const MeshKind mesh : {MeshKind::tin, MeshKind::raster}) {
        const TempFolder temp;
        Experiment e = island(mesh);
        run(e, temp / "never", StoppedRun::refuse);
        for (const Index every : {1u, 7u, 1000u}) {
            e.output.checkpoint_every = every;
            const fs::path folder = temp / ("every-" + std::to_string(every));
            run(e, folder, StoppedRun::refuse);
            CHECK(fingerprints(folder) == fingerprints(temp / "never"));
        }
        CHECK_FALSE(fs::exists(temp / ".never.checkpoint"));
        CHECK(fs::exists(temp / ".every-7.checkpoint/state"));  // used up its steps, so it can go on with more
    }
}

TEST_CASE("A run given more steps goes on to the bytes of one that had them from the start, snapshots and all") {
    for (const MeshKind mesh : {MeshKind::tin, MeshKind::raster}) {
        const TempFolder temp;
        Experiment e = island(mesh);
        e.output.snapshots_every = 8;
        run(e, temp / "whole", StoppedRun::refuse);
        e.output.checkpoint_every = 5;
        for (const Index steps : {13u, 16u, 41u, 60u}) {
            e.time.max_steps = steps;
            fs::remove_all(temp / "parts");
            run(e, temp / "parts", StoppedRun::resume);
        }
        CHECK(fingerprints(temp / "parts") == fingerprints(temp / "whole"));
        CHECK(fs::exists(temp / "parts/snapshots/step-000060.png"));
        CHECK_FALSE(fs::exists(temp / "parts/snapshots/step-000041.png"));
        e.time.max_steps = 50;
        CHECK(error_of([&] { run(e, temp / "parts", StoppedRun::resume); }).find("60 steps already") !=
              std::string::npos);
    }
}

TEST_CASE("A run that came to rest leaves nothing to resume") {
    const TempFolder temp;
    Experiment e = island(MeshKind::raster);
    e.time.convergence = 0.01;
    e.time.max_steps = 5000;
    e.output.checkpoint_every = 10;
    run(e, temp / "out", StoppedRun::refuse);
    CHECK_FALSE(fs::exists(temp / ".out.checkpoint"));
}

TEST_CASE("A stopped run is resumed or forgotten, but never overwritten unasked") {
    const TempFolder temp;
    Experiment e = island(MeshKind::raster);
    e.output.checkpoint_every = 10;
    run(e, temp / "out", StoppedRun::refuse);
    CHECK(error_of([&] { run(e, temp / "out", StoppedRun::refuse); }).find("--resume") != std::string::npos);
    e.river.k = 1e-5;
    CHECK(error_of([&] { run(e, temp / "out", StoppedRun::resume); }).find("another experiment") != std::string::npos);
    CHECK(fs::exists(temp / ".out.checkpoint/state"));
    run(e, temp / "out", StoppedRun::forget);
    run(e, temp / "out", StoppedRun::resume);  // of the new experiment

    std::vector<std::string> warnings;
    run(e, temp / "fresh", StoppedRun::resume, &warnings);
    REQUIRE_FALSE(warnings.empty());
    CHECK(warnings.front().find("began at its beginning") != std::string::npos);
}

TEST_CASE("Two runs cannot save themselves in one place") {
    const TempFolder temp;
    CheckpointFolder first(temp / "out", StoppedRun::refuse);
    first.save(full_state(), {}, "x");
    CHECK(error_of([&] { CheckpointFolder second(temp / "out", StoppedRun::resume); }).find("another thalweg") !=
          std::string::npos);
}

TEST_CASE("A place that was only begun is tidied away") {
    const TempFolder temp;
    {
        CheckpointFolder folder(temp / "out", StoppedRun::refuse);
        save_frame({.time_yr = 0, .elevation_m = {1}}, folder.frames() / "0000000000");
        CHECK(fs::exists(temp / ".out.checkpoint"));
    }
    CHECK_FALSE(fs::exists(temp / ".out.checkpoint"));
}

TEST_CASE("The steady solver and a study refuse to save themselves") {
    const TempFolder temp;
    Experiment e = island(MeshKind::raster);
    e.time.solver = Solver::steady;
    e.output.checkpoint_every = 10;
    CHECK(error_of([&] { run(e, temp / "a", StoppedRun::refuse); }).find("steady") != std::string::npos);
    e.output.checkpoint_every.reset();
    e.output.snapshots_every = 10;
    CHECK(error_of([&] { run(e, temp / "b", StoppedRun::refuse); }).find("steady") != std::string::npos);
    e.time.solver = Solver::implicit;
    e.output.checkpoint_every = 10;
    CHECK(error_of([&] { simulate(e, temp / "c", {}); }).find("thalweg simulate alone") != std::string::npos);
}
