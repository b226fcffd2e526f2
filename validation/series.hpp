// SPDX-License-Identifier: GPL-3.0-or-later
// What a case measured, for its figure: written as NAME.csv into the folder that THALWEG_VALIDATION_OUT names, if it
// does; `figures.py` draws them.
#pragma once

#include <cstdlib>
#include <filesystem>

#include "thalweg/io/table_file.hpp"

namespace thalweg::validation {

inline void write_series(const std::string& name, std::vector<Column> columns) {
    const char* folder = std::getenv("THALWEG_VALIDATION_OUT");
    if (folder == nullptr) return;
    std::filesystem::create_directories(folder);
    io::write_csv(std::filesystem::path(folder) / (name + ".csv"), {.name = name, .columns = std::move(columns)});
}

}  // namespace thalweg::validation
