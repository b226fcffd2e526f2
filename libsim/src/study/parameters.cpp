// SPDX-License-Identifier: GPL-3.0-or-later
#include "thalweg/study/parameters.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <set>
#include <sstream>
#include <type_traits>

#define TOML_EXCEPTIONS 1
#include <toml++/toml.h>

#include "thalweg/core/error.hpp"

namespace thalweg::study {
namespace {

template <class T>
struct is_optional : std::false_type {};
template <class T>
struct is_optional<std::optional<T>> : std::true_type {};

template <class E>
std::string alternatives() {
    std::string text;
    for (const auto& [word, value] : words(E{})) text += fmt::format("{}\"{}\"", text.empty() ? "" : " or ", word);
    return text;
}

template <class E>
std::string_view word_of(E value) {
    for (const auto& [word, candidate] : words(E{})) {
        if (candidate == value) return word;
    }
    throw Error("an enumeration without a word");
}

std::string quoted(const toml::node& node) {
    std::ostringstream text;
    node.visit([&](const auto& value) { text << value; });
    return text.str();
}

/// Smallest number of single-letter changes between two words (Levenshtein 1966).
std::size_t edit_distance(std::string_view a, std::string_view b) {
    std::vector<std::size_t> row(b.size() + 1);
    std::iota(row.begin(), row.end(), std::size_t{0});
    for (std::size_t i = 1; i <= a.size(); ++i) {
        std::size_t diagonal = row[0];
        row[0] = i;
        for (std::size_t j = 1; j <= b.size(); ++j) {
            const std::size_t replaced = diagonal + (a[i - 1] != b[j - 1]);
            diagonal = row[j];
            row[j] = std::min({replaced, row[j] + 1, row[j - 1] + 1});
        }
    }
    return row[b.size()];
}

void check_range(const Field& field, double value) {
    const bool too_small = field.smallest_excluded ? !(value > field.smallest) : !(value >= field.smallest);
    if (!too_small && value <= field.largest && std::isfinite(value)) return;
    if (!std::isfinite(value)) throw Error(fmt::format("{} must be a finite number, not {}", field.key, value));
    if (std::isfinite(field.largest)) {
        throw Error(fmt::format("{} must be {} {} and at most {}, not {}", field.key,
                                field.smallest_excluded ? "above" : "at least", field.smallest, field.largest, value));
    }
    throw Error(fmt::format("{} must be {} {}, not {}", field.key, field.smallest_excluded ? "above" : "at least",
                            field.smallest, value));
}

/// Fills the members of an experiment from a parsed file.
class Reader {
  public:
    Reader(const toml::table& table, std::filesystem::path folder) : table_(table), folder_(std::move(folder)) {}

    template <class T>
    void operator()(const Field& field, T& member) {
        known_.insert(std::string(field.key));
        const toml::node* node = table_.at_path(field.key).node();
        if (node != nullptr) read(field, *node, member);
    }

    /// Every key of the file must have been asked for.
    void refuse_unknown(const toml::table& table, const std::string& prefix = "") const {
        for (const auto& [key, node] : table) {
            const std::string name = prefix + std::string(key.str());
            if (const toml::table* inner = node.as_table(); inner != nullptr && is_section(name)) {
                refuse_unknown(*inner, name + ".");
            } else if (!known_.contains(name) || key.str().find('.') != std::string_view::npos) {
                refuse(name, node);
            }
        }
    }

  private:
    [[noreturn]] void refuse(const std::string& name, const toml::node& node) const {
        if (is_section(name)) {
            throw Error(
                fmt::format("unknown key '{}': that is a section; write [{}] and its keys below it", name, name));
        }
        const bool section = node.is_table() && name.find('.') == std::string::npos;
        throw Error(
            fmt::format("unknown key '{}'; did you mean '{}'?", name, section ? nearest_section(name) : nearest(name)));
    }

    std::string nearest_section(const std::string& name) const {
        std::set<std::string> sections;
        for (const std::string& key : known_) {
            if (const std::size_t dot = key.find('.'); dot != std::string::npos) sections.insert(key.substr(0, dot));
        }
        return *std::min_element(sections.begin(), sections.end(), [&](const auto& a, const auto& b) {
            return edit_distance(name, a) < edit_distance(name, b);
        });
    }

    bool is_section(const std::string& name) const {
        return std::any_of(known_.begin(), known_.end(), [&](const auto& key) { return key.starts_with(name + "."); });
    }

