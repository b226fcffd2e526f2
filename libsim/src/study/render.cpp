// SPDX-License-Identifier: GPL-3.0-or-later
#include "thalweg/study/render.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "study/coarser.hpp"
#include "study/local_metres.hpp"
#include "study/report_json.hpp"
#include "study/water.hpp"
#include "thalweg/core/error.hpp"
#include "thalweg/io/picture_file.hpp"
#include "thalweg/render/colors.hpp"
#include "thalweg/render/trace.hpp"
#include "thalweg/render/wireframe.hpp"
#include "thalweg/surface/solid.hpp"

namespace thalweg::study {
namespace {

constexpr double line_width = 1.1;  // pixels

enum class FileKind { png, svg };

FileKind kind_of(const std::filesystem::path& out, const RenderOptions& options) {
    std::string extension = out.extension().string();
    for (char& c : extension) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
    if (extension == ".png") return FileKind::png;
    if (extension != ".svg") throw Error(fmt::format("'{}' must end in .png or .svg", out.string()));
    if (options.style == PictureStyle::surface) {
        throw Error("a surface is drawn in pixels: name a .png, or use --style wireframe or polygons for an .svg");
    }
    return FileKind::svg;
}

Index samples_of(const RenderOptions& o) { return o.samples.value_or(16); }
Index lines_of(const RenderOptions& o) { return o.lines.value_or(50); }

/// What only the paper's colours show, and what excludes each other.
void check_colors(const RenderOptions& o) {
    const auto refuse = [](const char* option) {
        throw Error(fmt::format("{} shows in the colours 'kelley' only: use --color kelley, or leave it out", option));
    };
    if (o.color.value_or(PictureColor::clay) != PictureColor::kelley) {
        if (o.network) refuse("--network");
        if (o.channel_area_m2) refuse("--channel-area-m2");
        if (o.tree_line_m) refuse("--tree-line-m");
        if (o.snow_line_m) refuse("--snow-line-m");
    }
    if (o.network && o.channel_area_m2) {
        throw Error("--network says where the channels are, --channel-area-m2 where the DEM's own begin: give one");
    }
}

/// What was given and the picture would not show.
void check_shown(const RenderOptions& o, FileKind kind) {
    const auto refuse = [](bool given, const char* option, const char* where) {
        if (given) throw Error(fmt::format("{} does not show in {}: leave it out", option, where));
    };
    if (o.style == PictureStyle::surface) return refuse(o.lines.has_value(), "--lines", "a surface, which has none");
    refuse(o.sides.has_value(), "--sides", "wireframe and polygons, which have none");
    if (o.style == PictureStyle::wireframe) {
        refuse(o.color.has_value(), "--color", "a wireframe of one colour");
        refuse(o.sun_azimuth.has_value(), "--sun-azimuth", "a wireframe without light");
        refuse(o.sun_elevation.has_value(), "--sun-elevation", "a wireframe without light");
        refuse(o.samples.has_value(), "--samples", "a wireframe, which is drawn without rays");
        refuse(o.background.has_value(), "--background", "a wireframe, which lies on white");
    }
    if (kind == FileKind::svg) {
        refuse(o.samples.has_value(), "--samples", "an .svg, which is drawn without rays");
        refuse(o.background.has_value(), "--background", "an .svg, which has none");
    }
}

void check(const RenderOptions& o, FileKind kind) {
    if (!(o.vertical_exaggeration >= 1e-6 && o.vertical_exaggeration <= 1e6)) {
        throw Error(fmt::format("the vertical exaggeration must be from 1e-6 to 1e6, not {}", o.vertical_exaggeration));
    }
    if (!std::isfinite(o.sun_azimuth.value_or(0)) || !std::isfinite(o.sun_elevation.value_or(0))) {
        throw Error("the sun's bearing and height must be finite numbers of degrees");
    }
    const Index samples = samples_of(o), lines = lines_of(o);
    if (samples == 0 || samples > 4096) throw Error(fmt::format("{} samples per pixel: 1 to 4096", samples));
    if (lines < 2 || lines > 2000) throw Error(fmt::format("{} lines: from 2 to 2000 make a grid", lines));
    check_shown(o, kind);
    check_colors(o);
}

std::vector<render::Rgb> colors(const Raster& raster, const LocalMetres& local, const RenderOptions& o) {
    if (o.color.value_or(PictureColor::clay) == PictureColor::clay) return render::clay_colors(raster.values.size());
    if (o.color == PictureColor::elevation) return render::elevation_colors(raster.values);
    const std::vector<double> water =
        o.network ? water_of_lines(raster, *o.network) : water_of_flow(raster, o.channel_area_m2);
    const std::vector<double> gradient = render::gradients(raster.grid, raster.values);
    return render::natural_colors({.places = local.centers,
                                   .heights = raster.values,
                                   .gradient = gradient,
                                   .water = water,
                                   .tree_line_m = o.tree_line_m,
                                   .snow_line_m = o.snow_line_m});
}

/// The sides and the base that make a block of the terrain, without the terrain itself.
TriangleSurface sides_of(const TriangleSurface& ground, const Grid& grid, const LocalMetres& local) {
    TriangleSurface top = surface::triangle_surface(grid, local.centers, ground.z);
    const auto [low, high] = std::minmax_element(top.z.begin(), top.z.end());
    const auto [west, east] = std::minmax_element(top.x.begin(), top.x.end());
    const auto [south, north] = std::minmax_element(top.y.begin(), top.y.end());
    const double depth = std::max(0.25 * (*high - *low), 0.02 * std::max(*east - *west, *north - *south));
    TriangleSurface sides = surface::closed_solid(top, *low - depth);
    sides.triangles.erase(sides.triangles.begin(),
                          sides.triangles.begin() + static_cast<std::ptrdiff_t>(top.triangles.size()));
    return sides;
}

/// The rims of a block's walls, as closed chains of its triangles: each wall is two triangles, the first of which runs
/// along the upper rim from its second corner to its first.
std::vector<std::vector<Index>> rims_of(const TriangleSurface& sides, Index walls) {
    std::vector<Index> leaving(sides.size(), none);
    for (Index wall = 0; wall < walls; ++wall) leaving[sides.triangles[2 * wall][1]] = wall;
    std::vector<std::uint8_t> seen(walls, 0);
    std::vector<std::vector<Index>> rims;
    for (Index first = 0; first < walls; ++first) {
        if (seen[first]) continue;
        rims.emplace_back();
        for (Index wall = first; !seen[wall]; wall = leaving[sides.triangles[2 * wall][0]]) {
            seen[wall] = 1;
            rims.back().push_back(wall);
        }
    }
    return rims;
}

/// Whether all corners of a chain of walls lie within `tolerance` of the straight line between its ends.
bool is_straight(const Polygon& rim, std::size_t from, std::size_t to, double tolerance) {
    const Point& a = rim[from % rim.size()];
    const Point& b = rim[to % rim.size()];
    const double length = std::hypot(b.x - a.x, b.y - a.y);
    if (!(length > 0)) return false;
    for (std::size_t i = from + 1; i < to; ++i) {
        const Point& p = rim[i % rim.size()];
        if (std::abs((b.x - a.x) * (p.y - a.y) - (b.y - a.y) * (p.x - a.x)) > tolerance * length) return false;
    }
    return true;
}

/// The last corner up to which the rim runs straight from a corner; straight runs are looked for by doubling.
std::size_t straight_until(const Polygon& rim, std::size_t from, std::size_t end, double tolerance) {
    std::size_t good = from + 1, step = 1;
    while (good + step <= end && is_straight(rim, from, good + step, tolerance)) good += step, step *= 2;
    for (; step > 0; step /= 2) {
        if (good + step <= end && is_straight(rim, from, good + step, tolerance)) good += step;
    }
    return good;
}

/// A raster's rim is a staircase wherever it is oblique, and its steps, lit one by one, would stripe a block's sides.
/// So walls are lit as the straight runs are that stay within a cell of them.
void light_sides_by_runs(render::Model& model, double cell_m) {
    const TriangleSurface& sides = model.sides;
    const auto is_wall = [&](const auto& t) {
        return sides.z[t[0]] != sides.z[t[2]] || sides.z[t[1]] != sides.z[t[2]];
    };
    const auto base = std::ranges::find_if_not(sides.triangles, is_wall);
    const auto walls = static_cast<Index>((base - sides.triangles.begin()) / 2);
    model.side_normals.assign(sides.triangles.size(), {0, 0, -1});
    model.side_clearance = 2 * cell_m;
    for (const std::vector<Index>& chain : rims_of(sides, walls)) {
        Polygon rim;
        for (const Index wall : chain) {
            const Index from = sides.triangles[2 * wall][1];
            rim.push_back({sides.x[from], sides.y[from]});
        }
        for (std::size_t from = 0; from < rim.size();) {
            const std::size_t to = straight_until(rim, from, rim.size(), cell_m);
            const Point& a = rim[from];
            const Point& b = rim[to % rim.size()];
            const render::Vector outward = render::unit({b.y - a.y, a.x - b.x, 0});
            for (; from < to; ++from) {
                model.side_normals[2 * chain[from]] = model.side_normals[2 * chain[from] + 1] = outward;
            }
        }
    }
}

render::Model model_of(const Raster& raster, const RenderOptions& o) {
    const LocalMetres local = local_metres(raster);
    render::Model model{
        .ground = {},
        .color = colors(raster, local, o),
        .sides = {},
        .side_color = render::from_srgb(0x8c7f70),
        .shading = o.style == PictureStyle::surface ? render::Shading::smooth : render::Shading::facets};
    for (const Point& p : local.centers) {
        model.ground.x.push_back(p.x);
        model.ground.y.push_back(p.y);
    }
    for (const double height : raster.values) model.ground.z.push_back(o.vertical_exaggeration * height);
    model.ground.triangles = surface::cell_triangles(raster.grid, model.ground.z);
    if (model.ground.triangles.empty()) {
        throw Error("there is nothing to draw: no neighbouring cells have data");
    }
    if (o.sides.value_or(PictureSides::block) == PictureSides::block && o.style == PictureStyle::surface) {
        model.sides = sides_of(model.ground, raster.grid, local);
        light_sides_by_runs(model, std::max(raster.grid.east_west[0], raster.grid.north_south[0]));
    }
    return model;
}

render::Light light_of(const RenderOptions& o) {
    constexpr double degree = std::numbers::pi / 180;
    return {.to_sun = render::direction(o.sun_azimuth.value_or(305 * degree), o.sun_elevation.value_or(40 * degree)),
            .sun = {0.95f, 0.90f, 0.80f},
            .sky = {0.32f, 0.37f, 0.46f}};
}

render::Background background_of(const RenderOptions& o) {
    if (o.background == PictureBackground::white) return {{1, 1, 1}, {1, 1, 1}};
    return {render::from_srgb(0xbfd0e2), render::from_srgb(0xf4f3ef)};
}

std::string png_of(const render::Picture& picture, const RenderOptions& o) {
    return io::png_picture(render::to_srgb(picture, background_of(o)), picture.width, picture.height);
}

std::string draw_lines(const Raster& raster, const render::Model& model, const render::Camera& camera, FileKind kind,
                       const RenderOptions& o) {
    const auto edges = render::grid_edges(raster.grid, raster.values);
    const auto strokes = render::visible_strokes(model.ground, edges, camera);
    const bool filled = o.style == PictureStyle::polygons;
    if (kind == FileKind::svg) {
        const auto facets = filled ? render::painted_facets(model, camera, light_of(o)) : std::vector<render::Facet>();
        return render::svg_of(camera.width, camera.height, facets, strokes, line_width);
    }
    render::Picture picture{.width = camera.width, .height = camera.height, .light = {}, .coverage = {}};
    if (filled) picture = render::trace(model, camera, light_of(o), {.samples = samples_of(o), .sky_rays = 4});
    picture.light.resize(std::size_t{camera.width} * camera.height);
    picture.coverage.resize(picture.light.size());
    render::draw(picture, strokes, line_width, render::from_srgb(0x222222));
    RenderOptions on_paper = o;
    if (!filled) on_paper.background = PictureBackground::white;
    return png_of(picture, on_paper);
}

}  // namespace

std::string render_dem(const std::filesystem::path& dem, const std::filesystem::path& out, const RenderOptions& o,
                       const Messages& messages) {
    constexpr double most_cells = 4e6;
    const FileKind kind = kind_of(out, o);
    check(o, kind);
    messages.progress("reading");
    Raster raster = read_dem(dem, o.read, messages).raster;
    const Index longer = std::max(raster.grid.rows, raster.grid.cols);
    const double share = std::sqrt(most_cells / std::max(most_cells, double(raster.grid.size())));
    const bool pixels = o.style == PictureStyle::surface;
    raster = coarser(raster, pixels ? static_cast<Index>(std::max(2.0, longer * share)) : lines_of(o));
    const render::Model model = model_of(raster, o);
    const render::Camera camera = render::fitting_camera(o.view, model.ground, model.sides);
    messages.progress("drawing");
    if (!pixels) return draw_lines(raster, model, camera, kind, o);
    return png_of(render::trace(model, camera, light_of(o), {.samples = samples_of(o), .sky_rays = 4}), o);
}

std::string render_summary(const std::filesystem::path& out, const RenderOptions& o) {
    return text_of({{"file", out.filename().string()}, {"width", o.view.width}, {"height", o.view.height}});
}

}  // namespace thalweg::study
