// SPDX-License-Identifier: GPL-3.0-or-later
#include "thalweg/study/height_survey.hpp"

#include <catch2/catch.hpp>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "support/drawing.hpp"
#include "support/drawn_catchment.hpp"
#include "support/temp_folder.hpp"
#include "support/terrains.hpp"
#include "thalweg/study/analyze.hpp"

using namespace thalweg;
using namespace thalweg::study;
using support::raster_of;
using Json = nlohmann::json;

namespace {

/// Noise smoothed over three cells each way, so that neighbours know of each other as in terrain.
Raster hills(Index rows, Index cols, std::uint64_t seed) {
    const auto noise = support::noise_terrain(rows + 2, cols + 2, seed);
    return raster_of(support::terrain_of("hills", rows, cols, [&](Index r, Index c) {
        double sum = 0;
        for (Index i = 0; i < 3; ++i) {
            for (Index j = 0; j < 3; ++j) sum += noise.elevation_m[(r + i) * (cols + 2) + c + j];
        }
        return 10 * sum;
    }));
}

std::string hints_of(const Raster& raster, double quantum_m = 0) {
    return Json(survey_hints(survey_heights(raster), raster, quantum_m)).dump();
}

}  // namespace

TEST_CASE("A drawn raster has the shares that one counts on it", "[survey]") {
    const auto d = support::draw(R"(
        1 1 2 4 7
        1 1 2 4 7
        0 5 5 # 5
        0 0 5 6 6
        3 8 1 9 2)");
    const HeightSurvey s = survey_heights(raster_of({"drawn", plane_grid(5, 5, 1, 1), d.values}));
    CHECK(s.most_frequent_m == 1);
    CHECK(s.most_frequent_share == Approx(5.0 / 24));
    CHECK(s.zero_share == Approx(3.0 / 24));
    // East–west 5 5, 0 0 and 6 6, north–south 2 2, 4 4, 7 7, 0 0 and 5 5; the ones are the most frequent height.
    CHECK(s.level_share == Approx(8.0 / 36));
    // By size, of both directions: five of 1, three of 2, five of 3, three of 4, four of 5, two of 7 and two of 8.
    CHECK(s.median_step_m == 3);
    CHECK(s.repeated_rows == Approx(1.0 / 4));  // the second of five rows repeats the first
    CHECK(s.repeated_columns == 0);
}

TEST_CASE("Striping is the share of roughness that rows have for themselves, by hand", "[survey]") {
    // Differences from the mean of the rows above and below: -1 -1 -1 -1, then 2 2 2 1/2 (mean 13/8), then
    // -1 -1 -1 1/2 (mean -5/8). The middle row has 13/8 - (-1 - 5/8)/2 = 39/16 of its own; squares 4, 49/4, 13/4.
    const auto d = support::draw(R"(
        0 0 0 0
        0 0 0 0
        2 2 2 2
        0 0 0 3
        0 0 0 3)");
    const HeightSurvey s = survey_heights(raster_of({"drawn", plane_grid(5, 4, 1, 1), d.values}));
    CHECK(s.row_striping == Approx(12.0 / 35 * 4 * (39.0 / 16) * (39.0 / 16) / (4 + 49.0 / 4 + 13.0 / 4)));
    CHECK(s.row_roughness_m == Approx(std::sqrt((4 + 49.0 / 4 + 13.0 / 4) / 12)));
    CHECK(s.column_roughness_m == Approx(std::sqrt(2 * 1.5 * 1.5 / 10)));  // beside the two threes
    CHECK(s.largest_m == 3);
}

TEST_CASE("Independent offsets of rows and nothing else have a striping of one, but for the tenth left out",
          "[survey]") {
    Random random(4, 2);
    std::vector<double> offset(3000);
    for (double& each : offset) each = 100 * random.uniform();
    const HeightSurvey s =
        survey_heights(raster_of(support::terrain_of("rows", 3000, 8, [&](Index r, Index) { return offset[r]; })));
    // Of squares of sums of uniform numbers the upper tenth holds about two fifths.
    CHECK(s.row_striping > 0.5);
    CHECK(s.row_striping < 0.75);
    CHECK(std::isnan(s.column_striping));
}

