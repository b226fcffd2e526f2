// SPDX-License-Identifier: GPL-3.0-or-later
// Derivatives beside GDAL's, and on the ellipsoid beside mathematics.
#include "thalweg/terrain/derivatives.hpp"

#include <gdal_priv.h>
#include <gdal_utils.h>

#include <algorithm>
#include <array>
#include <catch2/catch.hpp>
#include <cmath>
#include <functional>
#include <limits>
#include <numbers>

#include "support/terrains.hpp"
#include "thalweg/io/dem_processing.hpp"
#include "thalweg/io/geodesy.hpp"
#include "thalweg/io/raster_file.hpp"

using namespace thalweg;

namespace {

constexpr double pi = std::numbers::pi;
constexpr double nan = std::numeric_limits<double>::quiet_NaN();

/// Noise smoothed over three cells each way, with a few holes; small numbers, since GDAL works in single precision.
Raster rough_hills(Index rows, Index cols, double cell_m, std::uint64_t seed, double base_m) {
    const auto noise = support::noise_terrain(rows + 2, cols + 2, seed);
    Raster raster{plane_grid(rows, cols, cell_m, cell_m), {}, {}};
    raster.placement.cell_width = raster.placement.cell_height = cell_m;
    Random random(seed, 5);
    for (Index row = 0; row < rows; ++row) {
        for (Index col = 0; col < cols; ++col) {
            double sum = 0;
            for (Index i = 0; i < 9; ++i) sum += noise.elevation_m[(row + i / 3) * (cols + 2) + col + i % 3];
            raster.values.push_back(random.uniform() < 0.01 ? nan : base_m + 10 * sum);
        }
    }
    return raster;
}

/// What `gdaldem` makes of a raster on a plane in metres.
std::vector<double> by_gdal(const Raster& raster, const char* process, std::vector<const char*> words) {
    GDALAllRegister();
    const int cols = static_cast<int>(raster.grid.cols), rows = static_cast<int>(raster.grid.rows);
    GDALDataset* source =
        GetGDALDriverManager()->GetDriverByName("MEM")->Create("", cols, rows, 1, GDT_Float64, nullptr);
    std::array<double, 6> transform{0, raster.grid.east_west[0], 0, 0, 0, -raster.grid.north_south[0]};
    source->SetGeoTransform(transform.data());
    source->GetRasterBand(1)->SetNoDataValue(nan);
    std::vector<double> values = raster.values;
    REQUIRE(source->GetRasterBand(1)->RasterIO(GF_Write, 0, 0, cols, rows, values.data(), cols, rows, GDT_Float64, 0, 0,
                                               nullptr) == CE_None);
    words.insert(words.begin(), {"-of", "MEM"});
    words.push_back(nullptr);
    GDALDEMProcessingOptions* options = GDALDEMProcessingOptionsNew(const_cast<char**>(words.data()), nullptr);
    GDALDataset* result = GDALDataset::FromHandle(GDALDEMProcessing("", source, process, nullptr, options, nullptr));
    REQUIRE(result != nullptr);
    REQUIRE(result->GetRasterBand(1)->RasterIO(GF_Read, 0, 0, cols, rows, values.data(), cols, rows, GDT_Float64, 0, 0,
                                               nullptr) == CE_None);
    for (double& value : values) value = value == -9999 ? nan : value;
    GDALDEMProcessingOptionsFree(options);
    GDALClose(result);
    GDALClose(source);
    return values;
}

/// Heights on degrees around a place, as a function of longitude and latitude (degrees).
using OnEarth = std::function<double(double lon, double lat)>;

struct Tile {
    Grid grid;
    std::vector<double> height, lon, lat;
};

Tile tile(double lon, double lat, double side_deg, Index cells, const OnEarth& height) {
    const double step = side_deg / cells;
    Tile t{io::geographic_grid(cells, cells, lat + side_deg / 2, step, step), {}, {}, {}};
    for (Index node = 0; node < t.grid.size(); ++node) {
        t.lon.push_back(lon - side_deg / 2 + (t.grid.col(node) + 0.5) * step);
        t.lat.push_back(lat + side_deg / 2 - (t.grid.row(node) + 0.5) * step);
        t.height.push_back(height(t.lon.back(), t.lat.back()));
    }
    return t;
}

double worst(const Tile& t, const std::vector<double>& found, const OnEarth& truth) {
    double largest = 0;
    for (Index node = 0; node < t.grid.size(); ++node) {
        if (!std::isnan(found[node]))
            largest = std::max(largest, std::abs(found[node] - truth(t.lon[node], t.lat[node])));
    }
    REQUIRE(largest > 0);
    return largest;
}

/// Radii of curvature of WGS 84: of the meridian, and of the parallel.
struct Radii {
    double meridian, parallel;
};

Radii radii(double lat_deg) {
    constexpr double a = 6378137, f = 1 / 298.257223563, e2 = f * (2 - f);
    const double sine = std::sin(lat_deg * pi / 180), w = std::sqrt(1 - e2 * sine * sine);
    return {a * (1 - e2) / (w * w * w), a / w * std::cos(lat_deg * pi / 180)};
}

}  // namespace

