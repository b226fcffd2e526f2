// SPDX-License-Identifier: GPL-3.0-or-later
#include "thalweg/io/raster_file.hpp"

#include <gdal_priv.h>
#include <ogr_spatialref.h>

#include <array>
#include <catch2/catch.hpp>
#include <cmath>
#include <filesystem>
#include <iterator>
#include <limits>
#include <numeric>
#include <thread>

#include "io/file_limit.hpp"
#include "io/zip_archive.hpp"
#include "support/temp_folder.hpp"

using namespace thalweg;
using Catch::Matchers::Contains;
using test::bytes_of;
using test::error_of;
using test::is_sentence;
using test::TempFolder;

namespace {

const double no_value = std::numeric_limits<double>::quiet_NaN();

/// What a test file is made of; read_raster must find it again.
struct FileSpec {
    int rows = 3;
    int cols = 4;
    std::array<double, 6> transform{500000, 30, 0, 4000000, 0, -30};
    std::string crs = "EPSG:32611";
    GDALDataType type = GDT_Float32;
    std::string nodata = {};
    std::string unit = {};
    double scale = 1;
    double offset = 0;
    std::vector<std::string> options = {};
};

std::vector<double> ramp(const FileSpec& spec) {
    std::vector<double> values(static_cast<std::size_t>(spec.rows) * spec.cols);
    std::iota(values.begin(), values.end(), 100.0);
    return values;
}

GDALDatasetUniquePtr create(const std::filesystem::path& path, const FileSpec& spec, int bands = 1) {
    GDALAllRegister();
    CPLStringList options;
    for (const std::string& option : spec.options) options.AddString(option.c_str());
    GDALDatasetUniquePtr file(GetGDALDriverManager()->GetDriverByName("GTiff")->Create(
        path.c_str(), spec.cols, spec.rows, bands, spec.type, options.List()));
    std::array<double, 6> transform = spec.transform;
    if (transform[1] != 0) file->SetGeoTransform(transform.data());
    if (!spec.crs.empty()) {
        OGRSpatialReference crs;
        crs.SetFromUserInput(spec.crs.c_str());
        crs.SetAxisMappingStrategy(OAMS_TRADITIONAL_GIS_ORDER);
        file->SetSpatialRef(&crs);
    }
    GDALRasterBand& band = *file->GetRasterBand(1);
    if (!spec.nodata.empty()) band.SetNoDataValue(std::stod(spec.nodata));
    if (!spec.unit.empty()) band.SetUnitType(spec.unit.c_str());
    if (spec.scale != 1) band.SetScale(spec.scale);
    if (spec.offset != 0) band.SetOffset(spec.offset);
    return file;
}

void fill(GDALDataset& file, std::vector<double> values, int band = 1) {
    REQUIRE(file.GetRasterBand(band)->RasterIO(GF_Write, 0, 0, file.GetRasterXSize(), file.GetRasterYSize(),
                                               values.data(), file.GetRasterXSize(), file.GetRasterYSize(), GDT_Float64,
                                               0, 0, nullptr) == CE_None);
}

std::filesystem::path make(const TempFolder& folder, const std::string& name, const FileSpec& spec,
                           const std::vector<double>& values) {
    fill(*create(folder / name, spec), values);
    return folder / name;
}

std::filesystem::path make(const TempFolder& folder, const std::string& name, const FileSpec& spec = {}) {
    return make(folder, name, spec, ramp(spec));
}

bool same(const std::vector<double>& a, const std::vector<double>& b) {
    if (a.size() != b.size()) return false;
    for (std::size_t i = 0; i < a.size(); ++i) {
        if (!(a[i] == b[i] || (std::isnan(a[i]) && std::isnan(b[i])))) return false;
    }
    return true;
}

bool warned(const io::ReadResult& result, const std::string& word) {
    for (const std::string& warning : result.warnings) {
        if (warning.find(word) != std::string::npos) return true;
    }
    return false;
}

std::string refusal(const std::filesystem::path& path, const io::ReadOptions& options = {}) {
    return error_of([&] { io::read_raster(path, options); });
}

/// An ASCII grid, which has no coordinate system.
std::string ascii_grid(int rows, int cols, const std::string& west, const std::string& south, const std::string& cell,
                       const std::string& first = "100") {
    std::string text = "ncols " + std::to_string(cols) + "\nnrows " + std::to_string(rows) + "\nxllcorner " + west +
                       "\nyllcorner " + south + "\ncellsize " + cell + "\nNODATA_value -9999\n";
    for (int i = 0; i < rows * cols; ++i) {
        text += (i == 0 ? first : std::to_string(100 + i)) + ((i + 1) % cols == 0 ? "\n" : " ");
    }
    return text;
}

}  // namespace

TEST_CASE("a projected raster is read with its place, metres and EPSG code", "[raster]") {
    const TempFolder folder;
    const io::ReadResult result = io::read_raster(make(folder, "a.tif"));
    CHECK(same(result.raster.values, ramp({})));
    CHECK(result.warnings.empty());
    CHECK(result.crs_name == "EPSG:32611");
    CHECK(result.raster.placement.west == 500000);
    CHECK(result.raster.placement.north == 4000000);
    CHECK_FALSE(result.raster.placement.geographic);
    CHECK(result.raster.grid.rows == 3);
    CHECK(result.raster.grid.cols == 4);
    CHECK(result.raster.grid.cell_area[0] == 900);
}

TEST_CASE("cells that are not square keep both their sizes", "[raster]") {
    const TempFolder folder;
    const io::ReadResult result = io::read_raster(make(folder, "a.tif", {.transform = {5e5, 50, 0, 4e6, 0, -40}}));
    CHECK(result.raster.grid.east_west[1] == 50);
    CHECK(result.raster.grid.north_south[1] == 40);
    CHECK(result.raster.grid.cell_area[1] == 2000);
}

TEST_CASE("a south-up raster is turned over", "[raster]") {
    const TempFolder folder;
    const FileSpec up{.transform = {5e5, 30, 0, 4e6 - 90, 0, 30}};
    const io::ReadResult result = io::read_raster(make(folder, "a.tif", up));
    CHECK(same(result.raster.values, {108, 109, 110, 111, 104, 105, 106, 107, 100, 101, 102, 103}));
    CHECK(result.raster.placement.north == 4e6);
    CHECK(result.raster.placement.cell_height == 30);
}

