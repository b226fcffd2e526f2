// SPDX-License-Identifier: GPL-3.0-or-later
#include "thalweg/study/render.hpp"

#include <gdal_priv.h>

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <limits>

#include "support/temp_folder.hpp"
#include "thalweg/core/parallel.hpp"
#include "thalweg/io/raster_file.hpp"
#include "thalweg/io/table_file.hpp"
#include "thalweg/study/output_file.hpp"

using namespace thalweg;
using namespace thalweg::study;
using test::bytes_of;
using test::error_of;
using test::is_sentence;
using test::TempFolder;

namespace {

const std::filesystem::path jacksboro = THALWEG_SOURCE_DIR "/validation/data/jacksboro.tif";
const double no_data = std::numeric_limits<double>::quiet_NaN();

RenderOptions small() {
    RenderOptions o;
    o.view.width = 120;
    o.view.height = 80;
    o.samples = 2;
    return o;
}

struct Pixels {
    int width = 0, height = 0;
    std::vector<std::uint8_t> rgb;

    const std::uint8_t* at(int col, int row) const { return &rgb[3 * (std::size_t(row) * width + col)]; }
    template <class Test>
    Index count(Test test) const {
        Index n = 0;
        for (std::size_t i = 0; i < rgb.size(); i += 3) n += test(rgb[i], rgb[i + 1], rgb[i + 2]);
        return n;
    }
};

Pixels decoded(const std::string& png, const TempFolder& folder) {
    GDALAllRegister();
    const auto path = folder.text("decoded.png", png);
    const GDALDatasetUniquePtr file(GDALDataset::Open(path.c_str(), GDAL_OF_RASTER));
    REQUIRE(file);
    REQUIRE(file->GetRasterCount() == 3);
    Pixels p{file->GetRasterXSize(), file->GetRasterYSize(), {}};
    p.rgb.resize(3 * std::size_t(p.width) * p.height);
    REQUIRE(file->RasterIO(GF_Read, 0, 0, p.width, p.height, p.rgb.data(), p.width, p.height, GDT_Byte, 3, nullptr, 3,
                           3 * p.width, 1, nullptr) == CE_None);
    return p;
}

bool is_white(int r, int g, int b) { return r == 255 && g == 255 && b == 255; }

/// A plane of 60 by 40 cells of 10 m in UTM, no data in its western third.
std::filesystem::path half_empty(const TempFolder& folder) {
    const Grid grid = plane_grid(40, 60, 10, 10);
    std::vector<double> heights(grid.size());
    for (Index i = 0; i < grid.size(); ++i) heights[i] = grid.col(i) < 20 ? no_data : 100 + 0.5 * grid.row(i);
    io::write_raster(folder / "plane.tif", grid,
                     {.west = 500000, .north = 4000000, .cell_width = 10, .cell_height = 10, .crs_wkt = {}}, heights,
                     {});
    return folder / "plane.tif";
}

}  // namespace

TEST_CASE("A real DEM in degrees is drawn in each style and colour, the same for any number of threads") {
    const TempFolder folder;
    for (const PictureStyle style : {PictureStyle::surface, PictureStyle::wireframe, PictureStyle::polygons}) {
        for (const PictureColor color : {PictureColor::clay, PictureColor::kelley, PictureColor::elevation}) {
            RenderOptions o = small();
            o.style = style;
            if (style == PictureStyle::wireframe) {
                o.samples.reset();
            } else {
                o.color = color;
            }
            const auto drawn = [&](int threads) {
                const ThreadLimit limit(threads);
                return render_dem(jacksboro, "view.png", o, {});
            };
            const std::string one = drawn(1);
            CHECK(one == drawn(2));
            const Pixels pixels = decoded(one, folder);
            CHECK(pixels.width == 120);
            CHECK(pixels.height == 80);
            CHECK(pixels.count([](int r, int, int) { return r < 100; }) > 100);
        }
    }
}

TEST_CASE("No data is not drawn, and seen from above the rest has its own proportions") {
    const TempFolder folder;
    RenderOptions o = small();
    o.view = {.azimuth = std::numbers::pi,
              .elevation = std::numbers::pi / 2,
              .field_of_view = 0.1,
              .width = 100,
              .height = 100,
              .margin = 0.1};
    o.background = PictureBackground::white;
    o.sides = PictureSides::none;
    o.samples = 1;
    const Pixels pixels = decoded(render_dem(half_empty(folder), "view.png", o, {}), folder);
    const Index drawn = 100 * 100 - pixels.count(is_white);
    CHECK(drawn == Approx(80 * 80).epsilon(0.04));  // 40 by 40 cells with data: a square that fills the picture
    CHECK(is_white(pixels.at(5, 50)[0], pixels.at(5, 50)[1], pixels.at(5, 50)[2]));
}

