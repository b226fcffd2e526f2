// SPDX-License-Identifier: GPL-3.0-or-later
#include "thalweg/study/output_file.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include "thalweg/core/error.hpp"

namespace thalweg::study {
namespace fs = std::filesystem;

OutputFile::OutputFile(fs::path path, IfPresent if_present) : path_(std::move(path)), if_present_(if_present) {
    if (!path_.has_filename()) throw Error("no file to write: give --out FILE");
    partial_ = path_.parent_path() / fmt::format(".{}.partial-{}", path_.filename().string(), ::getpid());
    check();
}

void OutputFile::check() const {
    std::error_code ignored;
    const fs::file_status status = fs::symlink_status(path_, ignored);
    if (fs::exists(status) && if_present_ == IfPresent::refuse) {
        throw Error(fmt::format("'{}' exists already; name another file or use --force to replace it", path_.string()));
    }
    if (fs::exists(status) && !fs::is_regular_file(status)) {
        throw Error(fmt::format("'{}' is not a file, so it is not replaced; name another", path_.string()));
    }
    const fs::path folder = fs::absolute(path_).parent_path();
    if (!fs::is_directory(folder, ignored)) {
        throw Error(fmt::format("there is no folder '{}' to write into; make it first", folder.string()));
    }
    if (::access(folder.c_str(), W_OK | X_OK) != 0) {
        throw Error(fmt::format("no permission to write into '{}'", folder.string()));
    }
}

void OutputFile::write(const std::string& contents) {
    write_text(partial_, contents);
    check();
    std::error_code problem;
    fs::rename(partial_, path_, problem);
    if (problem) throw Error(fmt::format("cannot put '{}' in place: {}", path_.string(), problem.message()));
}

void OutputFile::discard() const {
    std::error_code ignored;
    fs::remove(partial_, ignored);
}

}  // namespace thalweg::study