TEST_CASE("rasters in feet are measured in metres", "[raster]") {
    const TempFolder folder;
    // EPSG:2225 California zone 1 (US survey feet), 2256 Montana (international feet).
    SECTION("the plane's unit scales lengths; heights are metres, with a warning, where no unit is stated") {
        const io::ReadResult us = io::read_raster(make(folder, "a.tif", {.crs = "EPSG:2225"}));
        CHECK(us.raster.grid.east_west[0] == Approx(30 * 1200.0 / 3937).epsilon(1e-12));
        CHECK(us.raster.placement.cell_width == 30);
        CHECK(us.raster.values[0] == 100);
        CHECK(us.vertical_unit_m == 1);
        CHECK(warned(us, "does not state the unit of its heights"));
        const io::ReadResult international = io::read_raster(make(folder, "b.tif", {.crs = "EPSG:2256"}));
        CHECK(international.raster.grid.east_west[0] == Approx(30 * 0.3048).epsilon(1e-12));
    }
    SECTION("the band's unit scales heights") {
        struct Case {
            std::string unit;
            double metres;
        };
        for (const Case& c : {Case{"ft", 0.3048}, Case{"feet", 0.3048}, Case{"US survey foot", 1200.0 / 3937},
                              Case{"metre", 1}, Case{"cm", 0.01}}) {
            const io::ReadResult result = io::read_raster(make(folder, "a.tif", {.unit = c.unit}));
            CHECK(result.vertical_unit_m == Approx(c.metres).epsilon(1e-12));
            CHECK(result.raster.values[5] == Approx(105 * c.metres).epsilon(1e-12));
            CHECK(result.warnings.empty());
        }
    }
    SECTION("a compound coordinate system states the unit of heights") {
        // NAD83 / UTM 11N + NAVD88 height (ftUS).
        const io::ReadResult result = io::read_raster(make(folder, "a.tif", {.crs = "EPSG:26911+6360"}));
        CHECK(result.vertical_unit_m == Approx(1200.0 / 3937).epsilon(1e-9));
        CHECK(result.crs_name == "EPSG:26911");
        CHECK(result.raster.grid.east_west[0] == 30);
        const io::ReadResult replaced = io::read_raster(folder / "a.tif", {.nodata = {}, .crs = "EPSG:32611"});
        CHECK(replaced.vertical_unit_m == Approx(1200.0 / 3937).epsilon(1e-9));
        CHECK(replaced.crs_name == "EPSG:32611");
    }
    SECTION("a unit that is none is said") {
        CHECK(warned(io::read_raster(make(folder, "a.tif", {.unit = "furlong"})), "furlong"));
    }
}

TEST_CASE("no data is found by tag, as the band's type rounds it", "[raster]") {
    const TempFolder folder;
    struct Case {
        GDALDataType type;
        std::string tag;
        double stored;
    };
    for (const Case& c :
         {Case{GDT_Float32, "-3.4028235e38", -std::numeric_limits<float>::max()}, Case{GDT_Float32, "-1e37", -1e37},
          Case{GDT_Float32, "-99.9", -99.9}, Case{GDT_Float64, "-99.9", -99.9}, Case{GDT_Int16, "0", 0},
          Case{GDT_Int16, "-32768", -32768}, Case{GDT_UInt16, "65535", 65535},
          Case{GDT_Int32, "-2147483648", -2147483648.0}, Case{GDT_Byte, "255", 255}}) {
        FileSpec spec{.type = c.type, .nodata = c.tag};
        std::vector<double> values = ramp(spec);
        values[5] = c.stored;
        std::vector<double> expected = ramp(spec);
        expected[5] = no_value;
        const io::ReadResult result = io::read_raster(make(folder, "a.tif", spec, values));
        CAPTURE(c.tag);
        CHECK(same(result.raster.values, expected));
    }
}

TEST_CASE("NaN, infinity and numbers that are no heights are no data", "[raster]") {
    const TempFolder folder;
    std::vector<double> values = ramp({});
    values[0] = no_value;
    values[1] = std::numeric_limits<double>::infinity();
    values[11] = -std::numeric_limits<float>::max();
    std::vector<double> expected = ramp({});
    expected[0] = expected[1] = expected[11] = no_value;
    const io::ReadResult result = io::read_raster(make(folder, "a.tif", {}, values));
    CHECK(same(result.raster.values, expected));
    CHECK(warned(result, "beyond 1e30"));
}

TEST_CASE("the user's no data counts besides the file's", "[raster]") {
    const TempFolder folder;
    FileSpec spec{.type = GDT_Float32, .nodata = "101"};
    std::vector<double> values = ramp(spec);
    values[7] = 0.1;
    const io::ReadResult result = io::read_raster(make(folder, "a.tif", spec, values), {.nodata = 0.1, .crs = ""});
    CHECK(std::isnan(result.raster.values[1]));
    CHECK(std::isnan(result.raster.values[7]));
    CHECK(result.raster.values[2] == 102);
}

TEST_CASE("cells that a mask or alpha band hides are no data", "[raster]") {
    const TempFolder folder;
    std::vector<double> hidden(12, 255);
    hidden[3] = 0;
    std::vector<double> expected = ramp({});
    expected[3] = no_value;
    SECTION("mask band") {
        {
            CPLSetConfigOption("GDAL_TIFF_INTERNAL_MASK", "YES");
            const GDALDatasetUniquePtr file = create(folder / "a.tif", {});
            file->CreateMaskBand(GMF_PER_DATASET);
            CPLSetConfigOption("GDAL_TIFF_INTERNAL_MASK", nullptr);
            fill(*file, ramp({}));
            REQUIRE(file->GetRasterBand(1)->GetMaskBand()->RasterIO(GF_Write, 0, 0, 4, 3, hidden.data(), 4, 3,
                                                                    GDT_Float64, 0, 0, nullptr) == CE_None);
        }
        CHECK(same(io::read_raster(folder / "a.tif").raster.values, expected));
    }
    SECTION("alpha band") {
        {
            const GDALDatasetUniquePtr file =
                create(folder / "a.tif", {.options = {"ALPHA=YES", "PHOTOMETRIC=MINISBLACK"}}, 2);
            fill(*file, ramp({}));
            fill(*file, hidden, 2);
        }
        CHECK(same(io::read_raster(folder / "a.tif").raster.values, expected));
    }
}

TEST_CASE("scale and offset are applied after no data is found", "[raster]") {
    const TempFolder folder;
    const io::ReadResult result = io::read_raster(
        make(folder, "a.tif", {.type = GDT_Int16, .nodata = "104", .unit = "ft", .scale = 0.1, .offset = -5}));
    CHECK(result.raster.values[0] == Approx((100 * 0.1 - 5) * 0.3048).epsilon(1e-12));
    CHECK(std::isnan(result.raster.values[4]));
}

