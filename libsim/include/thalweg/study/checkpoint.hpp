// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <atomic>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "thalweg/evolve/simulate.hpp"
#include "thalweg/study/parameters.hpp"

namespace thalweg::study {

/// All that a stopped simulation needs to go on.
struct Checkpoint {
    evolve::SimulationState state;
    std::vector<evolve::StepRecord> history;  ///< of the steps so far
};

/// What must be the same when a run goes on: every value of the experiment but time.max_steps and
/// output.checkpoint_every, and the contents of every file it names; one line each.
std::string identity_of(const Experiment&);

/// Writes a checkpoint to a file that is there whole or not at all. Throws Error when it cannot be written.
void save_checkpoint(const evolve::SimulationState&, const std::vector<evolve::StepRecord>& history,
                     const std::string& identity, const std::filesystem::path&);

/// Reads it. Throws Error, one sentence, for a damaged file, one of another version of thalweg, and one of another
/// experiment (naming the first value that differs).
Checkpoint load_checkpoint(const std::filesystem::path&, const std::string& identity);

/// A landscape, saved and read like a checkpoint.
void save_frame(const evolve::Landscape&, const std::filesystem::path&);
evolve::Landscape load_frame(const std::filesystem::path&);

enum class StoppedRun { refuse, forget, resume };

/// The hidden folder .NAME.checkpoint beside the folder of results NAME, in which a run saves itself. It comes into
/// being with the first thing that is saved and is locked by the process that uses it (the lock ends with the process,
/// however it ends). It stays after a run that used up its steps, which can go on with more of them, and goes after one
/// that came to rest.
class CheckpointFolder {
  public:
    /// Throws Error if a stopped run is there that is neither to be resumed nor forgotten, or another process uses it.
    CheckpointFolder(const std::filesystem::path& results, StoppedRun);
    ~CheckpointFolder();
    CheckpointFolder(const CheckpointFolder&) = delete;
    CheckpointFolder& operator=(const CheckpointFolder&) = delete;

    /// Whether it was asked to go on, be there something to go on from or not.
    bool resumes() const { return mode_ == StoppedRun::resume; }

    /// What is to be resumed, if it was asked for and is there.
    std::optional<Checkpoint> load(const std::string& identity);

    void save(const evolve::SimulationState&, const std::vector<evolve::StepRecord>& history,
              const std::string& identity);

    /// Where snapshots of a run that saves itself are kept until its end.
    std::filesystem::path frames();

    /// The results are in place: what is no longer needed goes.
    void results_are_written();
    void set_at_rest(bool at_rest) { at_rest_ = at_rest; }

    /// For a program that is being stopped, from any thread: removes what nothing could be resumed from, and says how
    /// the run can go on ("" if it cannot).
    std::string left_behind();

    const std::filesystem::path& path() const { return folder_; }

  private:
    std::filesystem::path state_file() const { return folder_ / "state"; }
    void create();
    void lock();

    std::filesystem::path folder_;
    StoppedRun mode_;
    /// The kernel lets go of it when the file is closed, however that comes about.
    struct LockFile {
        int number = -1;
        ~LockFile();
    } lock_;
    bool at_rest_ = false;
    std::atomic<bool> to_be_forgotten_ =
        false;  ///< a stopped run is there, and goes as soon as this one has something to save
};

}  // namespace thalweg::study
