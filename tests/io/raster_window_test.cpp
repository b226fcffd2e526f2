// SPDX-License-Identifier: GPL-3.0-or-later
// Parts of a file, and a file on other cells.
#include <gdal_priv.h>
#include <ogr_spatialref.h>

#include <array>
#include <catch2/catch.hpp>
#include <cmath>

#include "support/temp_folder.hpp"
#include "thalweg/io/raster_file.hpp"

using namespace thalweg;
using Catch::Matchers::Contains;
using test::error_of;
using test::TempFolder;

namespace {

/// A file of 40 x 50 cells of 30 m in UTM zone 11; each band holds its own number times height(x, y) of the cells'
/// middles.
template <class Height>
std::filesystem::path write(const TempFolder& temp, const Height& height, int bands = 1, double step_y = -30) {
    GDALAllRegister();
    const std::filesystem::path path = temp / "dem.tif";
    GDALDatasetUniquePtr file(
        GetGDALDriverManager()->GetDriverByName("GTiff")->Create(path.c_str(), 50, 40, bands, GDT_Float64, nullptr));
    std::array<double, 6> transform{500000, 30, 0, step_y < 0 ? 4000000.0 : 3998800.0, 0, step_y};
    file->SetGeoTransform(transform.data());
    OGRSpatialReference system;
    system.importFromEPSG(32611);
    file->SetSpatialRef(&system);
    for (int band = 1; band <= bands; ++band) {
        std::vector<double> values;
        for (int row = 0; row < 40; ++row) {
            for (int col = 0; col < 50; ++col) {
                values.push_back(band * height(transform[0] + (col + 0.5) * 30, transform[3] + (row + 0.5) * step_y));
            }
        }
        REQUIRE(file->GetRasterBand(band)->RasterIO(GF_Write, 0, 0, 50, 40, values.data(), 50, 40, GDT_Float64, 0, 0,
                                                    nullptr) == CE_None);
    }
    return path;
}

double plane(double x, double y) { return 100 + 0.02 * (x - 500000) + 0.05 * (y - 3998800); }

Point middle(const Raster& raster, Index node) {
    return raster.placement.center(raster.grid.row(node), raster.grid.col(node));
}

}  // namespace

TEST_CASE("A window keeps the cells whose middle lies in it, where they were, whichever way the rows run", "[window]") {
    const double step_y = GENERATE(-30.0, 30.0);
    const TempFolder temp;
    const auto path = write(temp, plane, 1, step_y);
    const Raster whole = io::read_raster(path).raster;
    const io::Window window{500314, 3998911, 500617, 3999209};
    const Raster part = io::read_raster(path, {.window = window}).raster;
    Index inside = 0;
    for (Index node = 0; node < whole.grid.size(); ++node) {
        const Point p = middle(whole, node);
        inside += p.x > window.west && p.x < window.east && p.y > window.south && p.y < window.north;
    }
    CHECK(part.grid.size() == inside);
    for (Index node = 0; node < part.grid.size(); ++node) {
        const Point p = middle(part, node);
        CHECK((p.x > window.west && p.x < window.east && p.y > window.south && p.y < window.north));
        CHECK(part.values[node] == Approx(plane(p.x, p.y)).epsilon(1e-12));
    }
}

TEST_CASE("A window that goes beyond the file ends with it; one beside the file is refused", "[window]") {
    const TempFolder temp;
    const auto path = write(temp, plane);
    CHECK(io::read_raster(path, {.window = io::Window{0, 0, 1e7, 1e7}}).raster.grid.size() == 2000);
    const auto refused = [&](const io::Window& window) {
        return error_of([&] { io::read_raster(path, {.window = window}); });
    };
    CHECK_THAT(refused({600000, 3998900, 600500, 3999000}), Contains("reaches from 500000 to 501500"));
    CHECK_THAT(refused({500000, 3998900, 500020, 3999000}), Contains("fewer than 2 x 2 cells"));
}

TEST_CASE("The band that is asked for holds the heights; one that is not there is refused", "[window]") {
    const TempFolder temp;
    const auto path = write(temp, plane, 3);
    const Raster first = io::read_raster(path).raster, third = io::read_raster(path, {.band = 3}).raster;
    for (Index node = 0; node < first.grid.size(); ++node) CHECK(third.values[node] == 3 * first.values[node]);
    CHECK_THAT(error_of([&] { io::read_raster(path, {.band = 4}); }), Contains("no band 4: it has 3"));
}