TEST_CASE("what a scale makes of heights is looked at, too", "[raster]") {
    const TempFolder folder;
    std::vector<double> values = ramp({});
    values[3] = 1;
    const io::ReadResult result = io::read_raster(make(folder, "a.tif", {.type = GDT_Float64, .scale = 1e29}, values));
    CHECK(result.raster.values[3] == 1e29);
    CHECK(std::isnan(result.raster.values[0]));
    CHECK(warned(result, "11 cells of " + (folder / "a.tif").string() + " hold values beyond 1e30"));
    CHECK_THAT(refusal(make(folder, "b.tif", {.type = GDT_Float64, .scale = 1e307})),
               Contains("all of its cells are void"));
}

TEST_CASE("heights above all mountains are said, the highest mountain is not", "[raster]") {
    const TempFolder folder;
    std::vector<double> values = ramp({});
    values[2] = 8849;
    CHECK(io::read_raster(make(folder, "a.tif", {}, values)).warnings.empty());
    values[5] = values[6] = 32767;
    CHECK(warned(io::read_raster(make(folder, "b.tif", {}, values)),
                 "2 cells of " + (folder / "b.tif").string() + " lie above 9000 m"));
}

TEST_CASE("geographic rasters are measured on their own ellipsoid", "[raster]") {
    const TempFolder folder;
    const std::array<double, 6> degrees{-79, 0.001, 0, 36, 0, -0.001};
    const Grid wgs84 = io::read_raster(make(folder, "a.tif", {.transform = degrees, .crs = "EPSG:4326"})).raster.grid;
    const Grid nad27 = io::read_raster(make(folder, "b.tif", {.transform = degrees, .crs = "EPSG:4267"})).raster.grid;
    CHECK(wgs84.east_west[0] == Approx(90.17).epsilon(1e-3));
    CHECK(wgs84.north_south[0] == Approx(110.95).epsilon(1e-3));
    // Width of a parallel on Clarke 1866 over that on WGS 84: a/sqrt(1 - e2 sin2(latitude)).
    const auto width = [](double a, double e2) {
        return a / std::sqrt(1 - e2 * std::pow(std::sin(35.9995 * M_PI / 180), 2));
    };
    const double expected = width(6378206.4, 0.006768657997) / width(6378137, 0.00669437999014);
    CHECK(nad27.east_west[0] / wgs84.east_west[0] == Approx(expected).epsilon(1e-8));
    const io::ReadResult east =
        io::read_raster(make(folder, "c.tif", {.transform = {281, 0.001, 0, 36, 0, -0.001}, .crs = "EPSG:4326"}));
    CHECK(east.raster.grid.cell_area == wgs84.cell_area);
    CHECK(east.raster.placement.geographic);
    CHECK(east.warnings.empty());
}

TEST_CASE("without a coordinate system plausible degrees are WGS 84 and all else is metres, both with a warning",
          "[raster]") {
    const TempFolder folder;
    const auto read = [&](const std::string& west, const std::string& south, const std::string& cell) {
        return io::read_raster(folder.text("a.asc", ascii_grid(3, 4, west, south, cell)));
    };
    const io::ReadResult degrees = read("-105.55", "40.09", "0.000833");
    CHECK(degrees.raster.placement.geographic);
    CHECK(degrees.crs_name == "EPSG:4326");
    CHECK(warned(degrees, "WGS 84"));
    const io::ReadResult metres = read("500000", "4000000", "30");
    CHECK_FALSE(metres.raster.placement.geographic);
    CHECK(metres.raster.placement.crs_wkt.empty());
    CHECK(metres.raster.grid.cell_area[0] == 900);
    CHECK(warned(metres, "taken as metres"));
    CHECK_FALSE(read("0", "0", "1").raster.placement.geographic);
    CHECK_FALSE(read("0", "0", "0.5").raster.placement.geographic);
    CHECK_FALSE(read("100", "20", "10").raster.placement.geographic);
    CHECK_FALSE(read("179.999", "20", "0.1").raster.placement.geographic);
}

TEST_CASE("the user's coordinate system replaces the file's, and nonsense is refused", "[raster]") {
    const TempFolder folder;
    make(folder, "a.tif");
    CHECK(io::read_raster(folder / "a.tif", {.nodata = {}, .crs = "EPSG:32610"}).crs_name == "EPSG:32610");
    CHECK_THAT(refusal(folder / "a.tif", {.nodata = {}, .crs = "EPSG:nonsense"}), Contains("EPSG:nonsense"));
    CHECK_THAT(refusal(folder / "a.tif", {.nodata = {}, .crs = "EPSG:999999"}), Contains("EPSG:999999"));
    CHECK_THAT(refusal(folder / "a.tif", {.nodata = {}, .crs = "EPSG:4326"}), Contains("poles"));
    CHECK_THAT(refusal(folder / "a.tif", {.nodata = {}, .crs = "EPSG:4978"}), Contains("neither geographic nor"));
}

TEST_CASE("what is no coordinate system is answered by its number, or by the zone of the raster's middle", "[raster]") {
    const TempFolder folder;
    struct Place {
        double west, north;
        const char* zone;
    };
    for (const auto& [west, north, zone] :
         {Place{-84.2, 36.5, "EPSG:32616"}, Place{-83.9, 36.5, "EPSG:32617"}, Place{151.2, -33.8, "EPSG:32756"},
          Place{5.5, 60.4, "EPSG:32632"}, Place{10, 86, "EPSG:32661"}, Place{10, -86, "EPSG:32761"}}) {
        make(folder, "a.tif", {.transform = {west, 0.001, 0, north, 0, -0.001}, .crs = "EPSG:4326"});
        CAPTURE(zone);
        CHECK_THAT(refusal(folder / "a.tif", {.nodata = {}, .crs = "utm"}), Contains(std::string("(try ") + zone));
        CHECK_THAT(refusal(folder / "a.tif", {.nodata = {}, .crs = {}, .reproject = "utm"}),
                   Contains(std::string("try ") + zone));
        CHECK_THAT(refusal(folder / "a.tif", {.nodata = {}, .crs = {}, .cell_m = 90.0}),
                   Contains(std::string("--reproject ") + zone));
    }
    CHECK_THAT(refusal(folder / "a.tif", {.nodata = {}, .crs = "32610"}), Contains("(try EPSG:32610)"));
    CHECK_THAT(refusal(folder / "a.tif", {.nodata = {}, .crs = "99999"}), Contains("(try EPSG:32761)"));
    CHECK_THAT(refusal(folder / "a.tif", {.nodata = {}, .crs = {}, .reproject = "99999"}), Contains("try EPSG:32761"));
    make(folder, "b.tif", {.transform = {700000, 30, 0, 5100000, 0, -30}, .crs = "EPSG:32632"});
    CHECK_THAT(refusal(folder / "b.tif", {.nodata = {}, .crs = "utm"}), Contains("(try EPSG:32632)"));
    make(folder, "c.tif", {.crs = ""});
    CHECK_THAT(refusal(folder / "c.tif", {.nodata = {}, .crs = "utm"}), Contains("(try EPSG:32611)"));
}

