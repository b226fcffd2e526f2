// SPDX-License-Identifier: GPL-3.0-or-later
#include "thalweg/study/output_folder.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <fstream>
#include <sstream>

#include "thalweg/core/error.hpp"

namespace thalweg::study {
namespace fs = std::filesystem;
namespace {

fs::path hidden_neighbour(const fs::path& final, const char* what) {
    return final.parent_path() / fmt::format(".{}.{}-{}", final.filename().string(), what, ::getpid());
}

/// A study's or a command's folder holds at least one of these; anything else is not ours to delete.
bool holds_our_results(const fs::path& folder) {
    if (fs::is_empty(folder)) return true;
    for (const char* name : {"summary.json", "fit.json", "comparison.json", "manifest.json"}) {
        if (fs::is_regular_file(folder / name)) return true;
    }
    return false;
}

}  // namespace

OutputFolder::OutputFolder(fs::path final, IfPresent if_present) {
    if (final.empty()) throw Error("no output folder: give --out DIR");
    final_ = fs::absolute(final).lexically_normal();
    if (!final_.has_filename()) final_ = final_.parent_path();
    std::error_code problem;
    const fs::file_status status = fs::symlink_status(final_, problem);
    if (fs::exists(status) && if_present == IfPresent::refuse) {
        throw Error(
            fmt::format("'{}' exists already; name another folder or use --force to replace it", final.string()));
    }
    if (fs::exists(status) && !fs::is_directory(status)) {
        throw Error(fmt::format("'{}' is not a folder, so it is not replaced; name another", final.string()));
    }
    if (fs::exists(status) && !holds_our_results(final_)) {
        throw Error(fmt::format("'{}' holds no results of thalweg, so --force does not replace it", final.string()));
    }
    partial_ = hidden_neighbour(final_, "partial");
    for (fs::path parent = final_.parent_path(); !parent.empty() && !fs::exists(parent);
         parent = parent.parent_path()) {
        created_parents_.push_back(parent);
    }
    fs::create_directories(partial_, problem);
    if (problem) {
        discard();
        throw Error(fmt::format("cannot write into '{}': {}", final_.parent_path().string(), problem.message()));
    }
}

OutputFolder::~OutputFolder() {
    if (!committed_) discard();
}

void OutputFolder::discard() {
    std::error_code ignored;
    fs::remove_all(partial_, ignored);
    for (const fs::path& parent : created_parents_) fs::remove(parent, ignored);
}

void OutputFolder::commit() {
    // The old folder steps aside first: a folder that is not empty cannot be replaced in one rename.
    const fs::path aside = hidden_neighbour(final_, "replaced");
    std::error_code problem;
    const bool replaces = fs::exists(final_);
    if (replaces) fs::rename(final_, aside, problem);
    if (!problem) fs::rename(partial_, final_, problem);
    if (problem) {
        std::error_code ignored;
        if (replaces && !fs::exists(final_)) fs::rename(aside, final_, ignored);
        throw Error(fmt::format("cannot put '{}' in place: {}", final_.string(), problem.message()));
    }
    committed_ = true;
    fs::remove_all(aside, problem);
}

void write_text(const fs::path& path, const std::string& text) {
    std::ofstream file(path, std::ios::binary);
    file.write(text.data(), static_cast<std::streamsize>(text.size()));
    file.close();
    if (!file) throw Error(fmt::format("cannot write '{}': is the disk full?", path.filename().string()));
}

std::string read_text(const fs::path& path) {
    std::ifstream file(path, std::ios::binary);
    std::ostringstream text;
    text << file.rdbuf();
    if (!file || !fs::is_regular_file(path)) throw Error(fmt::format("cannot read '{}'", path.string()));
    return text.str();
}

}  // namespace thalweg::study
