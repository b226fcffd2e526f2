// SPDX-License-Identifier: GPL-3.0-or-later
#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <unistd.h>

#include "thalweg/core/error.hpp"
#include "thalweg/study/checkpoint.hpp"
#include "thalweg/study/output_folder.hpp"

namespace thalweg::study {
namespace fs = std::filesystem;
namespace {

fs::path hidden_sibling(const fs::path& results) {
    const fs::path place = output_place(results);
    return place.parent_path() / fmt::format(".{}.checkpoint", place.filename().string());
}

}  // namespace

CheckpointFolder::CheckpointFolder(const fs::path& results, StoppedRun mode)
    : folder_(hidden_sibling(results)), mode_(mode) {
    std::error_code ignored;  // what cannot be seen cannot be written either, and is told then
    if (!fs::is_directory(folder_, ignored)) return;
    lock();
    if (!fs::exists(state_file(), ignored)) return;
    if (mode == StoppedRun::refuse) {
        throw Error(
            fmt::format("a stopped run of '{}' can go on (its state is in '{}'): give --resume, or --force to "
                        "forget it and start anew",
                        results.string(), folder_.string()));
    }
    to_be_forgotten_ = mode == StoppedRun::forget;
}

CheckpointFolder::LockFile::~LockFile() {
    if (number >= 0) ::close(number);
}

CheckpointFolder::~CheckpointFolder() { left_behind(); }

void CheckpointFolder::lock() {
    const fs::path file = folder_ / "lock";
    const int number = ::open(file.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0666);
    if (number < 0) throw Error(fmt::format("cannot write into '{}'", folder_.string()));
    if (::flock(number, LOCK_EX | LOCK_NB) == 0) {
        lock_.number = number;
        return;
    }
    ::close(number);
    throw Error(fmt::format("another thalweg is at work on the run in '{}'", folder_.string()));
}

void CheckpointFolder::create() {
    if (lock_.number < 0) {
        std::error_code problem;
        fs::create_directory(folder_, problem);
        if (problem) throw Error(fmt::format("cannot write '{}': {}", folder_.string(), problem.message()));
        lock();
    }
    if (!to_be_forgotten_) return;
    fs::remove(state_file());
    fs::remove_all(folder_ / "frames");
    to_be_forgotten_ = false;
}

std::optional<Checkpoint> CheckpointFolder::load(const std::string& identity) {
    if (mode_ != StoppedRun::resume || !fs::exists(state_file())) return std::nullopt;
    return load_checkpoint(state_file(), identity);
}

void CheckpointFolder::save(const evolve::SimulationState& state, const std::vector<evolve::StepRecord>& history,
                            const std::string& identity) {
    create();
    save_checkpoint(state, history, identity, state_file());
}

fs::path CheckpointFolder::frames() {
    create();
    fs::create_directory(folder_ / "frames");
    return folder_ / "frames";
}

void CheckpointFolder::results_are_written() {
    to_be_forgotten_ = false;
    if (at_rest_ && lock_.number >= 0) fs::remove(state_file());
}

std::string CheckpointFolder::left_behind() {
    std::error_code ignored;
    if (lock_.number < 0 || to_be_forgotten_) return "";
    if (fs::exists(state_file(), ignored)) return "; --resume goes on from the last checkpoint";
    fs::remove_all(folder_, ignored);
    return "";
}

}  // namespace thalweg::study