TEST_CASE("Slope, aspect and roughness are GDAL's on square cells of a plane", "[derivatives]") {
    for (std::uint64_t seed = 0; seed < 6; ++seed) {
        const Raster raster = rough_hills(40, 55, 30, seed, 0);
        const auto slope = terrain::slope(raster.grid, raster.values),
                   aspect = terrain::aspect(raster.grid, raster.values);
        const auto gdal_slope = by_gdal(raster, "slope", {"-p"}), gdal_aspect = by_gdal(raster, "aspect", {});
        const auto roughness = io::roughness(raster), gdal_roughness = by_gdal(raster, "roughness", {});
        for (Index node = 0; node < raster.grid.size(); ++node) {
            REQUIRE(std::isnan(slope[node]) == std::isnan(gdal_slope[node]));
            REQUIRE(std::isnan(roughness[node]) == std::isnan(gdal_slope[node]));
            if (std::isnan(slope[node])) continue;
            CHECK(slope[node] == Approx(gdal_slope[node] / 100).epsilon(1e-4));
            CHECK(std::abs(std::remainder(aspect[node] - gdal_aspect[node] * pi / 180, 2 * pi)) < 1e-3);
            CHECK(roughness[node] == Approx(gdal_roughness[node]).margin(1e-3));
        }
    }
}

TEST_CASE("Roughness on high land keeps its digits, and is the range of the nine cells", "[derivatives]") {
    Raster raster = rough_hills(20, 30, 1, 1, 8000);
    for (double& value : raster.values) value += 1e-3 * std::sin(value);
    const auto found = io::roughness(raster);
    for (Index row = 1; row + 1 < 20; ++row) {
        for (Index col = 1; col + 1 < 30; ++col) {
            double low = raster.values[row * 30 + col], high = low, holes = 0;
            for (Index i = 0; i < 9; ++i) {
                const double z = raster.values[(row + i / 3 - 1) * 30 + col + i % 3 - 1];
                holes += std::isnan(z);
                low = std::min(low, z);
                high = std::max(high, z);
            }
            if (holes > 0)
                CHECK(std::isnan(found[row * 30 + col]));
            else
                CHECK(found[row * 30 + col] == Approx(high - low).margin(2e-5));
        }
    }
    CHECK(std::isnan(io::roughness({plane_grid(2, 2, 1, 1), {}, {1, 2, 3, 4}})[0]));
}