TEST_CASE("a middle outside of what the coordinate system is made for is said so", "[raster]") {
    const TempFolder folder;
    const auto warns = [&](const std::array<double, 6>& transform, const char* crs) {
        return warned(io::read_raster(make(folder, "a.tif", {.transform = transform, .crs = crs})),
                      "for which that is made");
    };
    const auto degrees = [](double west, double north) {
        return std::array<double, 6>{west, 0.001, 0, north, 0, -0.001};
    };
    CHECK(warns(degrees(7, 46), "EPSG:4269"));  // NAD83 in the Alps
    CHECK_FALSE(warns(degrees(-84, 36), "EPSG:4269"));
    CHECK_FALSE(warns(degrees(173, 53), "EPSG:4269"));  // the Aleutians, beyond the antimeridian
    CHECK_FALSE(warns(degrees(-170, 53), "EPSG:4269"));
    CHECK_FALSE(warns(degrees(179.9, -89.9), "EPSG:4326"));
    CHECK(warns({2600000, 30, 0, 1600000, 0, -30}, "EPSG:2056"));  // Swiss system in the Tyrol and beyond
    CHECK_FALSE(warns({2600000, 30, 0, 1200000, 0, -30}, "EPSG:2056"));
    CHECK_FALSE(warns({200000, 30, 0, 5000000, 0, -30}, "EPSG:32611"));   // less than a degree beyond its zone
    CHECK_FALSE(warns({500000, 30, 0, -2000000, 0, -30}, "EPSG:32611"));  // Landsat's way south of the equator
    CHECK(warns({1600000, 30, 0, 5400000, 0, -30}, "EPSG:32611"));        // New Zealand's numbers
    CHECK(warns({500000, 30, 0, 5700000, 0, -30}, "EPSG:27700"));         // a UTM zone's numbers on the British grid
}

TEST_CASE("the area is compared in degrees from Greenwich, whatever the system's own", "[raster]") {
    const TempFolder folder;
    struct Place {
        double x, y;
        const char* crs;
    };
    for (const auto& [x, y, crs] :
         {Place{600000, 2425000, "EPSG:27572"}, Place{600000, 128000, "EPSG:27561"},
          Place{600000, 200000, "EPSG:27563"}, Place{0, 0, "EPSG:21780"}, Place{0, 0, "EPSG:27391"}}) {
        CAPTURE(crs);
        CHECK(
            io::read_raster(make(folder, "a.tif", {.transform = {x, 30, 0, y, 0, -30}, .crs = crs})).warnings.empty());
    }
    const io::ReadResult far =
        io::read_raster(make(folder, "a.tif", {.transform = {600000, 30, 0, 1400000, 0, -30}, .crs = "EPSG:27572"}));
    CHECK(warned(far, "lies at 2.34 degrees east, 39."));
}

TEST_CASE("the zone that is recommended is not warned of, nor one as wide as its lengths hold", "[raster]") {
    const TempFolder folder;
    for (const auto& [longitude, latitude, zone] : {std::tuple{10.5, 78.6, "EPSG:32633"},
                                                    {22.0, 78.6, "EPSG:32635"},
                                                    {34.0, 79.0, "EPSG:32637"},
                                                    {8.0, 78.6, "EPSG:32631"},
                                                    {3.2, 60.5, "EPSG:32632"}}) {
        const auto path =
            make(folder, "a.tif",
                 {.rows = 20, .cols = 20, .transform = {longitude, 0.001, 0, latitude, 0, -0.001}, .crs = "EPSG:4326"});
        CAPTURE(zone);
        CHECK_THAT(refusal(path, {.nodata = {}, .crs = "utm"}), Contains(zone));
        CHECK_FALSE(
            warned(io::read_raster(path, {.nodata = {}, .crs = {}, .reproject = zone}), "for which that is made"));
    }
    for (const char* norway : {"EPSG:25833", "EPSG:5973"}) {  // Bergen and Kirkenes in the one zone of the country
        for (const auto& [x, y] : {std::pair{-32000.0, 6734000.0}, {1080000.0, 7790000.0}}) {
            CAPTURE(norway, x);
            CHECK(io::read_raster(make(folder, "b.tif", {.transform = {x, 30, 0, y, 0, -30}, .crs = norway}))
                      .warnings.empty());
        }
    }
}

TEST_CASE("the name of a file's coordinate system is looked up nowhere", "[raster]") {
    const TempFolder folder;
    // A system of the Alps, for a raster in Kansas.
    const std::string lure =
        folder
            .text("lure.txt",
                  "GEOGCRS[\"a\",DATUM[\"b\",ELLIPSOID[\"c\",6378137,298.257223563]],CS[ellipsoidal,2],AXIS[\"lat\","
                  "north],"
                  "AXIS[\"lon\",east],ANGLEUNIT[\"degree\",0.0174532925199433],AREA[\"Alps\"],BBOX[45,5,48,11]]")
            .string();
    folder.text("a.prj",
                "PROJCS[\"" + lure +
                    "\",GEOGCS[\"GCS_WGS_1984\",DATUM[\"D_WGS_1984\",SPHEROID[\"WGS_1984\",6378137,298.257223563]],"
                    "PRIMEM[\"Greenwich\",0],UNIT[\"Degree\",0.0174532925199433]],"
                    "PROJECTION[\"Lambert_Conformal_Conic_2SP\"],PARAMETER[\"standard_parallel_1\",33],"
                    "PARAMETER[\"standard_parallel_2\",45],PARAMETER[\"latitude_of_origin\",39],"
                    "PARAMETER[\"central_meridian\",-96],PARAMETER[\"false_easting\",0],"
                    "PARAMETER[\"false_northing\",0],UNIT[\"Meter\",1]]");
    const io::ReadResult read = io::read_raster(folder.text("a.asc", ascii_grid(3, 4, "1000", "-600000", "30")));
    CHECK(read.crs_name == lure);
    CHECK_FALSE(warned(read, "for which that is made"));
    const auto path = make(folder, "b.tif");
    CHECK_THAT(refusal(path, {.nodata = {}, .crs = lure}), Contains("no coordinate system"));
    CHECK_THAT(refusal(path, {.nodata = {}, .crs = {}, .reproject = lure}), Contains("no coordinate system"));
}

