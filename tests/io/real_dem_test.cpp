// SPDX-License-Identifier: GPL-3.0-or-later
#include <catch2/catch.hpp>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <numeric>
#include <vector>

#include "thalweg/io/geodesy.hpp"
#include "thalweg/io/polygonize.hpp"
#include "thalweg/io/raster_file.hpp"

using namespace thalweg;

namespace {

/// What is known of a file from its provenance page.
struct RealDem {
    std::string file;
    Index rows, cols;
    double void_percent;
    double lowest, highest;
    bool geographic;
    std::string crs;
    std::vector<std::string> warnings;  ///< a word of each, in order
};

const std::vector<RealDem> real_dems{
    {"big_tujunga_srtm_30m.tif", 643, 1197, 0, 315, 2295, false, "EPSG:32611", {}},
    {"shillong_plateau_50m.bil", 1056, 1800, 8.63, 2, 1964, false, "EPSG:32646", {}},
    {"mandakini_srtm_89m.bil", 648, 587, 45.24, 644, 6741, false, "EPSG:32644", {}},
    {"baspa_nasadem_30m.tif", 2287, 3129, 42.20, 1615, 6422, false, "EPSG:32646", {"for which that is made", "longer than on the ground"}},
    {"n42e001.hgt", 1201, 1201, 0.53, 349, 3100, true, "EPSG:4326", {"holes"}},
    {"n55w003.hgt", 1201, 1201, 0, -22, 816, true, "EPSG:4326", {"--nodata 0", "118 cells"}},
    {"n48w125.hgt.zip", 3601, 3601, 50.00, -13, 1095, true, "EPSG:4326", {"--nodata 0", "1208 cells", "holes"}},
    {"zion_srtm_3arcsec.tif", 457, 465, 0, 1024, 2892, true, "EPSG:4326", {}},
    {"front_range_srtmgl3.asc", 144, 240, 0, 1943, 3286, true, "EPSG:4326", {"taken as WGS 84"}},
    {"eno_river_third_arcsec.tif", 844, 715, 0, 177.97, 241.22, true, "NAD83", {}},
    {"raleigh_ned_30m.tif", 450, 500, 0, 55.17, 156.39, false, "Lambert Conformal Conic", {}},
    {"spearfish_usgs_30m.tif", 477, 634, 3.34, 1066, 1840, false, "EPSG:26713", {}},
    {"pozo_catchment_lidar_4m.tif", 741, 1149, 0, 0, 405.14, false, "EPSG:26911", {"--nodata 0"}},
    {"pozo_gully_lidar_1m.tif", 590, 654, 32.75, 25.58, 195.17, false, "EPSG:26911", {}},
    {"gabilan_mesa_lidar_1m.bil", 859, 921, 0, 187.90, 307.28, false, "EPSG:32611", {}},
    {"mount_st_helens_usgs_30m.dem", 468, 327, 2.71, 682, 2543, false, "EPSG:26710", {}},
};

/// Polygon around the grid with `points` edges along each parallel.
double extent_area(const Raster& raster, Index points) {
    const Placement& p = raster.placement;
    const double width = raster.grid.cols * p.cell_width;
    const double south = p.north - raster.grid.rows * p.cell_height;
    if (!p.geographic) return width * (p.north - south);
    Polygon ring;
    for (Index i = 0; i <= points; ++i) ring.push_back({p.west + width * i / points, south});
    for (Index i = 0; i <= points; ++i) ring.push_back({p.west + width - width * i / points, p.north});
    return io::geodesic_area(ring);
}

/// Positive where the ring runs counter-clockwise; measured from its first vertex to keep the digits.
double ring_area(const Polygon& ring) {
    double doubled = 0;
    for (std::size_t i = 0; i < ring.size(); ++i) {
        const Point& a = ring[i];
        const Point& b = ring[(i + 1) % ring.size()];
        doubled += (a.x - ring[0].x) * (b.y - ring[0].y) - (b.x - ring[0].x) * (a.y - ring[0].y);
    }
    return doubled / 2;
}

void check(const RealDem& known, const io::ReadResult& result) {
    const Raster& raster = result.raster;
    CHECK(raster.grid.rows == known.rows);
    CHECK(raster.grid.cols == known.cols);
    CHECK(raster.placement.geographic == known.geographic);
    CHECK(result.crs_name == known.crs);
    CHECK(result.vertical_unit_m == 1);
    double lowest = INFINITY;
    double highest = -INFINITY;
    std::size_t voids = 0;
    for (const double value : raster.values) {
        voids += std::isnan(value);
        lowest = std::fmin(lowest, value);
        highest = std::fmax(highest, value);
    }
    CHECK(lowest == Approx(known.lowest).margin(0.006));
    CHECK(highest == Approx(known.highest).margin(0.006));
    CHECK(100.0 * static_cast<double>(voids) / raster.grid.size() == Approx(known.void_percent).margin(0.006));
    const double area =
        raster.grid.cols * std::accumulate(raster.grid.cell_area.begin(), raster.grid.cell_area.end(), 0.0);
    CHECK(area == Approx(extent_area(raster, raster.grid.cols)).epsilon(1e-9));
    // The four corners alone: their geodesics leave the parallels, by 2.6e-5 of the area for a degree at 55 N.
    CHECK(area == Approx(extent_area(raster, 1)).epsilon(3e-5));
    REQUIRE(result.warnings.size() == known.warnings.size());
    for (std::size_t i = 0; i < known.warnings.size(); ++i) {
        CHECK_THAT(result.warnings[i], Catch::Matchers::Contains(known.warnings[i]));
    }
}

}  // namespace

