// SPDX-License-Identifier: GPL-3.0-or-later
#include "thalweg/study/checkpoint.hpp"

#include <fmt/format.h>

#include <sstream>

#include "study/sealed_file.hpp"
#include "thalweg/core/error.hpp"
#include "thalweg/study/manifest.hpp"

namespace thalweg::study {
namespace fs = std::filesystem;
namespace {

constexpr std::string_view magic = "thalweg checkpoint 1\n";

template <class T>
concept Number = std::is_arithmetic_v<T>;

struct Write {
    SealedWriter& file;
    template <class... T>
    void operator()(const T&... items) {
        (item(items), ...);
    }
    void item(const Number auto& value) { file.bytes(&value, sizeof value); }
    template <Number T>
    void item(const std::vector<T>& values) {
        item(std::uint64_t{values.size()});
        file.bytes(values.data(), values.size() * sizeof(T));
    }
    void item(const std::string& text) {
        item(std::uint64_t{text.size()});
        file.bytes(text.data(), text.size());
    }
    template <class T>
    void item(const std::vector<T>& values) {
        item(std::uint64_t{values.size()});
        for (const T& value : values) item(value);
    }
    void item(const auto& value) { fields(*this, value); }
};

struct Read {
    SealedReader& file;
    template <class... T>
    void operator()(T&... items) {
        (item(items), ...);
    }
    void item(Number auto& value) { file.bytes(&value, sizeof value); }
    /// A size that the rest of the file could hold, whatever it says.
    std::size_t size_of_items(std::size_t bytes_each) {
        std::uint64_t size = 0;
        item(size);
        if (size > file.left() / bytes_each) throw Error(fmt::format("'{}' does not make sense", file.name()));
        return size;
    }
    template <Number T>
    void item(std::vector<T>& values) {
        values.resize(size_of_items(sizeof(T)));
        file.bytes(values.data(), values.size() * sizeof(T));
    }
    void item(std::string& text) {
        text.resize(size_of_items(1));
        file.bytes(text.data(), text.size());
    }
    template <class T>
    void item(std::vector<T>& values) {
        values.resize(size_of_items(sizeof(std::uint32_t)));
        for (T& value : values) item(value);
    }
    void item(auto& value) { fields(*this, value); }
};

/// The members of each struct that is saved, for both directions. A member that somebody adds breaks these lines when
/// compiled: it belongs into the checkpoint, so name it here.
template <class A, class T>
requires std::is_same_v<std::remove_const_t<T>, evolve::Landscape>
void fields(A& archive, T& landscape) {
    auto& [time_yr, elevation_m] = landscape;
    archive(time_yr, elevation_m);
}

template <class A, class T>
requires std::is_same_v<std::remove_const_t<T>, evolve::MassBalance>
void fields(A& archive, T& mass) {
    auto& [uplifted, eroded, talus, diffused, deposited, exported, stored] = mass;
    archive(uplifted, eroded, talus, diffused, deposited, exported, stored);
}

template <class A, class T>
requires std::is_same_v<std::remove_const_t<T>, evolve::ExchangeWatch>
void fields(A& archive, T& watch) {
    auto& [patience, step, last_new_change, last_any_change, last_change, before, frozen] = watch;
    archive(patience, step, last_new_change, last_any_change, last_change, before, frozen);
}

template <class A, class T>
requires std::is_same_v<std::remove_const_t<T>, evolve::Slackening>
void fields(A& archive, T& slackening) {
    auto& [lowest_m3, steps] = slackening;
    archive(lowest_m3, steps);
}

template <class A, class T>
requires std::is_same_v<std::remove_const_t<T>, evolve::StepRecord>
void fields(A& archive, T& record) {
    auto& [step, time_yr, lakes, highest, mean, max_rate, mean_rate, seconds] = record;
    archive(step, time_yr, lakes, highest, mean, max_rate, mean_rate, seconds);
}

template <class A, class T>
requires std::is_same_v<std::remove_const_t<T>, evolve::SimulationState>
void fields(A& archive, T& state) {
    auto& [landscape, steps, converged, max_rate, mean_rate, newton, sediment, sediment_open, hillslope, hillslope_open,
           mass, calm, exchange, slackening] = state;
    archive(landscape, steps, converged, max_rate, mean_rate, newton, sediment, sediment_open, hillslope,
            hillslope_open, mass, calm, exchange, slackening);
}

std::string program() {
    const Versions v = versions();
    return fmt::format("{} ({})", v.thalweg, v.commit);
}

std::string without_meaning(const std::string& line) { return line.substr(0, line.find("  # ")); }

/// The first line of two identities that differs, in words.
std::string first_difference(const std::string& saved, const std::string& now) {
    std::istringstream a(saved), b(now);
    std::string section, was, is;
    while (true) {
        const bool more_a = static_cast<bool>(std::getline(a, was)), more_b = static_cast<bool>(std::getline(b, is));
        if (!more_a && !more_b) return "";
        if (!more_a) was = "nothing";
        if (!more_b) is = "nothing";
        if (was != is) break;
        if (was.starts_with("[")) section = was + " ";
    }
    return fmt::format("{}{} is now {}", section, without_meaning(was), without_meaning(is));
}

/// The files that a member names; none for members that name no files.
template <class T>
std::vector<fs::path> files_of(const T&) {
    return {};
}
std::vector<fs::path> files_of(const std::optional<fs::path>& file) {
    return file ? std::vector{*file} : std::vector<fs::path>{};
}
std::vector<fs::path> files_of(const std::vector<fs::path>& files) { return files; }

/// The file, and what may stand beside it: its place on the map, and the parts of a shapefile.
std::vector<fs::path> with_companions(const fs::path& file) {
    std::vector<fs::path> all{file, file.string() + ".aux.xml"};
    for (const char* extension : {".prj", ".shx", ".dbf", ".cpg", ".wld", ".tfw", ".pgw", ".jgw"}) {
        all.push_back(fs::path(file).replace_extension(extension));
    }
    return all;
}

}  // namespace

std::string identity_of(const Experiment& experiment) {
    Experiment e = experiment;
    e.time.max_steps = Experiment{}.time.max_steps;
    e.output.checkpoint_every.reset();
    std::string text = to_toml(e);
    describe(e, [&](const Field& field, const auto& member) {
        for (const fs::path& named : files_of(member)) {
            for (const fs::path& file : with_companions(named)) {
                if (!fs::is_regular_file(file)) continue;
                text += fmt::format("[content] of {} {} = {}\n", field.key, file.filename().string(), sha256_of(file));
            }
        }
    });
    return text;
}

void save_checkpoint(const evolve::SimulationState& state, const std::vector<evolve::StepRecord>& history,
                     const std::string& identity, const fs::path& path) {
    SealedWriter file(path);
    file.bytes(magic.data(), magic.size());
    Write{file}(program(), identity, state, history);
    file.commit();
}

Checkpoint load_checkpoint(const fs::path& path, const std::string& identity) {
    SealedReader file(path);
    Read read{file};
    std::string head(magic.size(), ' '), saved_by, saved_identity;
    if (file.left() >= magic.size()) file.bytes(head.data(), head.size());
    const std::string advice = "start anew without --resume (--force forgets the stopped run)";
    if (head == magic) read(saved_by);
    if (saved_by != program()) {
        throw Error(fmt::format("the stopped run was made by thalweg {}, and this is {}: {}",
                                saved_by.empty() ? "of another version" : saved_by, program(), advice));
    }
    read(saved_identity);
    if (saved_identity != identity) {
        throw Error(fmt::format("the stopped run had another experiment: {}; {}",
                                first_difference(saved_identity, identity), advice));
    }
    Checkpoint checkpoint;
    read(checkpoint.state, checkpoint.history);
    return checkpoint;
}

void save_frame(const evolve::Landscape& landscape, const fs::path& path) {
    SealedWriter file(path);
    Write{file}(landscape);
    file.commit();
}

evolve::Landscape load_frame(const fs::path& path) {
    SealedReader file(path);
    evolve::Landscape landscape;
    Read{file}(landscape);
    return landscape;
}

}  // namespace thalweg::study
