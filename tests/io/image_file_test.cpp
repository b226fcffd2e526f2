// SPDX-License-Identifier: GPL-3.0-or-later
#include "thalweg/io/image_file.hpp"

#include <gdal_priv.h>

#include <catch2/catch.hpp>
#include <cmath>
#include <limits>

#include "support/temp_folder.hpp"
#include "thalweg/core/random.hpp"
#include "thalweg/io/raster_file.hpp"

using namespace thalweg;
using io::Image;
using io::read_image;
using test::TempFolder;

namespace {

constexpr double no_data = std::numeric_limits<double>::quiet_NaN();

/// The same picture as ASCII and as bytes: `colours` values a cell.
struct Pair {
    std::string ascii, bytes;
};

Pair pictures(int cols, int rows, int colours, int largest, std::uint64_t seed) {
    Random random(seed, 1);
    Pair pair;
    pair.ascii = colours == 3 ? "P3 # colours\n" : "P2\n# grey\n";
    pair.bytes = colours == 3 ? "P6\n" : "P5\n";
    const std::string size = std::to_string(cols) + " " + std::to_string(rows) + "\n" + std::to_string(largest) + "\n";
    pair.ascii += size;
    pair.bytes += size;
    for (int i = 0; i < cols * rows * colours; ++i) {
        const auto value = random.below(static_cast<std::uint32_t>(largest) + 1);
        pair.ascii += std::to_string(value) + (i % 7 == 6 ? " # remark\n" : i % 5 == 4 ? "\t" : " ");
        if (largest > 255) pair.bytes += static_cast<char>(value >> 8);
        pair.bytes += static_cast<char>(value & 255);
    }
    return pair;
}

void write_bands(const std::filesystem::path& path, const char* driver, int cols, int rows,
                 const std::vector<std::vector<std::uint8_t>>& bands) {
    GDALAllRegister();
    GDALDriver* memory = GetGDALDriverManager()->GetDriverByName("MEM");
    GDALDataset* made = memory->Create("", cols, rows, static_cast<int>(bands.size()), GDT_Byte, nullptr);
    for (std::size_t b = 0; b < bands.size(); ++b) {
        GDALRasterBand* band = made->GetRasterBand(static_cast<int>(b) + 1);
        CHECK(band->RasterIO(GF_Write, 0, 0, cols, rows, const_cast<std::uint8_t*>(bands[b].data()), cols, rows,
                             GDT_Byte, 0, 0, nullptr) == CE_None);
    }
    GDALDriver* target = GetGDALDriverManager()->GetDriverByName(driver);
    GDALClose(target->CreateCopy(path.c_str(), made, FALSE, nullptr, nullptr, nullptr));
    GDALClose(made);
}

std::string refusal(const std::filesystem::path& path) {
    return test::error_of([&] { read_image(path); });
}

}  // namespace

TEST_CASE("ASCII pictures hold the same values as the same picture in bytes, read by GDAL", "[image]") {
    const TempFolder temp;
    for (std::uint64_t seed = 0; seed < 12; ++seed) {
        const int colours = seed % 2 ? 3 : 1;
        const int largest = seed % 3 == 2 && colours == 1 ? 60000 : 255;
        const Pair pair =
            pictures(1 + static_cast<int>(seed * 5 % 17), 1 + static_cast<int>(seed * 3 % 11), colours, largest, seed);
        const Image ascii = read_image(temp.text("a.pnm", pair.ascii));
        const Image bytes = read_image(temp.text(colours == 3 ? "b.ppm" : "b.pgm", pair.bytes));
        CHECK(ascii.rows == bytes.rows);
        CHECK(ascii.cols == bytes.cols);
        REQUIRE(ascii.values.size() == bytes.values.size());
        for (std::size_t i = 0; i < ascii.values.size(); ++i) CHECK(ascii.values[i] == Approx(bytes.values[i]));
        CHECK_FALSE(ascii.placed);
        CHECK_FALSE(bytes.placed);
    }
}