TEST_CASE("a map whose lengths are not the ground's is said so", "[raster]") {
    const TempFolder folder;
    // Web Mercator at 60 degrees north doubles every length.
    const io::ReadResult mercator =
        io::read_raster(make(folder, "a.tif", {.transform = {1e6, 30, 0, 8399738, 0, -30}, .crs = "EPSG:3857"}));
    REQUIRE(mercator.warnings.size() == 1);
    CHECK_THAT(mercator.warnings[0], Contains("longer than on the ground"));
    CHECK_THAT(mercator.warnings[0], Contains("99.") || Contains("100."));
}

TEST_CASE("coordinates that cannot be those of the coordinate system are no damage of the file", "[raster]") {
    const TempFolder folder;
    const std::string far = refusal(make(folder, "a.tif", {.transform = {5e8, 30, 0, 4e9, 0, -30}}));
    CHECK_THAT(far, Contains("no place on the earth") && Contains("--crs") && Contains("EPSG:32611"));
    CHECK(is_sentence(far));
    const io::ReadResult degrees =
        io::read_raster(make(folder, "b.tif", {.transform = {10, 0.001, 0, 45, 0, -0.001}, .crs = "EPSG:32611"}));
    CHECK(warned(degrees, "look like degrees"));
}

TEST_CASE("a raster beyond the edge of a map of the whole earth is said so", "[raster]") {
    const TempFolder folder;
    // World Mercator is 40 075 km around: further east it would come around again, further north is no latitude.
    const auto read = [&](double west, double north) {
        return io::read_raster(make(folder, "a.tif", {.transform = {west, 30, 0, north, 0, -30}, .crs = "EPSG:3395"}));
    };
    for (const auto& [west, north] : {std::pair{1e9, 5e6}, {-3e7, 0.0}, {2.1e7, 100.0}, {5e6, 1e9}}) {
        const io::ReadResult far = read(west, north);
        CAPTURE(west, north);
        REQUIRE(far.warnings.size() == 1);
        CHECK_THAT(far.warnings[0], Contains("beyond the edge of the earth") && Contains("EPSG:3395"));
        CHECK(far.raster.grid.east_west[0] == 30);
    }
    CHECK_FALSE(warned(read(2.0e7, 100), "beyond"));
    CHECK_FALSE(warned(read(-2.0e7, -1e6), "beyond"));
    // Far from the middle of its zone, as DEMs of a wide region are, a plane is stretched and no more.
    const FileSpec wide{.transform = {-900000, 30, 0, 3.5e6, 0, -30}, .crs = "EPSG:32646"};
    CHECK_FALSE(warned(io::read_raster(make(folder, "b.tif", wide)), "beyond"));
}

TEST_CASE("a raster around the earth is said to be cut at its edge", "[raster]") {
    const TempFolder folder;
    const FileSpec whole{.rows = 4, .cols = 8, .transform = {-180, 45, 0, 90, 0, -45}, .crs = "EPSG:4326"};
    CHECK(warned(io::read_raster(make(folder, "a.tif", whole)), "around the earth"));
    FileSpec part = whole;
    part.cols = 6;
    CHECK_FALSE(warned(io::read_raster(make(folder, "b.tif", part)), "around the earth"));
}

TEST_CASE("what cannot be measured is refused with one sentence", "[raster]") {
    const TempFolder folder;
    const FileSpec plain;
    struct Case {
        std::filesystem::path path;
        std::string word;
    };
    FileSpec one_row{.rows = 1};
    FileSpec one_cell{.rows = 1, .cols = 1};
    const std::vector<Case> cases{
        {folder / "none.tif", "does not exist"},
        {folder / "", "folder"},
        {folder.text("empty.tif", ""), "empty"},
        {"/dev/null", "device"},
        {folder.text("text.tif", "these are words, not a picture\n"), "no raster"},
        {folder.text("half.tif", "II*"), "cut off"},
        {make(folder, "rotated.tif", {.transform = {5e5, 30, 5, 4e6, 5, -30}}), "gdalwarp"},
        {make(folder, "mirrored.tif", {.transform = {5e5, -30, 0, 4e6, 0, -30}}), "mirrored"},
        {make(folder, "unplaced.tif", {.transform = {0, 0, 0, 0, 0, 0}, .crs = ""}), "geotransform"},
        {make(folder, "row.tif", one_row), "at least 2 x 2"},
        {make(folder, "column.tif", {.cols = 1}), "at least 2 x 2"},
        {make(folder, "cell.tif", one_cell), "at least 2 x 2"},
        {make(folder, "void.tif", {.nodata = "7"}, std::vector<double>(12, 7)), "all of its cells are void"},
        {make(folder, "complex.tif", {.type = GDT_CFloat32}), "complex"},
        {make(folder, "geocentric.tif", {.crs = "LOCAL_CS[\"site\",UNIT[\"metre\",1]]"}), "neither geographic nor"},
        {make(folder, "polar.tif", {.transform = {0, 1, 0, 92, 0, -1}, .crs = "EPSG:4326"}), "poles"},
        {folder.text("tile.hgt", std::string(1000, 'x')), ".hgt tile has"},
        {folder.text("noise.zip", "PK not really"), "zip"},
    };
    for (const Case& c : cases) {
        const std::string sentence = refusal(c.path);
        CAPTURE(c.path, sentence);
        CHECK(is_sentence(sentence));
        CHECK_THAT(sentence, Contains(c.word));
    }
}

TEST_CASE("rasters too large are refused before memory is asked for", "[raster]") {
    const TempFolder folder;
    const auto claim = [&](int size) {
        return folder.text("a.vrt", "<VRTDataset rasterXSize=\"" + std::to_string(size) + "\" rasterYSize=\"" +
                                        std::to_string(size) +
                                        "\"><GeoTransform>0,30,0,0,0,-30</GeoTransform>"
                                        "<VRTRasterBand dataType=\"Float32\" band=\"1\"/></VRTDataset>");
    };
    CHECK_THAT(refusal(claim(70000)), Contains("32-bit"));
    CHECK_THAT(refusal(claim(2000000000)), Contains("32-bit"));
}