    std::string nearest(const std::string& name) const {
        // A key without its section is meant for one of that name in any section.
        const bool bare = name.find('.') == std::string::npos;
        const auto distance = [&](const std::string& key) {
            const std::size_t dot = key.rfind('.');
            const std::size_t whole = edit_distance(name, key);
            return bare && dot != std::string::npos ? std::min(whole, edit_distance(name, key.substr(dot + 1))) : whole;
        };
        return *std::min_element(known_.begin(), known_.end(),
                                 [&](const auto& a, const auto& b) { return distance(a) < distance(b); });
    }

    template <class T>
    void read(const Field& field, const toml::node& node, std::optional<T>& member) const {
        T value{};
        read(field, node, value);
        member = value;
    }

    void read(const Field& field, const toml::node& node, double& member) const {
        const auto number = node.value<double>();
        if (!number) throw Error(fmt::format("{} must be a number, not {}", field.key, quoted(node)));
        check_range(field, *number);
        member = *number;
    }

    void read(const Field& field, const toml::node& node, bool& member) const {
        const auto truth = node.is_boolean() ? node.value<bool>() : std::nullopt;
        if (!truth) throw Error(fmt::format("{} must be true or false, not {}", field.key, quoted(node)));
        member = *truth;
    }

    template <class Whole>
    requires std::is_unsigned_v<Whole>
    void read(const Field& field, const toml::node& node, Whole& member) const {
        const auto number = node.is_number() ? node.value<double>() : std::nullopt;
        if (!number || *number != std::floor(*number)) {
            throw Error(fmt::format("{} must be a whole number, not {}", field.key, quoted(node)));
        }
        check_range(field, *number);
        if (*number > 9007199254740992.0) throw Error(fmt::format("{} must be at most 2^53", field.key));
        member = static_cast<Whole>(*number);
    }

    template <class E>
    requires std::is_enum_v<E>
    void read(const Field& field, const toml::node& node, E& member) const {
        const auto text = node.value<std::string>();
        for (const auto& [word, value] : words(E{})) {
            if (text == word) {
                member = value;
                return;
            }
        }
        throw Error(fmt::format("{} must be {}, not {}", field.key, alternatives<E>(), quoted(node)));
    }

    void read(const Field& field, const toml::node& node, std::filesystem::path& member) const {
        const auto text = node.value<std::string>();
        if (!text) throw Error(fmt::format("{} must be a file name in quotes, not {}", field.key, quoted(node)));
        member = (folder_ / *text).lexically_normal();
    }

    void read(const Field& field, const toml::node& node, std::string& member) const {
        const auto text = node.value<std::string>();
        if (!text) throw Error(fmt::format("{} must be text in quotes, not {}", field.key, quoted(node)));
        member = *text;
    }

    void read(const Field& field, const toml::node& node, std::array<double, 4>& member) const {
        const toml::array* array = node.as_array();
        if (array == nullptr || array->size() != member.size()) {
            throw Error(fmt::format("{} must be four numbers in brackets, not {}", field.key, quoted(node)));
        }
        for (std::size_t i = 0; i < member.size(); ++i) read(field, (*array)[i], member[i]);
    }

    void read(const Field& field, const toml::node& node, std::vector<double>& member) const {
        if (field.key != "domain.size_m") return read_numbers(field, node, member);
        const toml::array* array = node.as_array();
        if (array == nullptr || array->size() != 2) {
            throw Error(fmt::format("{} must be two numbers in brackets, not {}", field.key, quoted(node)));
        }
        member.assign(2, 0.0);
        read(field, (*array)[0], member[0]);
        read(field, (*array)[1], member[1]);
    }

    void read(const Field& field, const toml::node& node, std::vector<std::filesystem::path>& member) const {
        const toml::array* array = node.as_array();
        member.assign(array == nullptr ? 1 : array->size(), {});
        for (std::size_t i = 0; i < member.size(); ++i) read(field, array == nullptr ? node : (*array)[i], member[i]);
    }

    /// One word or a list of different ones.
    void read(const Field& field, const toml::node& node, std::vector<StudyModel>& member) const {
        const toml::array* array = node.as_array();
        member.assign(array == nullptr ? 1 : array->size(), StudyModel::stream_power);
        for (std::size_t i = 0; i < member.size(); ++i) read(field, array == nullptr ? node : (*array)[i], member[i]);
        if (member.empty()) throw Error(fmt::format("{} must name one model at least", field.key));
        std::ranges::sort(member);
        if (std::ranges::adjacent_find(member) != member.end()) {
            throw Error(fmt::format("{} names a model twice: {}", field.key, quoted(node)));
        }
    }

