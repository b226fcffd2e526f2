// SPDX-License-Identifier: GPL-3.0-or-later
#include <iostream>

#include "command.hpp"
#include "thalweg/study/manifest.hpp"

namespace thalweg::tools {

void add_version(CLI::App& app) {
    CLI::App* command = app.add_subcommand("version", "Version of thalweg, its commit, and its libraries' versions");
    command->callback([] {
        const study::Versions v = study::versions();
        std::cout << "thalweg " << v.thalweg << " (commit " << v.commit << ")\n";
        for (const auto& [name, version] : v.libraries) std::cout << name << ' ' << version << '\n';
    });
}

}  // namespace thalweg::tools