TEST_CASE("Channels are painted where the network's lines are") {
    const TempFolder folder;
    const auto dem = half_empty(folder);
    const Table lines{.name = "links",
                      .columns = {{"area_m2", std::vector<double>{1e6}}},
                      .kind = GeometryKind::line,
                      .geometry = {{{500200, 3999800}, {500600, 3999800}}}};
    io::write_geopackage(folder / "network.gpkg", {lines}, "");
    RenderOptions o = small();
    o.view = {.azimuth = std::numbers::pi, .elevation = std::numbers::pi / 2, .width = 200, .height = 200};
    o.color = PictureColor::kelley;
    o.network = folder / "network.gpkg";
    const Pixels pixels = decoded(render_dem(dem, "view.png", o, {}), folder);
    const auto blueness = [&](int row) { return pixels.at(100, row)[2] - pixels.at(100, row)[0]; };
    CHECK(blueness(100) > blueness(40) + 25);
    CHECK(blueness(100) > blueness(160) + 25);
    const Table elsewhere{.name = "links", .columns = {}, .kind = GeometryKind::line, .geometry = {{{0, 0}, {9, 9}}}};
    io::write_geopackage(folder / "elsewhere.gpkg", {elsewhere}, "");
    o.network = folder / "elsewhere.gpkg";
    CHECK(is_sentence(error_of([&] { render_dem(dem, "view.png", o, {}); })));
}

TEST_CASE("A small DEM is not painted as if all of it were water") {
    const TempFolder folder;
    const Grid grid = plane_grid(40, 60, 10, 10);
    std::vector<double> valley(grid.size());
    for (Index i = 0; i < grid.size(); ++i) valley[i] = 100 + grid.col(i) + 2 * std::abs(grid.row(i) - 19.0);
    io::write_raster(folder / "valley.tif", grid,
                     {.west = 500000, .north = 4000000, .cell_width = 10, .cell_height = 10, .crs_wkt = {}}, valley,
                     {});
    RenderOptions o = small();
    o.view = {.azimuth = std::numbers::pi, .elevation = std::numbers::pi / 2, .width = 120, .height = 80};
    o.color = PictureColor::kelley;
    o.background = PictureBackground::white;
    const auto share_of_water = [&] {
        const Pixels p = decoded(render_dem(folder / "valley.tif", "view.png", o, {}), folder);
        const double ground = p.count([](int r, int g, int b) { return !is_white(r, g, b); });
        return p.count([](int r, int g, int b) { return !is_white(r, g, b) && b > r + 10 && b > g; }) / ground;
    };
    CHECK(share_of_water() > 0.002);
    CHECK(share_of_water() < 0.15);
    o.channel_area_m2 = 200;  // two cells, which a thousandth of the area would be
    CHECK(share_of_water() > 0.5);
}

TEST_CASE("A block's oblique side is lit as one, however its cells step") {
    const TempFolder folder;
    const Grid grid = plane_grid(60, 90, 10, 10);
    std::vector<double> heights(grid.size());
    for (Index i = 0; i < grid.size(); ++i) {
        heights[i] = grid.row(i) > 30 + grid.col(i) / 4 ? no_data : 100 + 5.0 * grid.row(i);
    }
    io::write_raster(folder / "oblique.tif", grid,
                     {.west = 500000, .north = 4000000, .cell_width = 10, .cell_height = 10, .crs_wkt = {}}, heights,
                     {});
    RenderOptions o;
    o.view = {.azimuth = std::numbers::pi, .elevation = 0.3, .width = 300, .height = 200};
    o.background = PictureBackground::white;
    o.samples = 32;
    for (const double bearing : {100.0, 160.0, 230.0}) {  // sun along the side, on it, and a little from behind
        o.sun_azimuth = bearing * std::numbers::pi / 180;
        const Pixels lit = decoded(render_dem(folder / "oblique.tif", "view.png", o, {}), folder);
        int darkest = 255, lightest = 0;
        for (int col = 60; col < 240; ++col) {
            int row = lit.height - 1;
            while (row > 0 && is_white(lit.at(col, row)[0], lit.at(col, row)[1], lit.at(col, row)[2])) --row;
            const int green = lit.at(col, row - 6)[1];  // well up the side
            darkest = std::min(darkest, green);
            lightest = std::max(lightest, green);
        }
        INFO("sun at " << bearing << ": " << darkest << " to " << lightest);
        CHECK(lightest > 20);
        CHECK(lightest - darkest < 6);
    }
}

TEST_CASE("Lines become SVG, surfaces do not") {
    RenderOptions o = small();
    o.style = PictureStyle::wireframe;
    o.samples.reset();
    const std::string svg = render_dem(jacksboro, "view.svg", o, {});
    CHECK(svg.starts_with("<svg"));
    CHECK(std::count(svg.begin(), svg.end(), 'L') > 1000);
    o.style = PictureStyle::surface;
    CHECK(is_sentence(error_of([&] { render_dem(jacksboro, "view.svg", o, {}); })));
}