TEST_CASE("Smooth shapes, blocks and planes are not striped, however long their edges", "[survey]") {
    struct Shape {
        const char* name;
        double (*height)(double x, double y);  // over the half width, from -1 to 1
    };
    const std::vector<Shape> shapes{
        {"cone", [](double x, double y) { return -std::hypot(x, y); }},
        {"cone beside the middle", [](double x, double y) { return -std::hypot(x + 0.3, y - 0.41); }},
        {"oblong cone", [](double x, double y) { return -std::hypot(2 * x, y); }},
        {"bowl", [](double x, double y) { return x * x + y * y; }},
        {"steep bowl", [](double x, double y) { return std::pow(x * x + y * y, 0.75); }},
        {"saddle", [](double x, double y) { return x * x - y * y; }},
        {"dome", [](double x, double y) { return std::sqrt(std::max(0.0, 0.7 - x * x - y * y)); }},
        {"pyramid", [](double x, double y) { return -std::max(std::abs(x), std::abs(y)); }},
        {"roof", [](double x, double) { return -std::abs(x); }},
        {"four roofs", [](double x, double y) { return -std::abs(x) - 2 * std::abs(y); }},
        {"block", [](double x, double y) { return std::abs(x) < 0.5 && std::abs(y) < 0.7 ? 1.0 : 0.0; }},
        {"large block", [](double x, double y) { return std::max(std::abs(x), std::abs(y)) < 0.9 ? 1.0 : 0.0; }},
        {"waves", [](double x, double y) { return std::sin(9 * x) + std::cos(7 * y); }},
        {"plane", [](double x, double y) { return 0.3 * x + 0.123 * y; }},
        {"plane to the east", [](double x, double) { return 0.3 * x; }},
        {"plane to the north", [](double, double y) { return 0.3 * y; }},
    };
    for (const Shape& shape : shapes) {
        for (const auto& [rows, cols] : {std::pair<Index, Index>{100, 100}, {61, 240}, {90, 240}, {301, 180}}) {
            const auto height = [&](Index r, Index c) {
                return 700 + 500 * shape.height(2.0 * c / (cols - 1) - 1, 2.0 * r / (rows - 1) - 1);
            };
            const Raster exact = raster_of(support::terrain_of("shape", rows, cols, height));
            Raster single = exact;
            for (double& z : single.values) z = static_cast<float>(z);
            CAPTURE(shape.name, rows, cols);
            CHECK(hints_of(exact).find("striped") == std::string::npos);
            const bool has_level_rows = std::string(shape.name).ends_with("block");
            CHECK((has_level_rows || hints_of(exact).find("repeat") == std::string::npos));
            CHECK(hints_of(single).find("striped") == std::string::npos);
        }
    }
}

TEST_CASE("Values repeated over blocks are repeated, not striped", "[survey]") {
    for (std::uint64_t seed = 0; seed < 10; ++seed) {
        for (const Index block : {2u, 3u, 5u, 10u, 20u, 50u}) {
            const auto coarse = support::noise_terrain(200 / block + 1, 300 / block + 1, seed);
            const Raster raster = raster_of(support::terrain_of("blocks", 200, 300, [&](Index r, Index c) {
                return 100 * coarse.elevation_m[r / block * (300 / block + 1) + c / block];
            }));
            CAPTURE(seed, block);
            CHECK(hints_of(raster).find("striped") == std::string::npos);
            CHECK(hints_of(raster).find("rows repeat") != std::string::npos);
            CHECK(hints_of(raster).find("columns repeat") != std::string::npos);
        }
    }
}

TEST_CASE(
    "Hills are not striped, whatever their seed; with stripes of a tenth of their height they are, and the right way",
    "[survey]") {
    for (std::uint64_t seed = 0; seed < 20; ++seed) {
        const Raster plain = hills(200, 300, seed);
        INFO(seed);
        CHECK(hints_of(plain).find("striped") == std::string::npos);
        Raster along_columns = plain, along_rows = plain;
        Random random(seed, 9);
        std::vector<double> offset(300);
        for (double& each : offset) each = 6 * random.uniform();
        for (Index node = 0; node < plain.grid.size(); ++node) {
            along_columns.values[node] += offset[plain.grid.col(node)];
            along_rows.values[node] += offset[plain.grid.row(node)];
        }
        CHECK(hints_of(along_columns).find("striped along columns") != std::string::npos);
        CHECK(hints_of(along_columns).find("striped along rows") == std::string::npos);
        CHECK(hints_of(along_rows).find("striped along rows") != std::string::npos);
        CHECK(hints_of(along_rows).find("striped along columns") == std::string::npos);
    }
}