TEST_CASE("files that were cut off are refused, not read as zeros", "[raster]") {
    const TempFolder folder;
    const FileSpec spec{.rows = 300, .cols = 300};
    for (const std::string compression : {"NONE", "DEFLATE", "LZW"}) {
        for (const std::string tiled : {"YES", "NO"}) {
            FileSpec file = spec;
            file.options = {"COMPRESS=" + compression, "TILED=" + tiled};
            const std::string whole = bytes_of(make(folder, "whole.tif", file));
            for (const double part : {0.1, 0.5, 0.9, 0.98}) {
                CAPTURE(compression, tiled, part);
                const auto length = static_cast<std::size_t>(part * static_cast<double>(whole.size()));
                CHECK(is_sentence(refusal(folder.text("cut.tif", whole.substr(0, length)))));
            }
        }
    }
    SECTION("raw files with an ENVI header") {
        folder.text("a.hdr",
                    "ENVI\nsamples = 10\nlines = 10\nbands = 1\nheader offset = 0\ndata type = 2\ninterleave = bsq\n"
                    "byte order = 0\nmap info = {UTM, 1, 1, 500000, 4000000, 30, 30, 11, North, WGS-84}\n");
        std::string data;
        for (int i = 0; i < 100; ++i) data += test::little_endian(static_cast<std::uint32_t>(300 + i), 2);
        CHECK(io::read_raster(folder.text("a.bil", data)).raster.values[99] == 399);
        CHECK_THAT(refusal(folder.text("a.bil", data.substr(0, 198))), Contains("cut off"));
        CHECK_THAT(refusal(folder / "a.hdr"), Contains("data file beside it"));
    }
    SECTION("ASCII grids") {
        const std::string text = ascii_grid(20, 20, "500000", "4000000", "30");
        CHECK(is_sentence(refusal(folder.text("a.asc", text.substr(0, text.size() * 3 / 4)))));
    }
}

TEST_CASE("words in an ASCII grid that are no numbers, and numbers too many or too few, are refused", "[raster]") {
    const TempFolder folder;
    const std::string header = "ncols 3\nnrows 2\nxllcorner 500000\nyllcorner 4000000\ncellsize 30\n";
    const auto refused = [&](const std::string& numbers) {
        const std::string sentence = refusal(folder.text("a.asc", header + numbers));
        CHECK(is_sentence(sentence));
        return sentence;
    };
    CHECK_THAT(refused("1 2 3\n4 abc 6\n"), Contains("'abc' in row 2 and column 2") && Contains("NODATA_value"));
    CHECK_THAT(refused("1 2 12x\n4 5 6\n"), Contains("'12x' in row 1 and column 3"));
    for (const std::string word : {"-", ".", "1e", "1.2.3", "0x1F", "*", "--5", "12,5,1", "NULL", "nano", "1d5"}) {
        CHECK_THAT(refused("1 2 3 4 5 " + word), Contains("'" + word + "' in row 2 and column 3"));
    }
    CHECK_THAT(refused("1 2 3 4\n5 6 7 8\n"), Contains("8 numbers") && Contains("2 rows of 3"));
    CHECK_THAT(refused("1 2 3\n4 5\n"), Contains("5 numbers"));
    CHECK_THAT(refused(""), Contains("cut off"));
    const auto heights = [&](const std::string& text) {
        return io::read_raster(folder.text("a.asc", text)).raster.values;
    };
    CHECK(same(heights(header + "NODATA_value -9999\n1.5 -2 +3\n4e2 5.E-1 -9999"), {1.5, -2, 3, 400, 0.5, no_value}));
    CHECK(same(heights(header + "1,5 nan 3\r\n\r\n4 -1.#IND 6\r\n"), {1.5, no_value, 3, 4, no_value, 6}));
    CHECK(
        same(heights("north: 60\nsouth: 0\neast: 90\nwest: 0\nrows: 2\ncols: 3\n1 2 3\n4 5 6\n"), {1, 2, 3, 4, 5, 6}));
    // GDAL takes a grid of whole numbers as such, and nan for 0.
    for (const char* word : {"nan", "-inf"}) {
        const std::string text = header + "1 " + word + " 3\n4 5 6\n";
        CHECK_THAT(refusal(folder.text("c.asc", text)), Contains("row 1 and column 2") && Contains("taken for 0"));
    }
    SECTION("wherever in a long file the word stands") {
        std::string text = ascii_grid(500, 900, "500000", "4000000", "30");  // 3 MB, more than is read at once
        CHECK(io::read_raster(folder.text("a.asc", text)).raster.values[449999] == 450099);
        for (std::size_t at = (1 << 20) - 12; at < (1 << 20) + 12; ++at) {
            std::string broken = text;
            broken[at] = 'x';
            CHECK_THAT(refusal(folder.text("b.asc", broken)), Contains("x") && Contains("is no number"));
        }
    }
}

TEST_CASE("an SRTM tile is big-endian, placed by its name, with voids", "[raster]") {
    const TempFolder folder;
    std::string data;
    for (int i = 0; i < 1201 * 1201; ++i) {
        const int height = i == 5 ? -32768 : 500 + i / 1201;
        data += static_cast<char>(height >> 8 & 0xFF);
        data += static_cast<char>(height & 0xFF);
    }
    const auto check = [](const io::ReadResult& result) {
        CHECK(result.raster.values[0] == 500);
        CHECK(std::isnan(result.raster.values[5]));
        CHECK(result.raster.values.back() == 1700);
        const Point south_west = result.raster.placement.center(1200, 0);
        CHECK(south_west.x == Approx(-3).margin(1e-9));
        CHECK(south_west.y == Approx(55).margin(1e-9));
        CHECK(result.raster.placement.geographic);
    };
    check(io::read_raster(folder.text("n55w003.hgt", data)));
    check(io::read_raster(folder.text("N55W003.HGT.zip", test::zip_of({{"N55W003.hgt", data}}))));
    check(io::read_raster(
        folder.text("any name {}.zip", test::zip_of({{"readme.txt", "hello"}, {"sub/N55W003.hgt", data}}))));
}

