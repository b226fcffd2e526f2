// SPDX-License-Identifier: GPL-3.0-or-later
#include "thalweg/study/output_folder.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <signal.h>
#include <sys/file.h>
#include <sys/stat.h>
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
    std::error_code problem;
    fs::recursive_directory_iterator entry(folder, problem);
    for (; !problem && entry != fs::recursive_directory_iterator(); entry.increment(problem)) {
        if (entry->is_symlink() || !entry->is_directory())
            files.push_back(entry->path().lexically_relative(folder).generic_string());
    }
    if (problem) throw Error(fmt::format("'{}' cannot be looked into: {}", folder.string(), problem.message()));
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

bool may_change(const fs::path& folder) { return ::eaccess(folder.c_str(), W_OK | X_OK) == 0; }

/// Whether the folder's own rules let us move and delete what it holds: in one like /tmp everybody only his own.
bool may_take_from(const fs::path& folder, const fs::path& entry) {
    struct stat parent {
    }, own{};
    if (::stat(folder.c_str(), &parent) != 0 || ::lstat(entry.c_str(), &own) != 0) return true;  // told elsewhere
    const uid_t we = ::geteuid();
    return (parent.st_mode & S_ISVTX) == 0 || we == 0 || we == parent.st_uid || we == own.st_uid;
}

/// The first folder, this one or one below, out of which we could not delete what it holds; "" if there is none.
fs::path first_kept_folder(const fs::path& folder) {
    if (!may_take_from(folder.parent_path(), folder)) return folder;
    if (!fs::is_empty(folder) && !may_change(folder)) return folder;
    for (const auto& entry : fs::recursive_directory_iterator(folder)) {
        if (entry.is_symlink() || !entry.is_directory() || fs::is_empty(entry.path())) continue;
        if (!may_change(entry.path())) return entry.path();
    }
    return {};
}

/// The innermost folder on the way to `path` that is there. Throws Error where that cannot be told.
fs::path nearest_folder(fs::path path) {
    std::error_code problem;
    while (!fs::exists(path, problem) && path.has_relative_path()) {
        if (problem) {
            throw Error(fmt::format("cannot write into '{}': {}", path.parent_path().string(), problem.message()));
        }
        path = path.parent_path();
    }
    return path;
}

}  // namespace

fs::path output_place(const fs::path& given) {
    if (given.empty()) throw Error("no output folder: give --out DIR");
    const fs::path place = fs::absolute(given).lexically_normal();
    const fs::path folder = place.has_filename() ? place : place.parent_path();
    if (!folder.has_filename()) {
        throw Error(fmt::format("'{}' is the root of all folders, which results cannot replace: name one below it",
                                given.string()));
    }
    return folder;
}

OutputFolder::OutputFolder(fs::path final, IfPresent if_present)
    : given_(std::move(final)), final_(output_place(given_)), if_present_(if_present) {
    check();
    partial_ = hidden_neighbour(final_, "partial");
    make_partial();
}

void OutputFolder::make_partial() {
    const fs::path there = nearest_folder(final_.parent_path());
    for (fs::path parent = final_.parent_path(); parent != there; parent = parent.parent_path()) {
        created_parents_.push_back(parent);
    }
    std::error_code problem, ignored;
    fs::create_directories(final_.parent_path(), problem);
    if (!problem && fs::is_directory(partial_, ignored)) {  // of a process that had this one's number
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
        throw Error(fmt::format("cannot write into '{}': {}", there.string(), problem.message()));
    }
    lock_ = locked(partial_);  // where a file system knows no locks, the process' number alone tells that it lives
}

void OutputFolder::check() const {
    std::error_code problem;
    const fs::file_status status = fs::symlink_status(final_, problem);
    if (!fs::exists(status)) return;  // what keeps us from seeing it, its parent's rights or its length, is told there
    if (if_present_ == IfPresent::refuse) {
        throw Error(
            fmt::format("'{}' exists already; name another folder or use --force to replace it", given_.string()));
    }
    if (!fs::is_directory(status)) {
        throw Error(fmt::format("'{}' is not a folder, so it is not replaced; name another", given_.string()));
    }
    const std::string foreign = first_foreign_file(final_);
    if (!foreign.empty()) {
        throw Error(
            fmt::format("'{}' holds '{}', which thalweg did not write, so --force does not replace it; move it away or "
                        "name another folder",
                        given_.string(), foreign));
    }
    const fs::path kept = first_kept_folder(final_);
    if (kept.empty()) return;
    throw Error(
        fmt::format("'{}' cannot be replaced: there is no permission to delete what '{}' holds; name another "
                    "folder",
                    given_.string(), kept.string()));
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
    const bool replaces = fs::exists(fs::symlink_status(final_, problem));
    problem.clear();
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
    const fs::path place = output_place(final);
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