TEST_CASE("Repeated values, terraces, one value in many cells and oblong cells are hinted at, and only they",
          "[survey]") {
    const Raster plain = hills(60, 80, 1);
    CHECK(hints_of(plain) == "[]");
    Raster doubled = plain, terraced = plain, filled = plain;
    for (Index node = 0; node < plain.grid.size(); ++node) {
        const Index row = plain.grid.row(node), col = plain.grid.col(node);
        doubled.values[node] = plain.values[row / 2 * 80 + col / 2];
        terraced.values[node] = std::round(plain.values[node] / 20) * 20;
        if (row > 10 && row < 30 && col > 10 && col < 30) filled.values[node] = -5;
    }
    CHECK(hints_of(doubled).find("51 % of the rows repeat") != std::string::npos);
    CHECK(hints_of(doubled).find("% of the columns repeat") != std::string::npos);
    CHECK(hints_of(terraced, 20).find("heights being multiples of 20 m") != std::string::npos);
    CHECK(hints_of(filled).find("exactly -5 m") != std::string::npos);
    Raster oblong = plain;
    oblong.grid = plane_grid(60, 80, 10, 2);
    CHECK(hints_of(oblong).find("5 times as wide as high") != std::string::npos);
    oblong.grid = plane_grid(60, 80, 2, 10);
    CHECK(hints_of(oblong).find("0.2 times as wide as high") != std::string::npos);
}

TEST_CASE("Ties, level lines and heights below zero are counted as said, by hand", "[survey]") {
    const auto survey = [](const char* drawing, Index rows, Index cols) {
        return survey_heights(raster_of({"drawn", plane_grid(rows, cols, 1, 1), support::draw(drawing).values}));
    };
    // Three of -2, three of 0: the lower is the most frequent. Three pairs of rows hold a varied one,
    // one of them is equal.
    const HeightSurvey s = survey(R"(
        5 5 5
        -2 0 1
        -2 0 1
        -2 0 -9)",
                                  4, 3);
    CHECK(s.most_frequent_m == -2);
    CHECK(s.most_frequent_share == Approx(3.0 / 12));
    CHECK(s.zero_share == Approx(3.0 / 12));
    CHECK(s.repeated_rows == Approx(1.0 / 3));
    CHECK(s.repeated_columns == 0);
    CHECK(s.largest_m == 9);
    // A level pair says nothing, a level line beside a varied one is a pair that is not equal.
    CHECK(survey("4 4 4\n4 4 4\n1 2 3\n1 2 3\n", 4, 3).repeated_rows == Approx(1.0 / 2));
    CHECK(survey("4 4 1 1\n4 4 2 2\n4 4 3 3\n", 3, 4).repeated_columns == Approx(1.0 / 2));
    // Cells without data are alike.
    CHECK(survey("1 # 3\n1 # 3\n2 # 5\n", 3, 3).repeated_rows == Approx(1.0 / 2));
    CHECK(survey("1 1 2\n# # 5\n3 3 4\n", 3, 3).repeated_columns == Approx(1.0 / 2));
}

TEST_CASE("A value in many cells is hinted at unless it stands on one of the four sides, of which the reader warns",
          "[survey]") {
    const Raster plain = hills(60, 80, 2);
    const auto hints = [&](Index first_row, Index first_col) {
        Raster raster = plain;
        for (Index r = 0; r < 20; ++r) {
            for (Index c = 0; c < 20; ++c) raster.values[std::size_t{first_row + r} * 80 + first_col + c] = -5;
        }
        return hints_of(raster).find("exactly -5 m") != std::string::npos;
    };
    CHECK(hints(20, 30));
    CHECK(hints(1, 1));
    CHECK(hints(39, 59));
    CHECK_FALSE(hints(0, 30));
    CHECK_FALSE(hints(40, 30));
    CHECK_FALSE(hints(20, 0));
    CHECK_FALSE(hints(20, 60));
}

TEST_CASE("Roughness that rounding makes is no stripes", "[survey]") {
    const Raster stairs = raster_of(support::terrain_of(
        "plane in whole metres", 200, 200, [](Index r, Index c) { return std::round(0.3 * c + 0.013 * r); }));
    CHECK(hints_of(stairs, 1).find("striped") == std::string::npos);
    CHECK(hints_of(stairs, 0).find("striped along rows") != std::string::npos);
}

