// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include "study/report_json.hpp"
#include "thalweg/core/error.hpp"
#include "thalweg/study/analyze.hpp"

namespace thalweg::study {
namespace {

std::string text_at(const Json& json, const char* key) {
    const auto found = json.find(key);
    return found != json.end() && found->is_string() ? found->get<std::string>() : "";
}

}  // namespace

std::optional<Origin> origin_of(const std::filesystem::path& dem, const std::string& sha256,
                                std::vector<std::string>& warnings) {
    const std::filesystem::path file = dem.string() + ".json";
    std::error_code ignored;
    if (!std::filesystem::is_regular_file(file, ignored)) return std::nullopt;
    Json json;
    try {
        json = read_json(file);
    } catch (const Error&) {
        json = nullptr;
    }
    if (!json.is_object() || !json.contains("sha256")) return std::nullopt;  // somebody else's file
    if (text_at(json, "sha256") != sha256) {
        warnings.push_back(fmt::format("'{}' tells the origin of a file with another checksum, so it is not cited",
                                       file.filename().string()));
        return std::nullopt;
    }
    return Origin{.title = text_at(json, "data"),
                  .licence = text_at(json, "licence"),
                  .citation = text_at(json, "citation"),
                  .vertical = text_at(json, "vertical"),
                  .obtained_from = text_at(json, "obtained_from")};
}

}  // namespace thalweg::study
