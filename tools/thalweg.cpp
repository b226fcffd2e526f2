// SPDX-License-Identifier: GPL-3.0-or-later
// The command line: a table of subcommands, and what becomes of errors.
#include <algorithm>
#include <exception>
#include <filesystem>
#include <iostream>
#include <new>
#include <string>

#include "command.hpp"
#include "interrupt.hpp"
#include "keep_freed_memory.hpp"
#include "thalweg/core/error.hpp"
#include "thalweg/study/manifest.hpp"

namespace {

constexpr int users_to_mend = 2;
constexpr int servers_to_mend = 3;
constexpr int ours_to_mend = 1;

/// One line, whatever the message holds.
int fail(int code, std::string message) {
    for (char& c : message) {
        if (c == '\n' || c == '\r') c = ' ';
    }
    while (!message.empty() && message.back() == ' ') message.pop_back();
    std::cerr << "thalweg: error: " << message << '\n';
    return code;
}

/// CLI11 would only say that a subcommand is required.
void refuse_unknown_command(const CLI::App& app, int argc, char** argv) {
    if (argc < 2 || argv[1][0] == '-') return;
    std::string known;
    for (const CLI::App* command : app.get_subcommands({})) {
        if (command->get_name() == argv[1]) return;
        known += ' ' + command->get_name();
    }
    throw thalweg::Error("unknown command '" + std::string(argv[1]) + "'; there are:" + known);
}

/// The first argument that nobody expected, in our words; otherwise CLI11's.
std::string what_was_wrong(const CLI::App& app, const CLI::ParseError& error) {
    if (error.get_name() != "ExtrasError") return error.what();
    const std::vector<std::string> remaining = app.remaining(true);
    const auto option = std::find_if(remaining.begin(), remaining.end(), [](const auto& r) { return r[0] == '-'; });
    if (option == remaining.end()) return "unexpected argument '" + remaining.front() + "'";
    return "unknown option '" + *option + "'";
}

std::string help_of(const CLI::App& app) {
    const auto used = app.get_subcommands();
    return used.empty() ? "thalweg --help" : "thalweg " + used.front()->get_name() + " --help";
}

/// An option with an empty value (as of a variable that a script has not set) is not the same as none.
void refuse_empty_values(CLI::App& app) {
    const CLI::Validator some(
        [](const std::string& value) { return std::string(value.empty() ? "has an empty value" : ""); }, "");
    for (CLI::App* command : app.get_subcommands([](CLI::App*) { return true; })) {
        for (CLI::Option* option : command->get_options()) {
            if (option->get_items_expected_max() > 0) option->check(some);
        }
    }
}

int parse_and_run(int argc, char** argv) {
    CLI::App app{"Thalweg simulates landscapes, measures real ones, fits the one to the other, and compares them."};
    app.name("thalweg");
    app.set_version_flag("--version", "thalweg " + thalweg::study::versions().thalweg);
    app.require_subcommand(1);
    app.failure_message([](const CLI::App*, const CLI::Error& error) { return std::string(error.what()); });
    for (const auto add : {thalweg::tools::add_analyze, thalweg::tools::add_simulate, thalweg::tools::add_grow,
                           thalweg::tools::add_fit, thalweg::tools::add_compare, thalweg::tools::add_run,
                           thalweg::tools::add_fetch, thalweg::tools::add_render, thalweg::tools::add_version}) {
        add(app);
    }
    refuse_unknown_command(app, argc, argv);
    refuse_empty_values(app);
    try {
        app.parse(argc, argv);
    } catch (const CLI::Success& help) {
        return app.exit(help);
    } catch (const CLI::ParseError& error) {
        return fail(users_to_mend, what_was_wrong(app, error) + " (see " + help_of(app) + ")");
    }
    return 0;
}

}  // namespace

int main(int argc, char** argv) {
    thalweg::tools::keep_freed_memory();
    thalweg::tools::hold_back_signals();
    try {
        return parse_and_run(argc, argv);
    } catch (const thalweg::RemoteError& error) {
        return fail(servers_to_mend, error.what());
    } catch (const thalweg::Error& error) {
        return fail(users_to_mend, error.what());
    } catch (const std::bad_alloc&) {
        return fail(users_to_mend, "not enough memory for this size; use a smaller DEM or fewer nodes");
    } catch (const std::filesystem::filesystem_error& error) {
        return fail(users_to_mend, "'" + error.path1().string() + "' cannot be used: " + error.code().message());
    } catch (const std::exception& error) {
        return fail(ours_to_mend, std::string("a defect of thalweg, please report it: ") + error.what());
    }
}
