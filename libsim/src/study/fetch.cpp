// SPDX-License-Identifier: GPL-3.0-or-later
#include "thalweg/study/fetch.hpp"

#include <fmt/format.h>

#include <cctype>
#include <string_view>

#include "thalweg/core/error.hpp"
#include "thalweg/study/script.hpp"

namespace thalweg::study {
namespace {

constexpr int server_failed = 3;

std::filesystem::path fetcher() { return script("fetch/thalweg_fetch.py", ""); }

/// "opentopography:NASADEM" as a file name; addresses and paths behind the colon are left out.
std::string file_name(const std::string& source) {
    const std::size_t colon = source.find(':');
    std::string name = source.substr(0, colon);
    if (name == "opentopography" && colon != std::string::npos) name.append("-").append(source, colon + 1);
    for (char& c : name) {
        if (std::isalnum(static_cast<unsigned char>(c)) == 0 && c != '-') c = '_';
    }
    return name + ".tif";
}

/// What the fetcher said, without the words that our own main puts before it.
std::string sentence_of(const ScriptResult& result) {
    constexpr std::string_view prefix = "thalweg: error: ";
    if (result.said.starts_with(prefix)) return result.said.substr(prefix.size());
    return result.said.empty() ? "python ended abnormally" : result.said;
}

}  // namespace

void become_fetcher(const std::vector<std::string>& words) {
    become_script(fetcher(), words);
    throw Error(
        "fetching needs Python with GDAL (Debian: python3-gdal) at /usr/bin/python3 or where THALWEG_PYTHON says");
}

std::filesystem::path fetch_dem(const std::string& source, const std::array<double, 4>& box_deg,
                                const std::filesystem::path& folder) {
    const std::filesystem::path file = folder / file_name(source);
    const ScriptResult result = run_script(fetcher(), {source, fmt::format("--bbox={}", fmt::join(box_deg, ",")),
                                                       "--out", file.string(), "--quiet", "--end-with-parent"});
    if (result.exit_code == 0) return file;
    if (result.exit_code == server_failed) throw RemoteError(sentence_of(result));
    throw Error(sentence_of(result));
}

}  // namespace thalweg::study
