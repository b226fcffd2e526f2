// SPDX-License-Identifier: GPL-3.0-or-later
// What a case measured, for its figure: written as NAME.csv into the folder that THALWEG_VALIDATION_OUT names, if it
// does; `figures.py` draws them.
#pragma once

#include <cstdlib>
#include <filesystem>
#include <limits>

#include "thalweg/io/table_file.hpp"

namespace thalweg::validation {

/// Values by category, in the order in which the categories came: one column of dots each.
class Categories {
  public:
    Categories() = default;
    explicit Categories(std::vector<std::pair<std::string, std::vector<double>>> all) : all_(std::move(all)) {}

    void add(const std::string& category, double value) {
        for (auto& [name, values] : all_) {
            if (name == category) return values.push_back(value);
        }
        all_.push_back({category, {value}});
    }

    const std::vector<std::pair<std::string, std::vector<double>>>& all() const { return all_; }

  private:
    std::vector<std::pair<std::string, std::vector<double>>> all_;
};

inline void write_series(const std::string& name, std::vector<Column> columns) {
    const char* folder = std::getenv("THALWEG_VALIDATION_OUT");
    if (folder == nullptr) return;
    std::filesystem::create_directories(folder);
    io::write_csv(std::filesystem::path(folder) / (name + ".csv"), {.name = name, .columns = std::move(columns)});
}

/// Categories of different lengths are filled up with empty fields.
inline void write_series(const std::string& name, const Categories& categories) {
    std::size_t longest = 0;
    for (const auto& [_, values] : categories.all()) longest = std::max(longest, values.size());
    std::vector<Column> columns;
    for (const auto& [category, values] : categories.all()) {
        std::vector<double> filled = values;
        filled.resize(longest, std::numeric_limits<double>::quiet_NaN());
        columns.push_back({category, filled});
    }
    write_series(name, std::move(columns));
}

}  // namespace thalweg::validation