    /// One number, or as many as there are; `domain.size_m` is a pair.
    void read_numbers(const Field& field, const toml::node& node, std::vector<double>& member) const {
        const toml::array* array = node.as_array();
        member.assign(array == nullptr ? 1 : array->size(), 0.0);
        for (std::size_t i = 0; i < member.size(); ++i) read(field, array == nullptr ? node : (*array)[i], member[i]);
    }

    void read(const Field& field, const toml::node& node, Shape& member) const {
        const toml::array* array = node.as_array();
        if (array == nullptr) return read(field, node, member.emplace<std::filesystem::path>());
        std::vector<Point>& corners = member.emplace<std::vector<Point>>();
        for (const toml::node& corner : *array) {
            const toml::array* pair = corner.as_array();
            if (pair == nullptr || pair->size() != 2) {
                throw Error(fmt::format("{} must be a list of places [[x, y], …] or a file name in quotes, not {}",
                                        field.key, quoted(node)));
            }
            Point& place = corners.emplace_back();
            read(field, (*pair)[0], place.x);
            read(field, (*pair)[1], place.y);
        }
    }

    void read(const Field& field, const toml::node& node, Outlets& member) const {
        member = {};
        const toml::table* table = node.as_table();
        const toml::array* array = node.as_array();
        if (table != nullptr && table->size() == 1 && table->contains("uplift_below")) {
            member.rule = OutletRule::uplift_below;
            const Field share{"outlets.uplift_below", "", "", 0, std::numeric_limits<double>::infinity(), true};
            return read(share, *table->get("uplift_below"), member.uplift_below);
        }
        const auto word = node.value<std::string>();
        if (word == "all") return;
        if (word == "dem") {
            member.rule = OutletRule::dem;
            return;
        }
        if (table != nullptr || (array != nullptr && array->empty()) || (array == nullptr && !word)) {
            throw Error(
                fmt::format("{} must be \"all\", \"dem\", a list of sides such as [\"north\", \"southeast\"] or "
                            "{{ uplift_below = 0.33 }}, not {}",
                            field.key, quoted(node)));
        }
        member.rule = OutletRule::sides;
        member.sides.assign(word ? 1 : array->size(), Side::north);
        for (std::size_t i = 0; i < member.sides.size(); ++i) read(field, word ? node : (*array)[i], member.sides[i]);
    }

