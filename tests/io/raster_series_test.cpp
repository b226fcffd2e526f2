// SPDX-License-Identifier: GPL-3.0-or-later
#include <gdal_priv.h>
#include <ogr_spatialref.h>

#include <catch2/catch.hpp>
#include <cmath>
#include <limits>
#include <thread>

#include "file_limit.hpp"
#include "support/temp_folder.hpp"
#include "thalweg/core/error.hpp"
#include "thalweg/core/random.hpp"
#include "thalweg/io/raster_series.hpp"

using namespace thalweg;
using test::error_of;
using test::TempFolder;

namespace {

constexpr double nan = std::numeric_limits<double>::quiet_NaN();

std::string wkt_of(int epsg) {
    OGRSpatialReference crs;
    crs.importFromEPSG(epsg);
    char* text = nullptr;
    crs.exportToWkt(&text);
    std::string wkt = text;
    CPLFree(text);
    return wkt;
}

Raster raster(Index rows, Index cols, std::uint64_t number, const std::string& wkt = "") {
    Raster r{
        plane_grid(rows, cols, 30, 20),
        {.west = 500000, .north = 4100000, .cell_width = 30, .cell_height = 20, .crs_wkt = wkt, .geographic = false},
        {}};
    for (Index node = 0; node < r.grid.size(); ++node) r.values.push_back(1000 * uniform_at(number, 1, node));
    r.values[1] = nan;
    return r;
}

io::RasterSeries series(std::size_t count, const std::string& wkt = "", Index rows = 7, Index cols = 9) {
    io::RasterSeries s{.time_yr = {}, .elevation_m = {}, .title = "Test", .source = "thalweg"};
    for (std::size_t i = 0; i < count; ++i) s.time_yr.push_back(1e5 * static_cast<double>(i));
    s.elevation_m = [=](std::size_t i) { return raster(rows, cols, i, wkt); };
    return s;
}

using Group = std::shared_ptr<GDALGroup>;

std::string text(const Group& root, const char* array, const char* attribute) {
    const auto found = root->OpenMDArray(array)->GetAttribute(attribute);
    return found ? found->ReadAsString() : "(none)";
}

struct Opened {
    std::unique_ptr<GDALDataset> dataset;
    Group root;
};

Opened open(const std::filesystem::path& path) {
    GDALAllRegister();
    Opened o;
    o.dataset.reset(GDALDataset::Open(path.c_str(), GDAL_OF_MULTIDIM_RASTER));
    REQUIRE(o.dataset);
    o.root = o.dataset->GetRootGroup();
    return o;
}

}  // namespace

TEST_CASE(
    "A netCDF holds every raster at its time, with the coordinates of the cells' centres, after the conventions") {
    const TempFolder temp;
    io::write_netcdf(temp / "s.nc", series(4, wkt_of(32611)));
    const Opened o = open(temp / "s.nc");
    CHECK(std::string(o.root->GetAttribute("Conventions")->ReadAsString()) == "CF-1.8");
    const auto elevation = o.root->OpenMDArray("elevation");
    REQUIRE(elevation);
    REQUIRE(elevation->GetDimensionCount() == 3);
    CHECK(elevation->GetDimensions()[0]->GetName() == "time");
    CHECK(elevation->GetDimensions()[1]->GetName() == "y");
    CHECK(elevation->GetDimensions()[2]->GetName() == "x");
    CHECK(elevation->GetUnit() == "m");
    CHECK(text(o.root, "elevation", "standard_name") == "surface_altitude");
    CHECK(o.root->OpenMDArray("time")->GetUnit() == "year");
    CHECK(text(o.root, "time", "axis") == "T");
    CHECK(text(o.root, "x", "standard_name") == "projection_x_coordinate");
    CHECK(text(o.root, "y", "standard_name") == "projection_y_coordinate");
    CHECK(o.root->OpenMDArray("x")->GetUnit() == "m");
    const auto crs = elevation->GetSpatialRef();
    REQUIRE(crs);
    CHECK(std::string(crs->GetAuthorityCode(nullptr)) == "32611");

    const auto type = GDALExtendedDataType::Create(GDT_Float64);
    std::vector<double> x(9), y(7), time(4), values(63);
    const GUInt64 zero = 0;
    const auto read = [&](const char* name, std::vector<double>& into) {
        const size_t count = into.size();
        REQUIRE(o.root->OpenMDArray(name)->Read(&zero, &count, nullptr, nullptr, type, into.data()));
    };
    read("x", x);
    read("y", y);
    read("time", time);
    CHECK(x[0] == 500015);
    CHECK(x[8] == 500255);
    CHECK(y[0] == 4099990);
    CHECK(y[6] == 4099870);
    CHECK(time == std::vector<double>{0, 1e5, 2e5, 3e5});
    for (std::uint64_t i = 0; i < 4; ++i) {
        const GUInt64 start[] = {i, 0, 0};
        const size_t count[] = {1, 7, 9};
        REQUIRE(elevation->Read(start, count, nullptr, nullptr, type, values.data()));
        const Raster expected = raster(7, 9, i);
        for (std::size_t cell = 0; cell < values.size(); ++cell) {
            if (cell == 1) CHECK(std::isnan(values[cell]));
            if (cell != 1) CHECK(values[cell] == expected.values[cell]);
        }
    }
}

