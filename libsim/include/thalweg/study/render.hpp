// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "thalweg/io/raster_file.hpp"
#include "thalweg/render/camera.hpp"
#include "thalweg/study/analyze.hpp"

namespace thalweg::study {

enum class PictureStyle {
    surface,    ///< ray-traced, with light and shadows
    wireframe,  ///< lines over a coarse grid, hidden ones removed
    polygons    ///< that grid's triangles, each in one colour, with those lines
};
enum class PictureColor { clay, kelley, elevation };
enum class PictureSides { block, none };
enum class PictureBackground { sky, white };

/// How to draw a terrain. Angles in radians. What is given though the picture would not show it is refused: lines of a
/// surface; light, colours, samples, sides or background of a wireframe; samples, sides or background of polygons as
/// far as their file has none.
struct RenderOptions {
    io::ReadOptions read;
    render::View view;
    double vertical_exaggeration = 1;  ///< > 0
    PictureStyle style = PictureStyle::surface;
    std::optional<double> sun_azimuth;             ///< bearing of the sun; default 305°
    std::optional<double> sun_elevation;           ///< above the horizon; default 40°
    std::optional<PictureColor> color;             ///< default clay
    std::optional<PictureSides> sides;             ///< default a block
    std::optional<PictureBackground> background;   ///< default the sky
    std::optional<Index> samples;                  ///< rays per pixel; default 16
    std::optional<Index> lines;                    ///< along the longer side; default 50
    std::optional<std::filesystem::path> network;  ///< channels to paint; default: those of the DEM's own flow
    std::optional<double> channel_area_m2;         ///< drainage area where these begin
    std::optional<double> tree_line_m, snow_line_m;
};

/// Reads a DEM and draws it. `out` is the picture's name: .png, or .svg for lines and polygons. Returns the file's
/// contents. DEMs of more than four million cells are averaged down to that; degrees are placed in metres.
/// Throws Error for what cannot be read or drawn.
std::string render_dem(const std::filesystem::path& dem, const std::filesystem::path& out, const RenderOptions&,
                       const Messages&);

/// Name and size of that picture as JSON.
std::string render_summary(const std::filesystem::path& out, const RenderOptions&);

}  // namespace thalweg::study
