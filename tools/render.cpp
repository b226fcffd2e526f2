// SPDX-License-Identifier: GPL-3.0-or-later
#include "thalweg/study/render.hpp"

#include <fmt/format.h>

#include <charconv>
#include <memory>
#include <numbers>
#include <optional>

#include "command.hpp"
#include "thalweg/core/error.hpp"

namespace thalweg::tools {
namespace {

struct Options {
    FileOptions file;
    std::string dem, crs, nodata, size = "1280x800", network, channel_area, tree_line, snow_line;
    std::string style = "surface", color, sides, background;
    double azimuth = 200, elevation = 30, field_of_view = 30, exaggeration = 1;
    std::optional<double> sun_azimuth, sun_elevation;
    std::optional<Index> samples, lines;
};

constexpr double degree = std::numbers::pi / 180;

void read_size(const std::string& text, render::View& view) {
    const char *begin = text.data(), *end = begin + text.size();
    const auto [by, bad_width] = std::from_chars(begin, end, view.width);
    const bool has_height = bad_width == std::errc() && by != end && *by == 'x';
    const auto [rest, bad_height] = std::from_chars(has_height ? by + 1 : end, end, view.height);
    if (!has_height || bad_height != std::errc() || rest != end) {
        throw Error(fmt::format("--size needs WIDTHxHEIGHT in pixels, for example 1280x800, not '{}'", text));
    }
}

template <class E>
E chosen(const std::string& option, const std::string& word, std::initializer_list<std::pair<const char*, E>> words) {
    std::string known;
    for (const auto& [name, value] : words) {
        if (word == name) return value;
        known += fmt::format("{}{}", known.empty() ? "" : ", ", name);
    }
    throw Error(fmt::format("{} has no '{}'; there are: {}", option, word, known));
}

template <class E>
std::optional<E> chosen_if_given(const std::string& option, const std::string& word,
                                 std::initializer_list<std::pair<const char*, E>> words) {
    return word.empty() ? std::nullopt : std::optional(chosen<E>(option, word, words));
}

std::optional<double> number_if_given(const std::string& option, const std::string& text, Sign sign) {
    return text.empty() ? std::nullopt : std::optional(parse_number(option, text, sign));
}

study::RenderOptions render_options(const Options& o) {
    using study::PictureBackground, study::PictureColor, study::PictureSides, study::PictureStyle;
    study::RenderOptions r;
    r.read.crs = o.crs;
    r.read.nodata = number_if_given("--nodata", o.nodata, Sign::any);
    read_size(o.size, r.view);
    r.view.azimuth = o.azimuth * degree;
    r.view.elevation = o.elevation * degree;
    r.view.field_of_view = o.field_of_view * degree;
    if (o.sun_azimuth) r.sun_azimuth = *o.sun_azimuth * degree;
    if (o.sun_elevation) r.sun_elevation = *o.sun_elevation * degree;
    r.vertical_exaggeration = o.exaggeration;
    r.style = chosen<PictureStyle>("--style", o.style,
                                   {{"surface", PictureStyle::surface},
                                    {"wireframe", PictureStyle::wireframe},
                                    {"polygons", PictureStyle::polygons}});
    r.color = chosen_if_given<PictureColor>(
        "--color", o.color,
        {{"clay", PictureColor::clay}, {"kelley", PictureColor::kelley}, {"elevation", PictureColor::elevation}});
    r.sides = chosen_if_given<PictureSides>("--sides", o.sides,
                                            {{"block", PictureSides::block}, {"none", PictureSides::none}});
    r.background = chosen_if_given<PictureBackground>(
        "--background", o.background, {{"sky", PictureBackground::sky}, {"white", PictureBackground::white}});
    r.samples = o.samples;
    r.lines = o.lines;
    if (!o.network.empty()) r.network = o.network;
    r.channel_area_m2 = number_if_given("--channel-area-m2", o.channel_area, Sign::positive);
    r.tree_line_m = number_if_given("--tree-line-m", o.tree_line, Sign::any);
    r.snow_line_m = number_if_given("--snow-line-m", o.snow_line, Sign::any);
    return r;
}

void add_view_options(CLI::App& app, Options& o) {
    app.add_option("--azimuth", o.azimuth, "bearing from the terrain to the viewer, degrees clockwise from north")
        ->capture_default_str();
    app.add_option("--elevation-angle", o.elevation, "of the viewer above the horizon, degrees; 90: straight down")
        ->capture_default_str();
    app.add_option("--field-of-view", o.field_of_view, "across the longer side of the picture, degrees")
        ->capture_default_str();
    app.add_option("--sun-azimuth", o.sun_azimuth, "bearing of the sun, degrees clockwise from north [default: 305]");
    app.add_option("--sun-elevation", o.sun_elevation, "of the sun above the horizon, degrees [default: 40]");
    app.add_option("--vertical-exaggeration", o.exaggeration, "heights are multiplied by it")->capture_default_str();
}

void add_drawing_options(CLI::App& app, Options& o) {
    app.add_option("--size", o.size, "width and height in pixels")->capture_default_str();
    app.add_option("--style", o.style, "surface (ray-traced), wireframe (hidden lines removed) or polygons")
        ->capture_default_str();
    app.add_option(
        "--color", o.color,
        "clay, elevation, or kelley: by elevation, location and gradient (Kelley et al. 1988) [default: clay]");
    app.add_option("--sides", o.sides, "of a surface: block, with sides and base, or none [default: block]");
    app.add_option("--background", o.background, "sky or white [default: sky]");
    app.add_option("--samples", o.samples, "rays per pixel; more are smoother and slower [default: 16]");
    app.add_option("--lines", o.lines, "of wireframe and polygons, along the longer side [default: 50]");
    app.add_option("--network", o.network, "channels to paint, e.g. network.gpkg [default: the DEM's own flow]");
    app.add_option("--channel-area-m2", o.channel_area,
                   "drainage area where the DEM's own channels begin [default: 0.1 % of the area, rounded to 1-2-5]");
    app.add_option("--tree-line-m", o.tree_line, "upper end of forests [default: at two thirds of the relief]");
    app.add_option("--snow-line-m", o.snow_line,
                   "lower end of snow [default: at 85 % of the relief, but not below 3000 m]");
}

void run(const Options& o) {
    const study::RenderOptions options = render_options(o);
    run_to_file(
        o.file, [&](const study::Messages& m) { return study::render_dem(o.dem, o.file.out, options, m); },
        study::render_summary(o.file.out, options));
}

}  // namespace

void add_render(CLI::App& app) {
    CLI::App* command = app.add_subcommand("render", "Draw a terrain in perspective, with light and shadows");
    auto o = std::make_shared<Options>();
    command->add_option("DEM", o->dem, "raster of elevations, in any format that GDAL reads")->required();
    command
        ->add_option("--out", o->file.out, "picture to write: .png, or .svg for lines; it appears whole or not at all")
        ->required();
    add_view_options(*command, *o);
    add_drawing_options(*command, *o);
    command->add_option("--crs", o->crs, "coordinate system to use instead of the file's, e.g. EPSG:32611");
    command->add_option("--nodata", o->nodata, "value to be taken as no data, besides what the file declares");
    command->add_flag("--force", o->file.force, "replace an existing picture");
    command->add_option("--threads", o->file.threads, "threads to use, 0 for all; the picture does not depend on it")
        ->check(CLI::Range(0, 4096))
        ->capture_default_str();
    command->add_flag("--quiet", o->file.quiet, "no progress on standard error");
    command->add_flag("--json", o->file.json, "print name and size of the picture on standard output");
    command->callback([o] { run(*o); });
}

}  // namespace thalweg::tools