TEST_CASE("As a plain raster a netCDF lies where the GeoTIFF lies, one band per time") {
    const TempFolder temp;
    io::write_netcdf(temp / "s.nc", series(3, wkt_of(32611)));
    GDALAllRegister();
    const std::unique_ptr<GDALDataset> dataset(GDALDataset::Open((temp / "s.nc").c_str(), GDAL_OF_RASTER));
    REQUIRE(dataset);
    CHECK(dataset->GetRasterCount() == 3);
    double transform[6];
    REQUIRE(dataset->GetGeoTransform(transform) == CE_None);
    CHECK(transform[0] == 500000);
    CHECK(transform[1] == 30);
    CHECK(transform[3] == 4100000);
    CHECK(transform[5] == -20);
    double value = 0;
    REQUIRE(dataset->GetRasterBand(3)->RasterIO(GF_Read, 4, 0, 1, 1, &value, 1, 1, GDT_Float64, 0, 0) == CE_None);
    CHECK(value == raster(7, 9, 2).values[4]);
}

TEST_CASE("A netCDF nowhere on the earth has plain axes, one in degrees longitude and latitude, one in feet says so") {
    const TempFolder temp;
    io::write_netcdf(temp / "plain.nc", series(2));
    const Opened plain = open(temp / "plain.nc");
    CHECK(plain.root->OpenMDArray("x")->GetUnit() == "m");
    CHECK(text(plain.root, "x", "standard_name") == "(none)");
    io::write_netcdf(temp / "feet.nc", series(1, wkt_of(2225)));
    CHECK(open(temp / "feet.nc").root->OpenMDArray("x")->GetUnit() == "US_survey_foot");

    io::RasterSeries degrees = series(1);
    degrees.elevation_m = [](std::size_t) {
        Raster r = raster(7, 9, 0, wkt_of(4326));
        r.placement = {.west = -120,
                       .north = 40,
                       .cell_width = 0.5,
                       .cell_height = 0.25,
                       .crs_wkt = wkt_of(4326),
                       .geographic = true};
        return r;
    };
    io::write_netcdf(temp / "degrees.nc", degrees);
    const Opened geographic = open(temp / "degrees.nc");
    CHECK(geographic.root->OpenMDArray("lon")->GetUnit() == "degrees_east");
    CHECK(geographic.root->OpenMDArray("lat")->GetUnit() == "degrees_north");
    CHECK(text(geographic.root, "lat", "standard_name") == "latitude");
}

TEST_CASE("The bytes of a netCDF and of a picture are a function of the values alone") {
    const TempFolder temp;
    const std::vector<std::uint8_t> pixels(4 * 63, 77);
    io::write_netcdf(temp / "a.nc", series(5));
    io::write_png(temp / "a.png", 7, 9, pixels);
    std::this_thread::sleep_for(std::chrono::milliseconds(1100));  // so that a clock in the file would show
    io::write_netcdf(temp / "b.nc", series(5));
    io::write_png(temp / "b.png", 7, 9, pixels);
    CHECK(test::bytes_of(temp / "a.nc") == test::bytes_of(temp / "b.nc"));
    CHECK(test::bytes_of(temp / "a.png") == test::bytes_of(temp / "b.png"));
}

TEST_CASE("A picture gives back its pixels") {
    const TempFolder temp;
    std::vector<std::uint8_t> pixels;
    for (int i = 0; i < 4 * 5 * 3; ++i) pixels.push_back(static_cast<std::uint8_t>(i * 37));
    io::write_png(temp / "p.png", 5, 3, pixels);
    GDALAllRegister();
    const std::unique_ptr<GDALDataset> dataset(GDALDataset::Open((temp / "p.png").c_str(), GDAL_OF_RASTER));
    REQUIRE(dataset);
    CHECK(dataset->GetRasterXSize() == 3);
    std::vector<std::uint8_t> back(pixels.size());
    REQUIRE(dataset->RasterIO(GF_Read, 0, 0, 3, 5, back.data(), 3, 5, GDT_Byte, 4, nullptr, 4, 12, 1) == CE_None);
    CHECK(back == pixels);
    CHECK(error_of([&] { io::write_png(temp / "q.png", 5, 4, pixels); }).find("bytes") != std::string::npos);
}

TEST_CASE("A series or a picture that cannot be written whole leaves nothing") {
    const TempFolder temp;
    CHECK_FALSE(error_of([&] { io::write_netcdf(temp / "no/such.nc", series(2)); }).empty());
    CHECK_FALSE(
        error_of([&] { io::write_png(temp / "no/such.png", 7, 9, std::vector<std::uint8_t>(252, 1)); }).empty());
    CHECK_FALSE(error_of([&] { io::write_netcdf(temp / "none.nc", series(0)); }).empty());
    std::vector<std::uint8_t> noise(4 * 200 * 200);
    for (std::size_t i = 0; i < noise.size(); ++i) noise[i] = static_cast<std::uint8_t>(256 * uniform_at(1, 1, i));
    {
        const test::FileLimit limit(20000);
        CHECK_FALSE(error_of([&] { io::write_netcdf(temp / "big.nc", series(3, "", 100, 100)); }).empty());
        CHECK_FALSE(error_of([&] { io::write_png(temp / "big.png", 200, 200, noise); }).empty());
    }
    CHECK(temp.empty());
}