TEST_CASE("An alpha band hides cells of the band that is asked for, too", "[window]") {
    const TempFolder temp;
    const auto path = write(
        temp, [](double x, double) { return x; }, 3);
    {
        const GDALDatasetUniquePtr file(GDALDataset::Open(path.c_str(), GDAL_OF_RASTER | GDAL_OF_UPDATE));
        GDALRasterBand& alpha = *file->GetRasterBand(3);
        std::vector<double> seen(40 * 50, 255);
        seen[7] = 0;
        REQUIRE(alpha.RasterIO(GF_Write, 0, 0, 50, 40, seen.data(), 50, 40, GDT_Float64, 0, 0, nullptr) == CE_None);
        REQUIRE(alpha.SetColorInterpretation(GCI_AlphaBand) == CE_None);
    }
    const Raster second = io::read_raster(path, {.band = 2}).raster, first = io::read_raster(path).raster;
    CHECK(std::isnan(first.values[7]));
    CHECK(std::isnan(second.values[7]));
    CHECK(second.values[8] == 2 * first.values[8]);
}

TEST_CASE("The sea is no data at and below its level, and all sea is refused", "[window]") {
    const TempFolder temp;
    const auto path = write(temp, plane);
    const Raster land = io::read_raster(path, {.sea_level_m = 120}).raster;
    for (Index node = 0; node < land.grid.size(); ++node) {
        const Point p = middle(land, node);
        CHECK(std::isnan(land.values[node]) == (plane(p.x, p.y) <= 120));
    }
    CHECK_THAT(error_of([&] { io::read_raster(path, {.sea_level_m = 1e4}); }), Contains("holds no data"));
}

TEST_CASE("A plane on other cells is the same plane, and the sea does not bleed into it", "[window]") {
    const TempFolder temp;
    const auto path = write(temp, plane);
    for (const double cell : {10.0, 45.0, 60.0, 90.0}) {
        // Where new and old cells do not nest, GDAL is off by a share of a cell.
        const double margin = cell == 45 ? 0.1 : 1e-6;
        CAPTURE(cell);
        const Raster warped = io::read_raster(path, {.sea_level_m = 110, .cell_m = cell}).raster;
        CHECK(warped.placement.cell_width == Approx(cell));
        Index known = 0;
        for (Index node = 0; node < warped.grid.size(); ++node) {
            const Point p = middle(warped, node);
            const bool inner =
                p.x > 500000 + cell && p.x < 501500 - cell && p.y > 3998800 + cell && p.y < 4000000 - cell;
            if (std::isnan(warped.values[node]) || !inner || plane(p.x, p.y) < 113 + 0.1 * cell) continue;
            ++known;
            CHECK(warped.values[node] == Approx(plane(p.x, p.y)).margin(margin));
        }
        CHECK(known > 50);
    }
}

TEST_CASE("Cells of a size that leaves no terrain, or more than can be held, are refused with what to give",
          "[window]") {
    const TempFolder temp;
    const auto path = write(temp, plane);  // 1200 m high, 1500 m wide
    const auto refusal = [&](double cell_m, const std::string& system = "") {
        const std::string sentence = error_of([&] { io::read_raster(path, {.reproject = system, .cell_m = cell_m}); });
        CHECK(test::is_sentence(sentence));
        return sentence;
    };
    CHECK_THAT(refusal(1e9),
               Contains("1 x 1") && Contains("1200 m high and 1500 m wide") && Contains("at most 4.8e+02"));
    CHECK_THAT(refusal(900), Contains("1 x 2"));
    CHECK_THAT(refusal(1e-3), Contains("1.2e+06 x 1.5e+06") && Contains("cells of about 30 m") && Contains("at least"));
    CHECK_THAT(refusal(1e-300), Contains("at least"));
    CHECK_THAT(refusal(1e9, "EPSG:32610"), Contains("1 x 1"));
    CHECK_THAT(refusal(1e-3, "EPSG:2229"), Contains("cells of about 30 m"));  // a plane in feet
    CHECK(io::read_raster(path, {.cell_m = 480}).raster.grid.rows >= 2);      // what it told to give
}

