// SPDX-License-Identifier: GPL-3.0-or-later
#include "thalweg/study/output_folder.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <signal.h>
#include <sys/file.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <charconv>
#include <fstream>
#include <set>
#include <sstream>

#include "thalweg/core/error.hpp"

namespace thalweg::study {
namespace fs = std::filesystem;
namespace {

fs::path hidden_neighbour(const fs::path& final, const char* what) {
    return final.parent_path() / fmt::format(".{}.{}-{}", final.filename().string(), what, ::getpid());
}

/// An open descriptor that holds a folder's lock; −1 if somebody else has it, or there is no such lock.
int locked(const fs::path& folder) {
    const int descriptor = ::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC | O_NOFOLLOW);
    if (descriptor < 0) return -1;
    if (::flock(descriptor, LOCK_EX | LOCK_NB) == 0) return descriptor;
    ::close(descriptor);
    return -1;
}

/// Names everything in a folder of results, so that it can be told later what is ours to delete.
constexpr const char* list_name = ".thalweg-files";

std::vector<std::string> files_below(const fs::path& folder) {
    std::vector<std::string> files;
    for (const auto& entry : fs::recursive_directory_iterator(folder)) {
        if (entry.is_symlink() || !entry.is_directory())
            files.push_back(entry.path().lexically_relative(folder).generic_string());
    }
    std::sort(files.begin(), files.end());
    return files;
}

/// The first file that is not in the folder's own list; "" if there is none.
std::string first_foreign_file(const fs::path& folder) {
    std::set<std::string> ours{list_name};
    std::ifstream list(folder / list_name);
    for (std::string line; std::getline(list, line);) ours.insert(line);
    for (const std::string& file : files_below(folder)) {
        if (!ours.contains(file)) return file;
    }
    return "";
}

fs::path final_place(const fs::path& given) {
    if (given.empty()) throw Error("no output folder: give --out DIR");
    const fs::path place = fs::absolute(given).lexically_normal();
    return place.has_filename() ? place : place.parent_path();
}

}  // namespace

OutputFolder::OutputFolder(fs::path final, IfPresent if_present)
    : given_(std::move(final)), final_(final_place(given_)), if_present_(if_present) {
    check();
    partial_ = hidden_neighbour(final_, "partial");
    make_partial();
}

void OutputFolder::make_partial() {
    for (fs::path parent = final_.parent_path(); !parent.empty() && !fs::exists(parent);
         parent = parent.parent_path()) {
        created_parents_.push_back(parent);
    }
    std::error_code problem;
    fs::create_directories(final_.parent_path(), problem);
    if (!problem && fs::is_directory(partial_)) {  // of a process that had this one's number
        const int left = locked(partial_);
        if (left < 0) {
            throw Error(fmt::format("another process is writing '{}' just now; wait for it or name another folder",
                                    given_.string()));
        }
        fs::remove_all(partial_, problem);
        ::close(left);
    }
    if (!problem) fs::create_directory(partial_, problem);
    if (problem) {
        discard();
        throw Error(fmt::format("cannot write into '{}': {}", final_.parent_path().string(), problem.message()));
    }
    lock_ = locked(partial_);  // where a file system knows no locks, the process' number alone tells that it lives
}

void OutputFolder::check() const {
    std::error_code ignored;
    const fs::file_status status = fs::symlink_status(final_, ignored);
    if (!fs::exists(status)) return;
    if (if_present_ == IfPresent::refuse) {
        throw Error(
            fmt::format("'{}' exists already; name another folder or use --force to replace it", given_.string()));
    }
    if (!fs::is_directory(status)) {
        throw Error(fmt::format("'{}' is not a folder, so it is not replaced; name another", given_.string()));
    }
    const std::string foreign = first_foreign_file(final_);
    if (foreign.empty()) return;
    throw Error(
        fmt::format("'{}' holds '{}', which thalweg did not write, so --force does not replace it; move it away or "
                    "name another folder",
                    given_.string(), foreign));
}

OutputFolder::~OutputFolder() {
    if (!committed_) discard();
    if (lock_ >= 0) ::close(lock_);
}

void OutputFolder::discard() {
    std::error_code ignored;
    // Another thread may be writing still: what it adds meanwhile goes too.
    for (int attempt = 0; attempt < 100 && fs::exists(partial_, ignored); ++attempt) fs::remove_all(partial_, ignored);
    for (const fs::path& parent : created_parents_) fs::remove(parent, ignored);
}

void OutputFolder::commit() {
    check();  // again: meanwhile somebody else may have made a folder there, or put files into it
    std::string list;
    for (const std::string& file : files_below(partial_)) list += file + '\n';
    write_text(partial_ / list_name, list);
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

std::vector<std::string> remove_abandoned(const fs::path& final) {
    std::vector<std::string> removed;
    const fs::path place = final_place(final);
    const std::string prefix = fmt::format(".{}.partial-", place.filename().string());
    std::error_code ignored;
    for (const auto& entry : fs::directory_iterator(place.parent_path(), ignored)) {
        const std::string name = entry.path().filename().string();
        if (!name.starts_with(prefix)) continue;
        const std::string number = name.substr(prefix.size());
        int process = 0;
        const auto [end, problem] = std::from_chars(number.data(), number.data() + number.size(), process);
        const bool ours = problem == std::errc() && end == number.data() + number.size() && process > 0;
        if (!ours || entry.is_symlink() || ::kill(process, 0) == 0 || errno != ESRCH) continue;
        const int lock = locked(entry.path());
        if (lock < 0) continue;  // of a living process on another machine or in another container
        std::error_code failed;
        fs::remove_all(entry.path(), failed);
        ::close(lock);
        if (!failed) removed.push_back(name);
    }
    std::sort(removed.begin(), removed.end());
    return removed;
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