    const toml::table& table_;
    std::filesystem::path folder_;
    std::set<std::string> known_;
};

/// Puts "river.k=2e-5" into the table; what is no TOML value is taken as a word, so that quotes may be left out.
void apply_override(toml::table& table, const std::string& text) {
    const std::size_t equals = text.find('=');
    if (equals == std::string::npos || equals == 0) {
        throw Error(fmt::format("--set needs key=value, not '{}'", text));
    }
    const std::string key = text.substr(0, equals);
    const std::string value = text.substr(equals + 1);
    toml::table parsed;
    try {
        parsed = toml::parse("value = " + value);
    } catch (const toml::parse_error&) {
        parsed.insert("value", value);
    }
    const std::size_t dot = key.find('.');
    toml::table* target = &table;
    if (dot != std::string::npos) {
        auto [entry, inserted] = table.insert(key.substr(0, dot), toml::table{});
        target = entry->second.as_table();
        if (target == nullptr) throw Error(fmt::format("--set {}: '{}' is no section", text, key.substr(0, dot)));
    }
    target->insert_or_assign(dot == std::string::npos ? key : key.substr(dot + 1), *parsed.get("value"));
}

std::string shown(double value) { return fmt::format("{}", value); }
std::string shown(const std::string& word) {
    std::ostringstream text;
    text << toml::value<std::string>(word);
    return text.str();
}
/// What was read from a file is absolute; a relative path is meant from where the experiment will lie.
std::string shown(const std::filesystem::path& path) { return shown(path.lexically_normal().string()); }
std::string shown(const std::array<double, 4>& values) { return fmt::format("[{}]", fmt::join(values, ", ")); }
std::string shown(const std::vector<double>& values) { return fmt::format("[{}]", fmt::join(values, ", ")); }
std::string shown(bool value) { return value ? "true" : "false"; }
std::string shown(const std::vector<std::filesystem::path>& paths) {
    std::string text;
    for (const auto& path : paths) text += (text.empty() ? "" : ", ") + shown(path);
    return fmt::format("[{}]", text);
}
template <class Whole>
requires std::is_unsigned_v<Whole> std::string shown(Whole value) { return fmt::format("{}", value); }
template <class E>
requires std::is_enum_v<E> std::string shown(E value) { return fmt::format("\"{}\"", word_of(value)); }
std::string shown(const Shape& shape) {
    if (const auto* path = std::get_if<std::filesystem::path>(&shape)) return shown(*path);
    std::string text;
    for (const Point& p : std::get<std::vector<Point>>(shape)) {
        text += fmt::format("{}[{}, {}]", text.empty() ? "" : ", ", p.x, p.y);
    }
    return fmt::format("[{}]", text);
}
std::string shown(const std::vector<StudyModel>& models) {
    std::string text;
    for (const StudyModel model : models) text += (text.empty() ? "" : ", ") + shown(model);
    return fmt::format("[{}]", text);
}
std::string shown(const Outlets& outlets) {
    switch (outlets.rule) {
        case OutletRule::all:
            return "\"all\"";
        case OutletRule::dem:
            return "\"dem\"";
        case OutletRule::uplift_below:
            return fmt::format("{{ uplift_below = {} }}", outlets.uplift_below);
        case OutletRule::sides:
            break;
    }
    std::string text;
    for (const Side side : outlets.sides) text += (text.empty() ? "" : ", ") + shown(side);
    return fmt::format("[{}]", text);
}

template <class T>
struct is_vector : std::false_type {};
template <class T>
struct is_vector<std::vector<T>> : std::true_type {};

}  // namespace

const Words<MeshKind>& words(MeshKind) {
    static const Words<MeshKind> all{{"tin", MeshKind::tin}, {"raster", MeshKind::raster}};
    return all;
}
const Words<Side>& words(Side) {
    static const Words<Side> all{
        {"north", Side::north}, {"northeast", Side::northeast}, {"east", Side::east}, {"southeast", Side::southeast},
        {"south", Side::south}, {"southwest", Side::southwest}, {"west", Side::west}, {"northwest", Side::northwest}};
    return all;
}
const Words<mesh::PointPattern>& words(mesh::PointPattern) {
    static const Words<mesh::PointPattern> all{{"poisson", mesh::PointPattern::poisson},
                                               {"hexagonal", mesh::PointPattern::hexagonal},
                                               {"regular", mesh::PointPattern::regular}};
    return all;
}
const Words<evolve::NoiseVariant>& words(evolve::NoiseVariant) {
    static const Words<evolve::NoiseVariant> all{{"fbm", evolve::NoiseVariant::fbm},
                                                 {"billow", evolve::NoiseVariant::billow},
                                                 {"ridge", evolve::NoiseVariant::ridge},
                                                 {"warped", evolve::NoiseVariant::warped}};
    return all;
}
const Words<NoiseKind>& words(NoiseKind) {
    static const Words<NoiseKind> all{{"perlin", NoiseKind::perlin}, {"uniform", NoiseKind::uniform}};
    return all;
}
const Words<InitialSurface>& words(InitialSurface) {
    static const Words<InitialSurface> all{{"noise", InitialSurface::noise}, {"dem", InitialSurface::dem}};
    return all;
}
const Words<Solver>& words(Solver) {
    static const Words<Solver> all{{"implicit", Solver::implicit}, {"steady", Solver::steady}};
    return all;
}
const Words<Interpolation>& words(Interpolation) {
    static const Words<Interpolation> all{
        {"gaussian", Interpolation::gaussian}, {"linear", Interpolation::linear}, {"natural", Interpolation::natural}};
    return all;
}
const Words<GeotiffKind>& words(GeotiffKind) {
    static const Words<GeotiffKind> all{{"tiled", GeotiffKind::tiled}, {"cog", GeotiffKind::cog}};
    return all;
}
const Words<HeightmapFile>& words(HeightmapFile) {
    static const Words<HeightmapFile> all{{"png", HeightmapFile::png}};
    return all;
}
const Words<MeshFile>& words(MeshFile) {
    static const Words<MeshFile> all{{"obj", MeshFile::obj}, {"ply", MeshFile::ply}};
    return all;
}
const Words<StudyModel>& words(StudyModel) {
    static const Words<StudyModel> all{{"stream-power", StudyModel::stream_power}, {"growth", StudyModel::growth}};
    return all;
}
const Words<FitMethod>& words(FitMethod) {
    static const Words<FitMethod> all{{"slope-area", FitMethod::slope_area}};
    return all;
}
const Words<RoughnessKind>& words(RoughnessKind) {
    static const Words<RoughnessKind> all{{"noise", RoughnessKind::noise}, {"subdivision", RoughnessKind::subdivision}};
    return all;
}
const Words<grow::Stop>& words(grow::Stop) {
    static const Words<grow::Stop> all{{"density", grow::Stop::density}, {"links", grow::Stop::links}};
    return all;
}
const Words<grow::Divides>& words(grow::Divides) {
    static const Words<grow::Divides> all{{"slopes", grow::Divides::slopes}, {"shares", grow::Divides::shares}};
    return all;
}
const Words<grow::UpstreamLink>& words(grow::UpstreamLink) {
    static const Words<grow::UpstreamLink> all{{"keeps_line", grow::UpstreamLink::keeps_line},
                                               {"turns", grow::UpstreamLink::turns}};
    return all;
}
const Words<grow::Thalweg>& words(grow::Thalweg) {
    static const Words<grow::Thalweg> all{{"along_channel", grow::Thalweg::along_channel},
                                          {"minimum_norm", grow::Thalweg::minimum_norm}};
    return all;
}
const Words<evolve::Pattern>& words(evolve::Pattern) {
    static const Words<evolve::Pattern> all{
        {"constant", evolve::Pattern::constant}, {"gradient", evolve::Pattern::gradient},
        {"stepped", evolve::Pattern::stepped},   {"diamond", evolve::Pattern::diamond},
        {"radial", evolve::Pattern::radial},     {"noise", evolve::Pattern::noise}};
    return all;
}
const Words<terrain::Receiver>& words(terrain::Receiver) {
    static const Words<terrain::Receiver> all{{"steepest", terrain::Receiver::steepest},
                                              {"lowest", terrain::Receiver::lowest}};
    return all;
}

const Words<evolve::Flow>& words(evolve::Flow) {
    static const Words<evolve::Flow> all{{"single", evolve::Flow::single}, {"multiple", evolve::Flow::multiple}};
    return all;
}

Experiment read_experiment(const std::filesystem::path& path, const std::vector<std::string>& overrides) {
    if (!std::filesystem::is_regular_file(path)) {
        throw Error(fmt::format("no experiment file '{}'", path.string()));
    }
    toml::table table;
    try {
        table = toml::parse_file(path.string());
    } catch (const toml::parse_error& error) {
        throw Error(fmt::format("'{}' is not TOML: line {}: {}", path.string(), error.source().begin.line,
                                error.description()));
    }
    try {
        for (const std::string& text : overrides) apply_override(table, text);
        Experiment experiment;
        Reader reader(table, std::filesystem::absolute(path).parent_path());
        describe(experiment, [&](const Field& field, auto& member) { reader(field, member); });
        reader.refuse_unknown(table);
        return experiment;
    } catch (const Error& error) {
        throw Error(fmt::format("'{}': {}", path.string(), error.what()));
    }
}

std::string to_toml(const Experiment& experiment) { return to_toml(experiment, {}); }

std::string to_toml(const Experiment& experiment, std::span<const std::string_view> sections) {
    std::string text;
    std::string section;
    const auto line = [&](const Field& field, const std::string& value) {
        const std::size_t dot = field.key.find('.');
        const std::string own_section(dot == std::string_view::npos ? "" : field.key.substr(0, dot));
        if (!sections.empty() && std::ranges::find(sections, own_section) == sections.end()) return;
        if (own_section != section) text += fmt::format("\n[{}]\n", own_section);
        section = own_section;
        text += fmt::format("{} = {}", field.key.substr(dot == std::string_view::npos ? 0 : dot + 1), value);
        text += fmt::format("  # {}{}{}\n", field.text, field.unit.empty() ? "" : ", ", field.unit);
    };
    describe(experiment, [&](const Field& field, const auto& member) {
        using T = std::remove_cvref_t<decltype(member)>;
        if constexpr (is_optional<T>::value) {
            if (member) line(field, shown(*member));
        } else if constexpr (is_vector<T>::value || std::is_same_v<T, std::string>) {
            if (!member.empty()) line(field, shown(member));
        } else {
            line(field, shown(member));
        }
    });
    return text;
}

std::string experiment_reference() {
    std::string text;
    const Experiment defaults;
    describe(defaults, [&](const Field& field, const auto& member) {
        using T = std::remove_cvref_t<decltype(member)>;
        std::string value;
        if constexpr (is_optional<T>::value) {
            if constexpr (std::is_enum_v<typename T::value_type>) value = alternatives<typename T::value_type>();
        } else if constexpr (std::is_enum_v<T>) {
            value = fmt::format("{}; default \"{}\"", alternatives<T>(), word_of(member));
        } else if constexpr (std::is_arithmetic_v<T>) {
            value = fmt::format("default {}", shown(member));
        }
        text +=
            fmt::format("  {:<28} {}{}{}{}\n", field.key, field.text,
                        field.unit.empty() ? "" : fmt::format(" [{}]", field.unit), value.empty() ? "" : "; ", value);
    });
    return text;
}

}  // namespace thalweg::study
