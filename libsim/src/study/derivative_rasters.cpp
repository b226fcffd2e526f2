// SPDX-License-Identifier: GPL-3.0-or-later
#include "study/derivative_rasters.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "thalweg/core/error.hpp"
#include "thalweg/io/dem_processing.hpp"
#include "thalweg/surface/hillshade.hpp"
#include "thalweg/terrain/derivatives.hpp"

namespace thalweg::study {
namespace {

constexpr double degrees = 180 / std::numbers::pi;

double cell_size(const Grid& grid) {
    const double height = grid.north_south.empty() ? mean(grid.east_west) : mean(grid.north_south);
    return std::sqrt(mean(grid.east_west) * height);
}

/// Quantiles, shares ascending, interpolated as core's: each is looked for above the last only, without sorting.
std::vector<double> quantiles(std::vector<double> values, std::span<const double> shares) {
    std::vector<double> found;
    auto from = values.begin();
    for (const double share : shares) {
        const double place = share * static_cast<double>(values.size() - 1);
        const auto below = values.begin() + static_cast<std::ptrdiff_t>(place);
        std::nth_element(from, below, values.end());
        const double above = below + 1 == values.end() ? *below : *std::min_element(below + 1, values.end());
        found.push_back(*below + (place - std::floor(place)) * (above - *below));
        from = below;
    }
    return found;
}

/// Mean and spread by area, quantiles by cells.
Json spread_json(const Grid& grid, const std::vector<double>& values) {
    constexpr std::array names{"q05", "q25", "median", "q75", "q95"};
    constexpr std::array shares{0.05, 0.25, 0.5, 0.75, 0.95};
    double area = 0, sum = 0, squares = 0;
    std::vector<double> known;
    for (Index node = 0; node < grid.size(); ++node) {
        if (std::isnan(values[node])) continue;
        known.push_back(values[node]);
        area += grid.area(node);
        sum += grid.area(node) * values[node];
    }
    const double center = sum / area;
    for (Index node = 0; node < grid.size(); ++node) {
        const double off = values[node] - center;
        if (!std::isnan(off)) squares += grid.area(node) * off * off;
    }
    Json json{{"cells", known.size()}, {"mean", number(center)}, {"sd", number(std::sqrt(squares / area))}};
    const bool none_known = known.empty();
    const std::vector<double> at = none_known ? std::vector<double>{} : quantiles(std::move(known), shares);
    for (std::size_t i = 0; i < names.size(); ++i) json[names[i]] = none_known ? Json(nullptr) : number(at[i]);
    return json;
}

/// Directions have no mean but that of their unit vectors; shares of the eight winds from north clockwise.
Json aspect_json(const Grid& grid, const std::vector<double>& aspect_rad) {
    double area = 0, north = 0, east = 0;
    std::size_t cells = 0;
    std::array<double, 8> winds{};
    for (Index node = 0; node < grid.size(); ++node) {
        const double angle = aspect_rad[node];
        if (std::isnan(angle)) continue;
        ++cells;
        area += grid.area(node);
        north += grid.area(node) * std::cos(angle);
        east += grid.area(node) * std::sin(angle);
        winds[static_cast<std::size_t>(std::floor(angle / (std::numbers::pi / 4) + 0.5)) % 8] += grid.area(node);
    }
    const double turned = std::atan2(east, north) * degrees;
    Json shares = Json::array();
    for (const double wind : winds) shares.push_back(number(wind / area));
    return {{"cells", cells},
            {"mean_direction_deg", cells > 0 ? Json(turned < 0 ? turned + 360 : turned) : Json(nullptr)},
            {"resultant_length", number(std::hypot(east, north) / area)},
            {"wind_shares", shares}};
}

/// Grey values 1 to 255, as GDAL's hillshade has them; NaN stays.
std::vector<double> greys(std::vector<double> light) {
    for (double& each : light) each = std::isnan(each) ? each : 1 + std::round(254 * each);
    return light;
}

}  // namespace

double default_relief_radius(const Grid& grid) { return rounded_to_1_2_5(10 * cell_size(grid)); }

Json write_derivatives(const Raster& dem, const DerivativeOptions& options, const std::filesystem::path& folder) {
    const Grid& grid = dem.grid;
    const double radius = options.relief_radius_m.value_or(default_relief_radius(grid));
    const double least = grid.north_south.empty() ? grid.east_west.front() : grid.north_south.front();
    if (radius < least) {
        throw Error(
            fmt::format("--relief-radius-m {:g} is less than a cell of {:.3g} m: give at least that", radius, least));
    }
    const auto write = [&](const char* name, const char* description, const std::vector<double>& values) {
        io::write_raster(folder / name, grid, dem.placement, values, {.nodata = {}, .description = description});
    };
    Json json = Json::object();
    const auto keep = [&](const char* key, const char* name, const char* description,
                          const std::vector<double>& values) {
        write(name, description, values);
        json[key] = spread_json(grid, values);
    };
    keep("slope", "slope.tif", "slope (m/m)", terrain::slope(grid, dem.values));
    std::vector<double> facing = terrain::aspect(grid, dem.values);
    json["aspect"] = aspect_json(grid, facing);
    for (double& each : facing) each *= degrees;
    write("aspect.tif", "direction of steepest descent (degrees clockwise from north)", facing);
    keep("profile_curvature_per_m", "profile_curvature.tif", "profile curvature (1/m), convex positive",
         terrain::profile_curvature(grid, dem.values));
    keep("plan_curvature_per_m", "plan_curvature.tif", "plan curvature (1/m), divergent positive",
         terrain::plan_curvature(grid, dem.values));
    keep("roughness_m", "roughness.tif", "roughness (m): range of the 3 x 3 cells", io::roughness(dem));
    keep("local_relief_m", "local_relief.tif", "local relief (m)", terrain::local_relief(grid, dem.values, radius));
    json["relief_radius_m"] = radius;
    io::write_raster(folder / "hillshade.tif", grid, dem.placement, greys(surface::hillshade(dem)),
                     {.type = io::CellType::uint8, .nodata = 0, .description = "hillshade (1 dark to 255 light)"});
    return json;
}

}  // namespace thalweg::study