TEST_CASE("ASCII pictures that do not hold what their header says are refused in one sentence", "[image]") {
    const TempFolder temp;
    for (const char* text :
         {"P2\n", "P2\n3 2\n", "P2\n3 2\n255\n1 2 3 4 5", "P2\n3 2\n255\n1 2 3 4 5 6 7", "P2\n3 2\n255\n1 2 3 4 5 256",
          "P2\n3 2\n255\n1 2 3 4 5 -6", "P2\n3 2\n255\n1 2 3 4 5 x", "P2\n0 2\n255\n", "P2\n3 2\n0\n",
          "P2\n3 2\n70000\n", "P3\n1 1\n255\n1 2", "P2\n100000 100000\n255\n1 2 3", "P2\n-3 2\n255\n"}) {
        INFO(text);
        CHECK(test::is_sentence(refusal(temp.text("bad.pgm", text))));
    }
    CHECK(refusal(temp.text("short.pgm", "P2\n3 2\n255\n1 2 3 4 5")).find("5 values, not the 6") != std::string::npos);
}

TEST_CASE("Of a coloured picture the value is the mean of the colours, and transparent cells are void", "[image]") {
    const TempFolder temp;
    write_bands(temp / "rgb.png", "PNG", 2, 1, {{30, 255}, {60, 255}, {90, 252}});
    CHECK(read_image(temp / "rgb.png").values == std::vector<double>{60, 254});
    write_bands(temp / "rgba.png", "PNG", 2, 1, {{30, 200}, {60, 200}, {90, 200}, {0, 255}});
    const Image seen = read_image(temp / "rgba.png");
    CHECK(std::isnan(seen.values[0]));
    CHECK(seen.values[1] == 200);
    CHECK(seen.largest() == 200);
    write_bands(temp / "grey.png", "PNG", 2, 2, {{1, 2, 3, 4}});
    CHECK(read_image(temp / "grey.png").values == std::vector<double>{1, 2, 3, 4});
}

TEST_CASE("A raster on the map keeps its place and its voids, a plain picture has none", "[image]") {
    const TempFolder temp;
    Raster raster{
        plane_grid(2, 3, 10, 10), {.west = 500, .north = 900, .cell_width = 10, .cell_height = 10, .crs_wkt = {}}, {}};
    raster.values = {1, 2, 3, 4, no_data, 6};
    io::write_raster(temp / "map.tif", raster.grid, raster.placement, raster.values, {});
    const Image image = read_image(temp / "map.tif");
    CHECK(image.placed);
    CHECK(image.placement.west == 500);
    CHECK(image.placement.north == 900);
    CHECK(image.placement.cell_width == 10);
    CHECK(image.placement.crs_wkt.empty());
    CHECK(std::isnan(image.values[4]));
    CHECK(image.values[5] == 6);
}

TEST_CASE("Files that are no image are refused in one sentence", "[image]") {
    const TempFolder temp;
    CHECK(test::is_sentence(refusal(temp / "missing.png")));
    CHECK(test::is_sentence(refusal(temp.text("empty.png", ""))));
    CHECK(test::is_sentence(refusal(temp.text("text.png", "no picture"))));
    write_bands(temp / "cut.png", "PNG", 40, 40, {std::vector<std::uint8_t>(1600, 7)});
    const std::string whole = test::bytes_of(temp / "cut.png");
    CHECK(test::is_sentence(refusal(temp.text("cut.png", whole.substr(0, whole.size() / 2)))));
}

TEST_CASE("Bilinear sampling is exact on planes between centres, level beyond them, and void outside", "[image]") {
    Image image{.rows = 4, .cols = 5, .values = {}};
    for (int row = 0; row < 4; ++row) {
        for (int col = 0; col < 5; ++col) image.values.push_back(2 * (col + 0.5) - 3 * (row + 0.5) + 7);
    }
    for (double x = 0.5; x <= 4.5; x += 0.13) {
        for (double y = 0.5; y <= 3.5; y += 0.17) CHECK(bilinear(image, x, y) == Approx(2 * x - 3 * y + 7));
    }
    CHECK(bilinear(image, 0, 0) == image.values[0]);
    CHECK(bilinear(image, 5, 4) == image.values[19]);
    CHECK(std::isnan(bilinear(image, 5.1, 2)));
    CHECK(std::isnan(bilinear(image, 2, -0.1)));
    CHECK(std::isnan(bilinear(image, no_data, 2)));
    image.values[6] = no_data;
    CHECK(std::isnan(bilinear(image, 1.5, 1.5)));                       // in the void cell
    CHECK(bilinear(image, 0.9, 0.5) == Approx(2 * 0.9 - 3 * 0.5 + 7));  // beside it, on the row above
    CHECK(std::isfinite(bilinear(image, 0.9, 0.9)));                    // the others' shares raised
    const Image one{.rows = 1, .cols = 1, .values = {8}};
    CHECK(bilinear(one, 0.2, 0.9) == 8);
}