TEST_CASE("a zip with several rasters is refused with their names, one with none as well", "[raster]") {
    const TempFolder folder;
    const std::string grid = ascii_grid(3, 4, "500000", "4000000", "30");
    const std::string two = refusal(folder.text("a.zip", test::zip_of({{"one.asc", grid}, {"two.asc", grid}})));
    CHECK_THAT(two, Contains("one.asc") && Contains("two.asc"));
    CHECK(is_sentence(refusal(folder.text("b.zip", test::zip_of({{"words.txt", "none here"}})))));
    const io::ReadResult one = io::read_raster(
        folder.text("c.zip", test::zip_of({{"one.asc", grid}, {"one.asc.aux.xml", "<PAMDataset></PAMDataset>"}})));
    CHECK(one.raster.values[1] == 101);
}

TEST_CASE("a border of one value that is not declared as no data is said, with the remedy", "[raster]") {
    const TempFolder folder;
    FileSpec spec{.rows = 40, .cols = 40, .nodata = "-9999"};
    std::vector<double> values(1600, 0);
    for (int row = 5; row < 35; ++row) {
        for (int col = 5; col < 35; ++col) values[row * 40 + col] = 300 + row + 0.1 * col;
    }
    const io::ReadResult cliff = io::read_raster(make(folder, "a.tif", spec, values));
    REQUIRE(cliff.warnings.size() == 1);
    CHECK_THAT(cliff.warnings[0], Contains("43.8 %") && Contains("cliff") && Contains("--nodata 0"));
    CHECK(io::read_raster(folder / "a.tif", {.nodata = 0.0, .crs = ""}).warnings.empty());

    SECTION("a sea at zero is said more gently, also where some cells are negative") {
        spec.type = GDT_Int16;
        for (int row = 0; row < 40; ++row) {
            for (int col = 0; col < 40; ++col) values[row * 40 + col] = std::max(0, 3 * (col - 10));
        }
        values[15 * 40 + 20] = -2;
        const io::ReadResult sea = io::read_raster(make(folder, "b.tif", spec, values));
        REQUIRE(sea.warnings.size() == 2);
        CHECK_THAT(sea.warnings[0], Contains("sea") && Contains("--nodata 0") && !Contains("cliff"));
        CHECK_THAT(sea.warnings[1], Contains("1 cells") && Contains("-2 m"));
    }
    SECTION("ordinary terrain is not suspected") {
        for (int i = 0; i < 1600; ++i) values[i] = 100 + i % 997;
        CHECK(io::read_raster(make(folder, "d.tif", spec, values)).warnings.empty());
    }
}

TEST_CASE("holes inside the terrain are counted, the outside is not", "[raster]") {
    const TempFolder folder;
    const FileSpec spec{.rows = 5, .cols = 6, .nodata = "-1"};
    std::vector<double> values = ramp(spec);
    values[0] = values[7] = -1;  // connected to the corner by a corner
    values[15] = values[16] = -1;
    const io::ReadResult result = io::read_raster(make(folder, "a.tif", spec, values));
    REQUIRE(result.warnings.size() == 1);
    CHECK_THAT(result.warnings[0], Contains("2 cells") && Contains("holes"));
}

TEST_CASE("pictures and files of many bands are read with a warning", "[raster]") {
    const TempFolder folder;
    fill(*create(folder / "a.tif", {.options = {"PHOTOMETRIC=MINISBLACK"}}, 5), ramp({}));
    CHECK(warned(io::read_raster(folder / "a.tif"), "5 bands"));
    fill(*create(folder / "b.tif", {.type = GDT_Byte, .options = {"PHOTOMETRIC=RGB"}}, 3), ramp({}));
    CHECK(warned(io::read_raster(folder / "b.tif"), "picture"));
}

TEST_CASE("BigTIFF, tiles, strips and every predictor and compression give the same heights", "[raster]") {
    const TempFolder folder;
    constexpr int rows = 37, cols = 53;
    std::vector<double> heights;
    for (int i = 0; i < rows * cols; ++i) heights.push_back(std::round(500 + 300 * std::sin(0.01 * i) + i % cols));
    using Options = std::vector<std::string>;
    const std::vector<std::pair<GDALDataType, Options>> kinds{
        {GDT_Int16, {"BIGTIFF=YES"}},
        {GDT_Float32, {"BIGTIFF=YES", "TILED=YES", "BLOCKXSIZE=16", "BLOCKYSIZE=32"}},
        {GDT_Int16, {"COMPRESS=DEFLATE", "PREDICTOR=2"}},
        {GDT_Float32, {"COMPRESS=LZW", "PREDICTOR=3"}},
        {GDT_Float64, {"COMPRESS=ZSTD", "PREDICTOR=3", "TILED=YES", "BLOCKXSIZE=16", "BLOCKYSIZE=16"}},
        {GDT_Float32, {"COMPRESS=LERC"}},
        {GDT_UInt16, {"COMPRESS=PACKBITS", "BLOCKYSIZE=5"}},
        {GDT_Int32, {"COMPRESS=LZMA", "ENDIANNESS=BIG"}}};
    for (std::size_t i = 0; i < kinds.size(); ++i) {
        INFO(i);
        FileSpec spec;
        spec.rows = rows, spec.cols = cols, spec.type = kinds[i].first, spec.options = kinds[i].second;
        const auto path = make(folder, std::to_string(i) + ".tif", spec, heights);
        CHECK(io::read_raster(path).raster.values == heights);
    }
    std::ifstream big(folder / "0.tif", std::ios::binary);
    char head[4] = {};
    big.read(head, 4);
    CHECK(static_cast<int>(head[2]) == 43);  // BigTIFF's own version number
}

TEST_CASE("what is written is read back to the last bit", "[raster]") {
    const TempFolder folder;
    const Grid grid = plane_grid(300, 270, 10, 12);
    std::vector<double> values(grid.size());
    for (std::size_t i = 0; i < values.size(); ++i) values[i] = std::sin(static_cast<double>(i)) * 1e3 + 2e3;
    values[17] = no_value;
    const std::string wkt = io::read_raster(make(folder, "crs.tif")).raster.placement.crs_wkt;
    const Placement placement{.west = 1.5, .north = 1e6, .cell_width = 10, .cell_height = 12, .crs_wkt = wkt};
    io::write_raster(folder / "a.tif", grid, placement, values, {.nodata = {}, .description = "elevation (m)"});
    const io::ReadResult back = io::read_raster(folder / "a.tif");
    CHECK(same(back.raster.values, values));
    CHECK(back.crs_name == "EPSG:32611");
    CHECK(back.raster.placement.west == 1.5);
    CHECK(back.raster.placement.cell_height == 12);
    const GDALDatasetUniquePtr file(GDALDataset::Open((folder / "a.tif").c_str()));
    CHECK(std::string(file->GetRasterBand(1)->GetDescription()) == "elevation (m)");
    int width = 0, height = 0;
    file->GetRasterBand(1)->GetBlockSize(&width, &height);
    CHECK(width == 256);
    CHECK(height == 256);
    CHECK(std::string(file->GetMetadataItem("AREA_OR_POINT")) == "Area");
    CHECK(std::isnan(file->GetRasterBand(1)->GetNoDataValue()));

    io::write_raster(folder / "b.tif", grid, placement, values, {.nodata = {}, .description = "elevation (m)"});
    CHECK(bytes_of(folder / "a.tif") == bytes_of(folder / "b.tif"));
}