TEST_CASE("A large raster is sampled alike from all its sides", "[survey]") {
    for (const auto& [rows, cols] : {std::pair<Index, Index>{700, 601}, {604, 703}, {1200, 300}}) {
        const Raster plain = hills(rows, cols, rows);
        Raster turned = raster_of(support::terrain_of("turned", cols, rows, [&](Index r, Index c) {
            return plain.values[std::size_t{rows - 1 - c} * cols + r];
        }));
        Raster mirrored = raster_of(support::terrain_of("mirrored", rows, cols, [&](Index r, Index c) {
            return plain.values[std::size_t{r} * cols + cols - 1 - c];
        }));
        const HeightSurvey a = survey_heights(plain), b = survey_heights(turned), c = survey_heights(mirrored);
        CHECK(a.median_step_m == b.median_step_m);
        CHECK(a.median_step_m == c.median_step_m);
        CHECK(a.most_frequent_m == b.most_frequent_m);
        CHECK(a.most_frequent_m == c.most_frequent_m);
        CHECK(a.row_striping == Approx(b.column_striping).epsilon(1e-10));
        CHECK(a.column_striping == Approx(b.row_striping).epsilon(1e-10));
        CHECK(a.row_striping == Approx(c.row_striping).epsilon(1e-10));
        CHECK(a.column_striping == Approx(c.column_striping).epsilon(1e-10));
    }
}

TEST_CASE("Striping of odd sizes with holes equals what a plain loop finds", "[survey]") {
    for (std::uint64_t seed = 0; seed < 10; ++seed) {
        const Index rows = static_cast<Index>(5 + 3 * seed), cols = static_cast<Index>(31 - 2 * seed);
        Raster raster = hills(rows, cols, seed);
        Random random(seed, 3);
        for (double& height : raster.values) {
            if (random.uniform() < 0.1) height = support::nodata;
        }
        double squares = 0;
        std::vector<double> mean_of(cols, support::nodata), cells(cols, 0);
        for (Index col = 1; col + 1 < cols; ++col) {
            double sum = 0;
            for (Index row = 0; row < rows; ++row) {
                const double* const z = &raster.values[std::size_t{row} * cols + col];
                const double d = *z - (z[-1] + z[1]) / 2;
                if (std::isnan(d)) continue;
                sum += d, ++cells[col], squares += d * d;
            }
            if (2 * cells[col] >= rows) mean_of[col] = sum / cells[col];
        }
        std::vector<double> own;
        for (Index col = 1; col + 1 < cols; ++col) {
            const double h = mean_of[col] - (mean_of[col - 1] + mean_of[col + 1]) / 2;
            if (!std::isnan(h)) own.push_back(cells[col] * h * h);
        }
        std::sort(own.begin(), own.end());
        double common = 0;
        for (std::size_t i = 0; i < own.size() - own.size() / 10; ++i) common += own[i] * 12 / 35;
        CHECK(survey_heights(raster).column_striping == Approx(common / squares).epsilon(1e-10));
    }
}

TEST_CASE("Rasters without anything to count have no shares, and are no error", "[survey]") {
    const HeightSurvey s = survey_heights(raster_of(support::flat_terrain(2, 2)));
    CHECK(std::isnan(s.row_striping));
    CHECK(std::isnan(s.repeated_rows));
    CHECK(std::isnan(s.median_step_m));
    CHECK(s.most_frequent_share == 1);
    Raster empty = raster_of(support::flat_terrain(4, 4));
    for (double& value : empty.values) value = support::nodata;
    CHECK(std::isnan(survey_heights(empty).most_frequent_share));
    CHECK(hints_of(empty) == "[]");
}

TEST_CASE("The summary and one line say how the DEM came", "[survey]") {
    const test::TempFolder temp;
    NamedRaster dem{support::drawn_catchment(), "drawn.tif", "", "", {}, {}};
    dem.vertical_unit_m = 0.3048;
    dem.void_cells = 3;
    MeasureOptions options;
    options.channel_area_m2 = 200;
    std::vector<std::string> lines;
    const Messages messages{.report = [&](const std::string& line) { lines.push_back(line); }};
    const Json ingest = Json::parse(analyze(dem, options, temp / "", messages))["ingest"];
    CHECK(ingest["vertical_unit_m"] == 0.3048);
    CHECK(ingest["void_cells"] == 3);
    CHECK(ingest["nodata_share"].get<double>() == Approx(7.0 / 64));
    CHECK(ingest["pits"] == 0);
    CHECK(ingest["vertical_quantum_m"] == 0.5);
    CHECK(ingest["cut_basins"].get<int>() >= 2);  // the two flanks, at least
    REQUIRE(lines.size() == 1);
    CHECK(lines[0].find("drawn.tif: no coordinate system, 8 rows x 8 columns of cells of 10 m north-south x 10 m "
                        "east-west, heights from -100.0 to 25.0 m in steps of 0.5 m") == 0);
    dem.raster = raster_of(support::terrain_of(
        "oblong", 5, 7, [](Index r, Index c) { return r + 0.1 * c; }, 30, 20));
    analyze(dem, options, temp / "", messages);
    CHECK(lines[1].find("5 rows x 7 columns of cells of 20 m north-south x 30 m east-west") != std::string::npos);
}
