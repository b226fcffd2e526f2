// SPDX-License-Identifier: GPL-3.0-or-later
#include "thalweg/io/heightmap.hpp"

#include <gdal_priv.h>

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <limits>

#include "io/file_limit.hpp"
#include "support/temp_folder.hpp"
#include "thalweg/core/random.hpp"
#include "thalweg/io/raster_file.hpp"

using namespace thalweg;
using test::bytes_of;
using test::error_of;
using test::is_sentence;
using test::TempFolder;

namespace {

const double no_data = std::numeric_limits<double>::quiet_NaN();

Raster raster_of(Index rows, Index cols, std::vector<double> values) {
    return {.grid = plane_grid(rows, cols, 30, 20),
            .placement = {.west = 1000, .north = 5000, .cell_width = 30, .cell_height = 20, .crs_wkt = {}},
            .values = std::move(values)};
}

struct Counts {
    std::vector<std::uint16_t> values;
    int bits = 0;
    int bands = 0;
};

Counts read_counts(const std::filesystem::path& path) {
    GDALAllRegister();
    const GDALDatasetUniquePtr file(GDALDataset::Open(path.c_str(), GDAL_OF_RASTER));
    REQUIRE(file);
    Counts counts;
    counts.bands = file->GetRasterCount();
    counts.bits = GDALGetDataTypeSizeBits(file->GetRasterBand(1)->GetRasterDataType());
    const int cols = file->GetRasterXSize(), rows = file->GetRasterYSize();
    counts.values.resize(static_cast<std::size_t>(cols) * rows);
    REQUIRE(file->GetRasterBand(1)->RasterIO(GF_Read, 0, 0, cols, rows, counts.values.data(), cols, rows, GDT_UInt16, 0,
                                             0, nullptr) == CE_None);
    return counts;
}

}  // namespace

TEST_CASE("A heightmap runs from 1 at the lowest to 65535 at the highest, and 0 is no data") {
    const TempFolder folder;
    const auto scale = io::write_heightmap(folder / "e.png", raster_of(2, 3, {100, 65634, no_data, 101, 132.4, 132.6}));
    CHECK(scale.metres_per_count == 1);
    CHECK(scale.offset_m == 99);
    const Counts counts = read_counts(folder / "e.png");
    CHECK(counts.bits == 16);
    CHECK(counts.bands == 1);
    CHECK(counts.values == std::vector<std::uint16_t>{1, 65535, 0, 2, 33, 34});
}

TEST_CASE("Heights come back from their counts to half a count") {
    for (std::uint64_t seed = 1; seed <= 20; ++seed) {
        const TempFolder folder;
        Random random(seed, 0);
        std::vector<double> heights(30 * 40);
        const double relief = std::pow(10.0, 6 * random.uniform() - 2);
        for (double& h : heights) h = -400 + relief * random.uniform();
        const auto scale = io::write_heightmap(folder / "e.png", raster_of(30, 40, heights));
        const Counts counts = read_counts(folder / "e.png");
        for (std::size_t i = 0; i < heights.size(); ++i) {
            const double back = scale.offset_m + counts.values[i] * scale.metres_per_count;
            REQUIRE(std::abs(back - heights[i]) <= 0.500001 * scale.metres_per_count);
        }
        CHECK(*std::max_element(counts.values.begin(), counts.values.end()) == 65535);
        CHECK(*std::min_element(counts.values.begin(), counts.values.end()) == 1);
    }
}

TEST_CASE("A flat heightmap is all ones") {
    const TempFolder folder;
    const auto scale = io::write_heightmap(folder / "e.png", raster_of(1, 2, {7, 7}));
    CHECK(scale.offset_m + scale.metres_per_count == 7);
    CHECK(read_counts(folder / "e.png").values == std::vector<std::uint16_t>{1, 1});
}

TEST_CASE("The world file beside it gives the cell's size and the centre of the first one") {
    const TempFolder folder;
    io::write_heightmap(folder / "e.png", raster_of(1, 2, {7, 8}));
    CHECK(bytes_of(folder / "e.wld") == "30\n0\n0\n-20\n1015\n4990\n");
    CHECK_FALSE(std::filesystem::exists(folder / "e.png.aux.xml"));
}

TEST_CASE("A heightmap without data, or one that cannot be written whole, is refused and leaves nothing") {
    const TempFolder folder;
    CHECK(is_sentence(error_of([&] { io::write_heightmap(folder / "e.png", raster_of(1, 2, {no_data, no_data})); })));
    CHECK(is_sentence(error_of([&] { io::write_heightmap(folder / "no/e.png", raster_of(1, 2, {1, 2})); })));
    std::vector<double> noise(300 * 300);
    Random random(1, 0);
    for (double& h : noise) h = random.uniform();
    const test::FileLimit limit(20000);
    CHECK(is_sentence(error_of([&] { io::write_heightmap(folder / "e.png", raster_of(300, 300, noise)); })));
    CHECK(folder.empty());
}

TEST_CASE("A cloud-optimized GeoTIFF says so, has overviews and reads back to the last bit") {
    const TempFolder folder;
    Random random(3, 0);
    std::vector<double> heights(700 * 900);
    for (double& h : heights) h = random.uniform() < 0.1 ? no_data : random.uniform() * 1000;
    const Raster raster = raster_of(700, 900, heights);
    io::write_raster(folder / "cog.tif", raster.grid, raster.placement, raster.values,
                     {.description = "elevation (m)", .layout = io::Layout::cloud_optimized});
    const GDALDatasetUniquePtr file(GDALDataset::Open((folder / "cog.tif").c_str(), GDAL_OF_RASTER));
    REQUIRE(file);
    CHECK(std::string(file->GetMetadataItem("LAYOUT", "IMAGE_STRUCTURE")) == "COG");
    CHECK(file->GetRasterBand(1)->GetOverviewCount() > 0);
    CHECK(std::string(file->GetRasterBand(1)->GetDescription()) == "elevation (m)");
    const Raster read = io::read_raster(folder / "cog.tif").raster;
    CHECK(read.placement.west == 1000);
    for (std::size_t i = 0; i < heights.size(); ++i) {
        REQUIRE((read.values[i] == heights[i] || (std::isnan(read.values[i]) && std::isnan(heights[i]))));
    }
    io::write_raster(folder / "again.tif", raster.grid, raster.placement, raster.values,
                     {.description = "elevation (m)", .layout = io::Layout::cloud_optimized});
    CHECK(bytes_of(folder / "again.tif") == bytes_of(folder / "cog.tif"));
}

TEST_CASE("A cloud-optimized GeoTIFF that the disk cannot hold is refused and leaves nothing") {
    const TempFolder folder;
    Random random(3, 0);
    std::vector<double> heights(600 * 600);
    for (double& h : heights) h = random.uniform();
    const Raster raster = raster_of(600, 600, heights);
    for (const std::size_t bytes : {1000u, 500000u, 2000000u}) {
        const test::FileLimit limit(bytes);
        CHECK(is_sentence(error_of([&] {
            io::write_raster(folder / "cog.tif", raster.grid, raster.placement, raster.values,
                             {.layout = io::Layout::cloud_optimized});
        })));
        CHECK(folder.empty());
    }
}
