// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <string>
#include <utility>
#include <vector>

namespace thalweg::study {

/// SHA-256 of a file's bytes in hexadecimal. Throws Error if it cannot be read.
std::string sha256_of(const std::filesystem::path&);

/// Version of thalweg, its commit, and those of the libraries it stands on.
struct Versions {
    std::string thalweg;
    std::string commit;  ///< "unknown" outside a repository
    std::vector<std::pair<std::string, std::string>> libraries;
};
Versions versions();

}  // namespace thalweg::study