TEST_CASE("On degrees, slope and aspect are those of the ellipsoid to the square of the cell", "[derivatives]") {
    for (const double latitude : {-65.0, 3.0, 46.0, 72.0}) {
        constexpr double k = 2 * pi / 0.2;  // waves of a fifth of a degree
        const OnEarth height = [](double lon, double lat) { return 900 * std::sin(k * lon) * std::cos(0.7 * k * lat); };
        const auto gradient = [](double lon, double lat) {
            const Radii r = radii(lat);
            constexpr double per_radian = 180 / pi;
            return std::array{900 * k * per_radian * std::cos(k * lon) * std::cos(0.7 * k * lat) / r.parallel,
                              -900 * 0.7 * k * per_radian * std::sin(k * lon) * std::sin(0.7 * k * lat) / r.meridian};
        };
        const OnEarth steep = [&](double lon, double lat) {
            const auto [east, north] = gradient(lon, lat);
            return std::hypot(east, north);
        };
        const auto slope_error = [&](Index cells) {
            const Tile t = tile(11, latitude, 0.3, cells, height);
            return worst(t, terrain::slope(t.grid, t.height), steep);
        };
        const auto aspect_error = [&](Index cells) {
            const Tile t = tile(11, latitude, 0.3, cells, height);
            const auto found = terrain::aspect(t.grid, t.height);
            double largest = 0;
            for (Index node = 0; node < t.grid.size(); ++node) {
                const auto [east, north] = gradient(t.lon[node], t.lat[node]);
                if (std::isnan(found[node]) || std::hypot(east, north) < 0.2 * 900 * k * 180 / pi / 6.4e6) continue;
                largest = std::max(largest, std::abs(std::remainder(found[node] - std::atan2(-east, -north), 2 * pi)));
            }
            return largest;
        };
        INFO(latitude);
        CHECK(std::log2(slope_error(100) / slope_error(200)) == Approx(2).margin(0.15));
        CHECK(std::log2(aspect_error(100) / aspect_error(200)) == Approx(2).margin(0.3));
        CHECK(slope_error(200) < 1e-3 * 900 * k * 180 / pi / radii(latitude).parallel);
    }
}

TEST_CASE("Curvatures on degrees are those of the same surface on a plane", "[derivatives]") {
    // Quadrics in the metres of an equal-area plane about the tile's middle, where it is true to scale.
    for (const double latitude : {-40.0, 0.5, 60.0, 82.0}) {
        const io::LocalPlane plane{20, latitude};
        const double a = 0.3, b = -0.4, r = 2e-4, s = -1e-4, t = 3e-4;
        const OnEarth height = [&](double lon, double lat) {
            const auto [x, y] = io::to_plane(plane, {{lon, lat}}).front();
            return a * x + b * y + 0.5 * (r * x * x + 2 * s * x * y + t * y * y);
        };
        const Tile tilted = tile(20, latitude, 0.005, 25, height);
        const Index middle = 12 * 25 + 12;
        const double steep = a * a + b * b;
        CHECK(terrain::slope(tilted.grid, tilted.height)[middle] == Approx(std::sqrt(steep)).epsilon(1e-6));
        CHECK(terrain::profile_curvature(tilted.grid, tilted.height)[middle] ==
              Approx(-(a * a * r + 2 * a * b * s + b * b * t) / (steep * std::pow(1 + steep, 1.5))).epsilon(1e-4));
        CHECK(terrain::plan_curvature(tilted.grid, tilted.height)[middle] ==
              Approx(-(b * b * r - 2 * a * b * s + a * a * t) / std::pow(steep, 1.5)).epsilon(1e-4));
    }
}

TEST_CASE("A plane near the pole is no curved surface because its parallels are bent", "[derivatives]") {
    const io::LocalPlane plane{0, 85};
    const OnEarth height = [&](double lon, double lat) {
        const auto [x, y] = io::to_plane(plane, {{lon, lat}}).front();
        return 0.5 * x + 0.8 * y;
    };
    const Tile t = tile(0, 85, 0.01, 21, height);
    // Without the bend of the parallels: the gradient times tan 85° over the earth's radius, 1.5e-6 per metre.
    CHECK(std::abs(terrain::plan_curvature(t.grid, t.height)[10 * 21 + 10]) < 3e-9);
    CHECK(std::abs(terrain::profile_curvature(t.grid, t.height)[10 * 21 + 10]) < 3e-9);
}

TEST_CASE("Local relief on degrees looks as far in metres east as north", "[derivatives]") {
    const OnEarth east = [](double lon, double) { return 1000 * lon; };
    const OnEarth north = [](double, double lat) { return 1000 * lat; };
    const double radius = 3000;
    for (const auto& [height, per_metre] :
         {std::pair{east, 1000 * 180 / pi / radii(60).parallel}, {north, 1000 * 180 / pi / radii(60).meridian}}) {
        const Tile t = tile(5, 60, 0.2, 401, height);
        const double found = terrain::local_relief(t.grid, t.height, radius)[200 * 401 + 200];
        CHECK(found == Approx(2 * radius * per_metre).epsilon(0.02));
        CHECK(found <= 2 * radius * per_metre * (1 + 1e-4));
    }
}