TEST_CASE("whole numbers are written as such, and what does not fit is refused", "[raster]") {
    const TempFolder folder;
    const Grid grid = plane_grid(2, 2, 1, 1);
    const Placement placement{.west = 5, .north = 1000, .cell_width = 1, .cell_height = 1, .crs_wkt = ""};
    const auto write = [&](io::CellType type, std::optional<double> nodata, const std::vector<double>& values) {
        io::write_raster(folder / "a.tif", grid, placement, values,
                         {.type = type, .nodata = nodata, .description = ""});
        return io::read_raster(folder / "a.tif").raster.values;
    };
    CHECK(same(write(io::CellType::uint8, 255.0, {0, 1, no_value, 128}), {0, 1, no_value, 128}));
    CHECK(
        same(write(io::CellType::int32, {}, {-2147483648.0, 2147483647.0, 0, 1}), {-2147483648.0, 2147483647.0, 0, 1}));
    CHECK(same(write(io::CellType::float64, -9999.0, {1.5, no_value, 2.5, 3}), {1.5, no_value, 2.5, 3}));
    CHECK_THROWS_AS(write(io::CellType::uint8, 255.0, {0, 1, 256, 0}), Error);
    CHECK_THROWS_AS(write(io::CellType::uint8, {}, {0, 1, no_value, 0}), Error);
    CHECK_THROWS_AS(write(io::CellType::int32, {}, {0, 1.5, 2, 0}), Error);
    CHECK_THROWS_AS(write(io::CellType::float64, {}, {0, 1.5, 2}), Error);
}

TEST_CASE("a raster that cannot be written whole is an error and leaves nothing", "[raster]") {
    const TempFolder folder;
    const Grid grid = plane_grid(300, 300, 10, 10);
    const Placement placement{.west = 0, .north = 1e6, .cell_width = 10, .cell_height = 10, .crs_wkt = ""};
    std::vector<double> values(grid.size());
    for (std::size_t i = 0; i < values.size(); ++i) values[i] = std::sin(static_cast<double>(i) * i);
    const auto write = [&] { io::write_raster(folder / "a.tif", grid, placement, values, {}); };
    CHECK(is_sentence(error_of([&] { io::write_raster(folder / "no/a.tif", grid, placement, values, {}); })));
    write();
    const std::size_t whole = bytes_of(folder / "a.tif").size();
    std::filesystem::remove(folder / "a.tif");
    for (const std::size_t missing : {whole - 1, whole - 5000, whole / 2, std::size_t{5000}, std::size_t{1}}) {
        const test::FileLimit limit(whole - missing);
        CAPTURE(missing);
        CHECK(is_sentence(error_of(write)));
        CHECK(folder.empty());
    }
    write();
    CHECK(same(io::read_raster(folder / "a.tif").raster.values, values));
}

TEST_CASE("threads read and write at the same time, each with its own errors", "[raster]") {
    const TempFolder folder;
    const std::filesystem::path good = make(folder, "good.tif");
    const std::filesystem::path bad = folder.text("bad.tif", "words");
    const Raster raster = io::read_raster(good).raster;
    std::array<int, 4> right{};
    std::vector<std::thread> threads;
    for (int t = 0; t < 4; ++t) {
        threads.emplace_back([&, t] {
            for (int i = 0; i < 20; ++i) {
                const std::filesystem::path own = folder / (std::to_string(t) + ".tif");
                io::write_raster(own, raster.grid, raster.placement, raster.values, {});
                right[t] += same(io::read_raster(own).raster.values, raster.values);
                right[t] += refusal(bad).find("bad.tif") != std::string::npos;
            }
        });
    }
    for (std::thread& thread : threads) thread.join();
    CHECK(right == std::array<int, 4>{40, 40, 40, 40});
}

TEST_CASE("Colours and statistics stand in the file itself, and change no value") {
    const TempFolder temp;
    const Grid grid = plane_grid(2, 3, 10, 10);
    const Placement place{.west = 0, .north = 20, .cell_width = 10, .cell_height = 10, .crs_wkt = ""};
    io::write_raster(temp / "heights.tif", grid, place, std::vector<double>{1000, 1002, no_value, 1004, 1006, 1008},
                     {});
    io::write_raster(temp / "codes.tif", grid, place, std::vector<double>{0, 1, 255, 4, 1, 0},
                     {.type = io::CellType::uint8, .nodata = 255, .colors = {{0, 9, 8, 7}, {4, 30, 20, 10}}});
    CHECK(std::distance(std::filesystem::directory_iterator(temp / ""), {}) == 2);  // nothing beside them
    GDALDatasetUniquePtr heights(GDALDataset::Open((temp / "heights.tif").c_str()));
    double least = 0, most = 0, mean = 0, deviation = 0;
    CHECK(heights->GetRasterBand(1)->GetStatistics(false, false, &least, &most, &mean, &deviation) == CE_None);
    CHECK(least == 1000);
    CHECK(most == 1008);
    CHECK(mean == Approx(1004));
    CHECK(deviation == Approx(std::sqrt(8.0)));  // of all cells, as GDAL has it
    GDALDatasetUniquePtr codes(GDALDataset::Open((temp / "codes.tif").c_str()));
    const GDALColorTable* colors = codes->GetRasterBand(1)->GetColorTable();
    REQUIRE(colors != nullptr);
    CHECK(colors->GetColorEntry(0)->c1 == 9);
    CHECK(colors->GetColorEntry(4)->c3 == 10);
    CHECK(colors->GetColorEntry(200)->c2 == 255);
    const std::vector<double> read = io::read_raster(temp / "codes.tif").raster.values;
    CHECK(read[3] == 4);
    CHECK(std::isnan(read[2]));
}