TEST_CASE("Another coordinate system puts each height where it lies on the earth", "[window]") {
    const TempFolder temp;
    const auto path = write(temp, plane);
    const Raster warped = io::read_raster(path, {.reproject = "EPSG:32610", .cell_m = 30}).raster;
    OGRSpatialReference from, to;
    from.importFromEPSG(32610);
    to.importFromEPSG(32611);
    const std::unique_ptr<OGRCoordinateTransformation> back(OGRCreateCoordinateTransformation(&from, &to));
    Index known = 0;
    for (Index node = 0; node < warped.grid.size(); ++node) {
        const Point p = middle(warped, node);
        double x = p.x, y = p.y;
        REQUIRE(back->Transform(1, &x, &y));
        const bool inner = x > 500060 && x < 501440 && y > 3998860 && y < 3999940;
        if (!inner) continue;
        ++known;
        CHECK(warped.values[node] == Approx(plane(x, y)).margin(1e-3));
    }
    CHECK(known > 1000);
    CHECK_THAT(error_of([&] { io::read_raster(path, {.reproject = "Atlantis"}); }), Contains("no coordinate system"));
    CHECK_THAT(error_of([&] { io::read_raster(path, {.reproject = "EPSG:4326", .cell_m = 30}); }),
               Contains("projected coordinate system"));
}

TEST_CASE("On larger cells heights are means over the same ground, and half a cell's ground needs data", "[window]") {
    const TempFolder temp;
    Raster fine = io::read_raster(write(temp, [](double x, double y) { return std::sin(x / 40) + y / 100; })).raster;
    const double nan = std::nan("");
    for (const Index row : {0u, 1u}) {
        for (const Index col : {0u, 1u}) fine.values[row * 50 + col] = nan;  // all of the first block
    }
    fine.values[2] = fine.values[3] = fine.values[52] = nan;  // three quarters of the second
    fine.values[4] = nan;                                     // a quarter of the third
    const Raster large = io::on_larger_cells(fine, 2);
    REQUIRE(large.grid.rows == 20);
    REQUIRE(large.grid.cols == 25);
    CHECK(large.placement.cell_width == Approx(60));
    CHECK(large.grid.east_west[0] == Approx(60));
    CHECK(large.placement.crs_wkt == fine.placement.crs_wkt);
    CHECK(std::isnan(large.values[0]));
    CHECK(std::isnan(large.values[1]));
    CHECK(large.values[2] == Approx((fine.values[5] + fine.values[54] + fine.values[55]) / 3).epsilon(1e-12));
    for (Index row = 0; row < 20; ++row) {
        for (Index col = 3; col < 25; ++col) {
            const Index at = 2 * row * 50 + 2 * col;
            const double mean =
                (fine.values[at] + fine.values[at + 1] + fine.values[at + 50] + fine.values[at + 51]) / 4;
            CHECK(large.values[row * 25 + col] == Approx(mean).epsilon(1e-12));
        }
    }
}

TEST_CASE("Cells that do not nest cover the same ground by whole ones, also on degrees and without a place",
          "[window]") {
    for (const std::string& crs : {std::string("EPSG:4326"), std::string()}) {
        const TempFolder temp;
        const double step = crs.empty() ? 10 : 1.0 / 1200;
        const Placement place{.west = 10, .north = 46, .cell_width = step, .cell_height = step, .crs_wkt = ""};
        std::vector<double> values(41 * 53);
        for (std::size_t i = 0; i < values.size(); ++i) values[i] = 3.0 * static_cast<double>(i % 53);
        io::write_raster(temp / "fine.tif", plane_grid(41, 53, step, step), place, values, {});
        const Raster fine = io::read_raster(temp / "fine.tif", {.crs = crs}).raster;
        REQUIRE(fine.placement.geographic == !crs.empty());
        const Raster large = io::on_larger_cells(fine, 1.5);
        CHECK(large.grid.rows == 27);
        CHECK(large.grid.cols == 35);
        CHECK(large.placement.geographic == fine.placement.geographic);
        CHECK(large.placement.west == fine.placement.west);
        CHECK(large.placement.cell_width * 35 == Approx(fine.placement.cell_width * 53).epsilon(1e-12));
        double fine_area = 0, large_area = 0;
        for (const double area : fine.grid.cell_area) fine_area += area * 53;
        for (const double area : large.grid.cell_area) large_area += area * 35;
        CHECK(large_area == Approx(fine_area).epsilon(1e-9));
        for (Index col = 2; col < 33; ++col) {  // a plane stays one
            CHECK(large.values[13 * 35 + col] == Approx(3 * ((col + 0.5) * 53 / 35 - 0.5)).margin(0.3));
        }
    }
}
