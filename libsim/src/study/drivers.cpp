// SPDX-License-Identifier: GPL-3.0-or-later
#include "study/drivers.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "thalweg/core/error.hpp"
#include "thalweg/evolve/noise.hpp"
#include "thalweg/io/geodesy.hpp"
#include "thalweg/io/image_file.hpp"
#include "thalweg/io/vector_file.hpp"

namespace thalweg::study {
namespace {

/// Columns and rows of an image, from its north-west corner, at the nodes.
std::vector<Point> stretched(const io::Image& image, const Nodes& nodes) {
    const auto& [low, high] = nodes.box_m;
    std::vector<Point> places;
    for (const Point& p : nodes.plane_m) {
        places.push_back(
            {(p.x - low.x) / (high.x - low.x) * image.cols, (high.y - p.y) / (high.y - low.y) * image.rows});
    }
    return places;
}

std::vector<Point> by_coordinates(const io::Image& image, const Nodes& nodes) {
    const Placement& at = image.placement;
    std::vector<Point> places = at.crs_wkt.empty() ? nodes.map : io::reproject(nodes.crs_wkt, at.crs_wkt, nodes.map);
    for (Point& p : places) p = {(p.x - at.west) / at.cell_width, (at.north - p.y) / at.cell_height};
    return places;
}

std::vector<Point> places_in(const io::Image& image, const std::string& what, const Nodes& nodes,
                             std::vector<std::string>& warnings) {
    const bool located = !image.placement.crs_wkt.empty();
    if (!image.placed) return stretched(image, nodes);
    if (located == !nodes.crs_wkt.empty()) return by_coordinates(image, nodes);
    if (!located) {
        throw Error(
            fmt::format("{} has coordinates but no coordinate system, while the domain has one: give it one with "
                        "gdal_edit.py -a_srs, or make it a plain image, which is stretched over the domain",
                        what));
    }
    warnings.push_back(
        fmt::format("{} lies on the map but the domain does not: it is stretched over the domain", what));
    return stretched(image, nodes);
}

void check_covered(const std::vector<double>& values, const std::string& what, const Nodes& nodes) {
    std::size_t missing = 0, inside = 0;
    for (std::size_t i = 0; i < values.size(); ++i) {
        inside += nodes.inside[i];
        missing += nodes.inside[i] && std::isnan(values[i]);
    }
    if (missing == 0) return;
    throw Error(fmt::format("{} has no data at {} of the domain's {} nodes: it must cover the whole domain", what,
                            missing, inside));
}

/// Of a quantity that cannot be negative, relative to the largest value of the file.
std::vector<double> relative_image_at(const std::string& key, const std::filesystem::path& path, const Nodes& nodes,
                                      std::vector<std::string>& warnings) {
    const io::Image image = io::read_image(path);
    const std::string what = fmt::format("{}: {}", key, path.string());
    const double largest = image.largest();
    if (std::isnan(largest)) throw Error(fmt::format("{} holds no data: all of its cells are void", what));
    const auto below = std::count_if(image.values.begin(), image.values.end(), [](double value) { return value < 0; });
    if (below > 0) throw Error(fmt::format("{} has {} negative values: it needs zero or more everywhere", what, below));
    if (!(largest > 0)) throw Error(fmt::format("{} is zero everywhere, so it cannot be scaled to a maximum", what));
    std::vector<double> values;
    for (const Point& p : places_in(image, what, nodes, warnings)) {
        values.push_back(io::bilinear(image, p.x, p.y) / largest);
    }
    check_covered(values, what, nodes);
    return values;
}

/// From the map to the plane on which the nodes' distances are measured.
std::vector<Point> on_plane(std::vector<Point> points, const Nodes& nodes) {
    if (nodes.raster == nullptr) {
        for (Point& p : points) p = {p.x * nodes.unit_m, p.y * nodes.unit_m};
        return points;
    }
    const Placement& at = nodes.raster->placement;
    const Grid& grid = nodes.raster->grid;
    const double dx = grid.east_west[grid.rows / 2], dy = grid.north_south[(grid.rows - 1) / 2];
    const double south = at.north - grid.rows * at.cell_height;
    for (Point& p : points) p = {(p.x - at.west) / at.cell_width * dx, (p.y - south) / at.cell_height * dy};
    return points;
}

bool comes_near(const std::vector<std::vector<Point>>& lines, const evolve::Box& box, double reach_m) {
    for (const std::vector<Point>& line : lines) {
        if (line.empty()) continue;
        const evolve::Box own = evolve::bounding_box(line);
        const bool beside = own.high.x + reach_m < box.low.x || own.low.x - reach_m > box.high.x;
        const bool above = own.high.y + reach_m < box.low.y || own.low.y - reach_m > box.high.y;
        if (!beside && !above) return true;
    }
    return false;
}

evolve::Corridor corridor(const std::string& key, const std::filesystem::path& path, double width_m, double value,
                          const Nodes& nodes) {
    io::VectorShapes shapes = io::read_vectors(path, {.layers = {"links"}, .crs_wkt = nodes.crs_wkt});
    if (shapes.lines.empty()) throw Error(fmt::format("{}: {} holds no lines", key, path.string()));
    evolve::Corridor result{.lines = {}, .width_m = width_m, .value = value};
    for (std::vector<Point>& line : shapes.lines) result.lines.push_back(on_plane(std::move(line), nodes));
    if (comes_near(result.lines, nodes.box_m, width_m / 2)) return result;
    throw Error(fmt::format("{}: no line of {} comes near the domain: are they in the same coordinate system?", key,
                            path.string()));
}

double one_or_each(const std::string& key, const std::vector<double>& values, std::size_t file, std::size_t files) {
    if (values.size() == 1) return values[0];
    if (values.size() == files) return values[file];
    throw Error(fmt::format("{} needs one number, or one for each of the {} files of lines, not {}", key, files,
                            values.size()));
}

std::vector<double> painted(const std::string& table, const Variation& v, const Nodes& nodes) {
    std::vector<evolve::Corridor> corridors;
    for (std::size_t i = 0; i < v.lines.size(); ++i) {
        const double width = one_or_each(table + ".lines_width_m", v.lines_width_m, i, v.lines.size());
        const double value = one_or_each(table + ".lines_value", v.lines_value, i, v.lines.size());
        corridors.push_back(corridor(table + ".lines", v.lines[i], width, value, nodes));
    }
    return evolve::corridor_values(corridors, nodes.plane_m);
}

void check_lines(const std::string& table, const Variation& v) {
    if (v.lines.empty() && (!v.lines_width_m.empty() || !v.lines_value.empty())) {
        throw Error(fmt::format("{0}.lines_width_m and {0}.lines_value need {0}.lines, a vector file", table));
    }
}

void multiply(std::vector<double>& values, const std::vector<double>& by) {
    for (std::size_t i = 0; i < values.size(); ++i) values[i] *= by[i];
}

/// Value of the cell with data nearest to a place, if its centre lies within two cells; NaN else. Cells are data where
/// their centres lie in an outline, so along the outline itself many cells are not.
double nearest_value(const io::Image& image, const Point& place) {
    constexpr int reach = 2;
    double value = std::numeric_limits<double>::quiet_NaN();
    double least = reach;
    const double col = std::floor(place.x), row = std::floor(place.y);
    for (double r = std::max(0.0, row - reach); r <= std::min(image.rows - 1.0, row + reach); ++r) {
        for (double c = std::max(0.0, col - reach); c <= std::min(image.cols - 1.0, col + reach); ++c) {
            const double z = image.values[static_cast<std::size_t>(r) * image.cols + static_cast<std::size_t>(c)];
            const double distance = std::hypot(c + 0.5 - place.x, r + 0.5 - place.y);
            if (std::isnan(z) || !(distance <= least)) continue;
            least = distance;
            value = z;
        }
    }
    return value;
}

}  // namespace

std::vector<double> image_at(const std::string& key, const std::filesystem::path& path, const Nodes& nodes,
                             std::vector<std::string>& warnings) {
    const io::Image image = io::read_image(path);
    const std::string what = fmt::format("{}: {}", key, path.string());
    std::vector<double> values;
    for (const Point& p : places_in(image, what, nodes, warnings)) {
        const double value = io::bilinear(image, p.x, p.y);
        values.push_back(std::isnan(value) ? nearest_value(image, p) : value);
    }
    check_covered(values, what, nodes);
    return values;
}

std::vector<double> varied(const std::string& table, const Variation& v, double maximum, std::uint64_t seed,
                           const Nodes& nodes, std::vector<std::string>& warnings) {
    check_lines(table, v);
    const evolve::Shape shape{.pattern = v.pattern,
                              .direction_deg = v.direction_deg,
                              .steps = static_cast<int>(v.steps),
                              .variant = v.noise,
                              .noise_scale = v.noise_scale,
                              .seed = seed};
    std::vector<double> values = evolve::pattern_values(shape, nodes.box_m, nodes.plane_m);
    if (v.field) multiply(values, relative_image_at(table + ".field", *v.field, nodes, warnings));
    if (!v.lines.empty()) multiply(values, painted(table, v, nodes));
    for (std::size_t i = 0; i < values.size(); ++i) values[i] = nodes.inside[i] ? values[i] * maximum : 0;
    return values;
}

std::vector<double> relative_erodibility(const Experiment& e, const Nodes& nodes, std::vector<std::string>& warnings) {
    if (!e.river.k_field) return {};
    std::vector<double> values = relative_image_at("river.k_field", *e.river.k_field, nodes, warnings);
    for (std::size_t i = 0; i < values.size(); ++i) values[i] = nodes.inside[i] ? values[i] : 1;
    return values;
}

std::vector<double> initial_surface(const Experiment& e, const Nodes& nodes, double extent_m, double base_level_m,
                                    std::vector<std::string>& warnings) {
    const std::size_t count = nodes.plane_m.size();
    std::vector<double> heights;
    if (e.initial.elevation) {
        heights = image_at("initial.elevation", *e.initial.elevation, nodes, warnings);
    } else {
        heights = e.initial.noise == NoiseKind::perlin
                      ? evolve::perlin_surface(nodes.plane_m, extent_m, e.initial.amplitude_m, e.seed)
                      : evolve::uniform_surface(count, e.initial.amplitude_m, e.seed);
        for (double& height : heights) height = base_level_m + (e.initial.constant_m + height);
    }
    for (std::size_t i = 0; i < count; ++i) {
        if (!nodes.inside[i]) heights[i] = std::numeric_limits<double>::quiet_NaN();
    }
    return heights;
}

}  // namespace thalweg::study
