// SPDX-License-Identifier: GPL-3.0-or-later
#include "thalweg/study/figure.hpp"

#include <fmt/format.h>

#include "thalweg/core/error.hpp"
#include "thalweg/study/script.hpp"

namespace thalweg::study {

void draw_figures(const std::string& what, const std::filesystem::path& folder) {
    const auto file = script("figures/thalweg_figures.py", ", or use --no-figures");
    const ScriptResult result = run_script(file, {what, folder.string()});
    if (result.exit_code == 0) return;
    throw Error(
        fmt::format("the figures could not be drawn: {} (they need python3-matplotlib and python3-gdal; "
                    "--no-figures leaves them out)",
                    result.said.empty() ? "python ended abnormally" : result.said));
}

}  // namespace thalweg::study