TEST_CASE("every real DEM is read right, and says what is odd about it", "[real]") {
    const char* folder = std::getenv("THALWEG_DEM_DIR");
    if (folder == nullptr) {
        WARN("THALWEG_DEM_DIR is not set: no real DEM is read");
        return;
    }
    for (const RealDem& known : real_dems) {
        const std::filesystem::path path = std::filesystem::path(folder) / known.file;
        if (!std::filesystem::exists(path)) continue;
        CAPTURE(known.file);
        const io::ReadResult result = io::read_raster(path);
        UNSCOPED_INFO(Catch::StringMaker<std::vector<std::string>>::convert(result.warnings));
        check(known, result);
    }
}

TEST_CASE("outlines of the bands of height of real DEMs cover as much as their cells", "[real]") {
    const char* folder = std::getenv("THALWEG_DEM_DIR");
    if (folder == nullptr) {
        WARN("THALWEG_DEM_DIR is not set: no real DEM is outlined");
        return;
    }
    for (const char* file : {"pozo_gully_lidar_1m.tif", "spearfish_usgs_30m.tif", "big_tujunga_srtm_30m.tif"}) {
        INFO(file);
        const Raster raster = io::read_raster(std::filesystem::path(folder) / file, {}).raster;
        std::vector<Index> labels(raster.values.size(), none);
        std::vector<double> cells(100, 0);
        for (std::size_t i = 0; i < labels.size(); ++i) {
            if (std::isnan(raster.values[i])) continue;
            labels[i] = static_cast<Index>(raster.values[i] / 25);
            ++cells.at(labels[i]);
        }
        const std::vector<MultiPolygon> bands = io::cell_outlines(raster, labels, 100);
        for (Index band = 0; band < 100; ++band) {
            double area = 0;
            for (const PolygonPart& part : bands[band]) {
                area += ring_area(part.outer);
                for (const Polygon& hole : part.holes) area += ring_area(hole);
            }
            const double expected = cells[band] * raster.placement.cell_width * raster.placement.cell_height;
            CHECK(area == Approx(expected).epsilon(1e-9));
        }
    }
}