TEST_CASE("What a picture would not show is refused by name") {
    const auto refused = [](PictureStyle style, const char* out, auto change, const char* name) {
        RenderOptions o;
        o.style = style;
        change(o);
        const std::string error = error_of([&] { render_dem(jacksboro, out, o, {}); });
        CHECK(is_sentence(error));
        CHECK_THAT(error, Catch::StartsWith(std::string(name) + " does not show"));
    };
    const auto lines = [](RenderOptions& o) { o.lines = 60; };
    const auto samples = [](RenderOptions& o) { o.samples = 4; };
    const auto sides = [](RenderOptions& o) { o.sides = PictureSides::none; };
    const auto color = [](RenderOptions& o) { o.color = PictureColor::elevation; };
    const auto background = [](RenderOptions& o) { o.background = PictureBackground::white; };
    const auto sun = [](RenderOptions& o) { o.sun_azimuth = 1; };
    const auto height = [](RenderOptions& o) { o.sun_elevation = 1; };
    refused(PictureStyle::surface, "view.png", lines, "--lines");
    refused(PictureStyle::wireframe, "view.png", samples, "--samples");
    refused(PictureStyle::wireframe, "view.png", sides, "--sides");
    refused(PictureStyle::wireframe, "view.svg", color, "--color");
    refused(PictureStyle::wireframe, "view.png", background, "--background");
    refused(PictureStyle::wireframe, "view.png", sun, "--sun-azimuth");
    refused(PictureStyle::wireframe, "view.png", height, "--sun-elevation");
    refused(PictureStyle::polygons, "view.png", sides, "--sides");
    refused(PictureStyle::polygons, "view.svg", samples, "--samples");
    refused(PictureStyle::polygons, "view.svg", background, "--background");
    for (const auto& shown : {+samples, +background, +color, +sun, +lines}) {
        RenderOptions o;
        o.view.width = 60;
        o.view.height = 40;
        o.style = PictureStyle::polygons;
        shown(o);
        CHECK(error_of([&] { render_dem(jacksboro, "view.png", o, {}); }) == "");
    }
}

TEST_CASE("Pictures that cannot be drawn are refused with a sentence") {
    const TempFolder folder;
    const auto refused = [&](auto change, const char* out = "view.png") {
        RenderOptions o = small();
        change(o);
        CHECK(is_sentence(error_of([&] { render_dem(jacksboro, out, o, {}); })));
    };
    refused([](RenderOptions&) {}, "view.jpg");
    refused([](RenderOptions& o) { o.vertical_exaggeration = 0; });
    refused([](RenderOptions& o) { o.vertical_exaggeration = 1e300; });
    refused([](RenderOptions& o) { o.sun_azimuth = std::nan(""); });
    refused([](RenderOptions& o) { o.sun_elevation = std::numeric_limits<double>::infinity(); });
    refused([](RenderOptions& o) { o.view.azimuth = std::nan(""); });
    refused([](RenderOptions& o) { o.view.field_of_view = 1e-300; });
    refused([](RenderOptions& o) { o.samples = 0; });
    refused([](RenderOptions& o) { o.lines = 1; });
    refused([](RenderOptions& o) { o.view.width = 0; });
    refused([](RenderOptions& o) { o.view.elevation = 2; });
    refused([&](RenderOptions& o) { o.network = folder / "none.gpkg"; });
    refused([](RenderOptions& o) { o.channel_area_m2 = 1e6; });
    refused([](RenderOptions& o) { o.tree_line_m = 300; });
    refused([](RenderOptions& o) { o.snow_line_m = 300; });
    refused([&](RenderOptions& o) {
        o.network = folder / "none.gpkg";
        o.color = PictureColor::kelley;
    });
}

TEST_CASE("An output file appears whole, replaces only when told, and leaves nothing when it is not written") {
    const TempFolder folder;
    {
        OutputFile file(folder / "view.png", IfPresent::refuse);
        file.write("first");
    }
    CHECK(bytes_of(folder / "view.png") == "first");
    CHECK(is_sentence(error_of([&] { OutputFile(folder / "view.png", IfPresent::refuse); })));
    OutputFile(folder / "view.png", IfPresent::replace).write("second");
    CHECK(bytes_of(folder / "view.png") == "second");
    CHECK(is_sentence(error_of([&] { OutputFile(folder / "no/view.png", IfPresent::refuse); })));
    std::filesystem::create_directory(folder / "folder.png");
    CHECK(is_sentence(error_of([&] { OutputFile(folder / "folder.png", IfPresent::replace); })));
    OutputFile late(folder / "late.png", IfPresent::refuse);
    folder.text("late.png", "another's");
    CHECK(is_sentence(error_of([&] { late.write("ours"); })));
    late.discard();
    CHECK(bytes_of(folder / "late.png") == "another's");
    CHECK(std::distance(std::filesystem::directory_iterator(folder / "."), {}) == 3);
}
