// SPDX-License-Identifier: GPL-3.0-or-later
#include "study/layer_styles.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <utility>

namespace thalweg::study {
namespace {

struct Color {
    std::uint8_t red, green, blue;
};

/// Blues from light to dark over the orders that rivers reach on earth.
constexpr std::array<Color, 8> order_blues{{{158, 202, 225},
                                            {107, 174, 214},
                                            {66, 146, 198},
                                            {33, 113, 181},
                                            {8, 81, 156},
                                            {8, 64, 129},
                                            {8, 48, 107},
                                            {4, 28, 72}}};

/// The circle of hues in eight steps, light enough for a hillshade to show through and told apart at a glance.
constexpr std::array<Color, 8> direction_hues{{{228, 87, 86},
                                               {238, 155, 64},
                                               {226, 205, 76},
                                               {128, 186, 90},
                                               {72, 176, 160},
                                               {76, 136, 200},
                                               {124, 100, 190},
                                               {196, 92, 158}}};

Color order_color(Index order) { return order_blues[std::min<std::size_t>(order, order_blues.size()) - 1]; }

std::string rgba(const Color& c, int alpha = 255) { return fmt::format("{},{},{},{}", c.red, c.green, c.blue, alpha); }

using Properties = std::vector<std::pair<std::string, std::string>>;

/// One symbol of one layer. Versions of QGIS before 3.20 read `prop`, later ones `Option`.
std::string symbol(const char* type, int number, const char* layer_class, const Properties& properties) {
    std::string options, props;
    for (const auto& [key, value] : properties) {
        options += fmt::format("<Option name=\"{}\" type=\"QString\" value=\"{}\"/>\n", key, value);
        props += fmt::format("<prop k=\"{}\" v=\"{}\"/>\n", key, value);
    }
    return fmt::format(
        "<symbol type=\"{}\" name=\"{}\" alpha=\"1\" clip_to_extent=\"1\" force_rhr=\"0\">\n"
        "<layer class=\"{}\" enabled=\"1\" locked=\"0\" pass=\"{}\">\n<Option type=\"Map\">\n{}</Option>\n{}"
        "</layer>\n</symbol>\n",
        type, number, layer_class, number, options, props);
}

std::string style(const std::string& renderer) {
    return fmt::format(
        "<!DOCTYPE qgis PUBLIC 'http://mrcc.com/qgis.dtd' 'SYSTEM'>\n"
        "<qgis version=\"3.22\" styleCategories=\"Symbology\">\n{}</qgis>\n",
        renderer);
}

std::string one_symbol(const std::string& drawn) {
    return style(
        fmt::format("<renderer-v2 type=\"singleSymbol\" symbollevels=\"0\" enableorderby=\"0\" forceraster=\"0\">\n"
                    "<symbols>\n{}</symbols>\n</renderer-v2>\n",
                    drawn));
}

struct Class {
    std::string value, label, symbol;
};

/// Later classes are drawn over earlier ones, so that rivers cover their tributaries.
std::string classes(const char* attribute, const std::vector<Class>& all) {
    std::string categories, symbols;
    for (std::size_t i = 0; i < all.size(); ++i) {
        categories += fmt::format("<category render=\"true\" symbol=\"{}\" value=\"{}\" label=\"{}\"/>\n", i,
                                  all[i].value, all[i].label);
        symbols += all[i].symbol;
    }
    return style(
        fmt::format("<renderer-v2 type=\"categorizedSymbol\" attr=\"{}\" symbollevels=\"1\" enableorderby=\"0\" "
                    "forceraster=\"0\">\n<categories>\n{}</categories>\n<symbols>\n{}</symbols>\n</renderer-v2>\n",
                    attribute, categories, symbols));
}

std::string marker(int number, const char* shape, double size_mm, const std::string& fill, const std::string& line) {
    return symbol("marker", number, "SimpleMarker",
                  {{"name", shape},
                   {"color", fill},
                   {"outline_color", line},
                   {"outline_style", "solid"},
                   {"outline_width", "0.2"},
                   {"outline_width_unit", "MM"},
                   {"size", fmt::format("{}", size_mm)},
                   {"size_unit", "MM"},
                   {"scale_method", "diameter"}});
}

constexpr const char* dark = "40,40,40,255";

}  // namespace

std::string links_style(Index highest_order) {
    std::vector<Class> orders;
    for (Index order = 1; order <= std::max<Index>(highest_order, 1); ++order) {
        const std::string line = symbol("line", static_cast<int>(order) - 1, "SimpleLine",
                                        {{"line_color", rgba(order_color(order))},
                                         {"line_width", fmt::format("{:.2f}", 0.2 + 0.25 * (order - 1))},
                                         {"line_width_unit", "MM"},
                                         {"line_style", "solid"},
                                         {"capstyle", "round"},
                                         {"joinstyle", "round"}});
        orders.push_back({fmt::format("{}", order), fmt::format("order {}", order), line});
    }
    return classes("strahler", orders);
}

std::string junctions_style() {
    return classes("kind", {{"source", "source", marker(0, "circle", 1.2, "255,255,255,255", dark)},
                            {"junction", "junction", marker(1, "circle", 1.4, rgba(order_color(5)), dark)},
                            {"outlet", "outlet", marker(2, "square", 2.2, "215,48,39,255", dark)}});
}

std::string basins_style() {
    return one_symbol(symbol("fill", 0, "SimpleFill",
                             {{"style", "no"},
                              {"color", "255,255,255,0"},
                              {"outline_color", "90,60,30,255"},
                              {"outline_style", "solid"},
                              {"outline_width", "0.4"},
                              {"outline_width_unit", "MM"},
                              {"joinstyle", "round"}}));
}

std::string knickpoints_style() {
    return one_symbol(symbol("marker", 0, "SimpleMarker",
                             {{"name", "triangle"},
                              {"angle", "180"},
                              {"color", "253,174,97,255"},
                              {"outline_color", dark},
                              {"outline_style", "solid"},
                              {"outline_width", "0.2"},
                              {"outline_width_unit", "MM"},
                              {"size", "2.6"},
                              {"size_unit", "MM"}}));
}

std::vector<io::CellColor> order_colors() {
    std::vector<io::CellColor> colors{{0, 255, 255, 255}};
    for (Index order = 1; order < 256; ++order) {
        const auto [red, green, blue] = order_color(order);
        colors.push_back({static_cast<std::uint8_t>(order), red, green, blue});
    }
    return colors;
}

std::vector<io::CellColor> direction_colors() {
    std::vector<io::CellColor> colors{{0, 0, 0, 0}};
    for (std::size_t slot = 0; slot < direction_hues.size(); ++slot) {
        const auto [red, green, blue] = direction_hues[slot];
        colors.push_back({static_cast<std::uint8_t>(1 << slot), red, green, blue});
    }
    return colors;
}

}  // namespace thalweg::study
