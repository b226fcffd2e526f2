// SPDX-License-Identifier: GPL-3.0-or-later
// Turning, mirroring, raising and rescaling a DEM changes every number of its summary only as theory says. Each key has
// a dimension here: a key that is new is refused until it has one.
#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <nlohmann/json.hpp>
#include <optional>
#include <regex>
#include <tuple>

#include "support/drawn_catchment.hpp"
#include "support/steady_landscape.hpp"
#include "support/temp_folder.hpp"
#include "thalweg/study/analyze.hpp"

using namespace thalweg;
using namespace thalweg::study;
using support::raster_of;
using Json = nlohmann::json;

namespace {

/// How a number goes with the unit of distance and the unit of height, as powers; for heights above the datum, that
/// too.
struct Dimension {
    double length = 0, height = 0;
    bool above_datum = false;
};

/// What is known only by its place in an order, by chance, or not at all.
struct Kind {
    const char* pattern;
    std::optional<Dimension> dimension;  ///< none: not looked at
    double tolerance = 1e-8;             ///< of a change that theory has
    bool trunk_decides = false;          ///< of two rivers with as many cells the first is the main one
};

/// Names end with the unit where there is one; the rest is named. First match counts.
const std::vector<Kind> kinds{
    {"/input/(file|sha256|crs|geographic|rows|cols|dx_m|dy_m)", {}},
    {"/notes.*|/measured_on|/routing|.*/rule|/conditioning/method", {}},
    {"/basins/\\d+/(id|outlet_x|outlet_y)", {}},
    {"/ingest/hints/.*", {}},  // sentences with numbers
    {"/ingest/vertical_unit_m", Dimension{}},
    {"/ingest/most_frequent_m", Dimension{0, 1, true}},
    {"/ingest/(median_step|row_roughness|column_roughness)_m", Dimension{0, 1}},
    {"/ingest/cell_(width|height)", Dimension{1, 0}},
    {".*asymmetry_percent", {}},                                  // has a test of its own
    {"/chi/theta_(best|collinearity|disorder)_(se|ci95).*", {}},  // resamples are numbered rivers
    {"/chi/theta", Dimension{}},
    {"/chi/reference_area_m2", {}},  // 1 km² whatever the DEM
    {"/chi/theta_(collinearity|disorder)", Dimension{}, 1e-8, true},
    {"/chi/knickpoints", Dimension{}, 1e-8, true},
    {"/links/(cis|trans)/count|/links/cis_share", Dimension{}, 1e-8, true},
    {"/links/(cis|trans)/.*", Dimension{1, 0}, 1e-8, true},
    {".*/(segment_drop|vertical_quantum|knickpoint_prominence|relief|mean_drop)_m", Dimension{0, 1}},
    {".*/elevation_(min|max|mean)_m", Dimension{0, 1, true}},
    {".*_m3", Dimension{2, 1}},
    {".*/(relief_ratio|ruggedness|mean_slope|slope|slope_se)", Dimension{-1, 1}},
    {"/flint/p(_se|_ci95.*)?", Dimension{-1, 1}},
    {".*_per_m", Dimension{-1, 0}},
    {".*_m2(/\\d+)?", Dimension{2, 0}},
    {".*/(.*_m|distance_m/\\d+)", Dimension{1, 0}},
    {".*", Dimension{}},
};

const Kind& kind_of(const std::string& path) {
    for (const Kind& kind : kinds) {
        if (std::regex_match(path, std::regex(kind.pattern))) return kind;
    }
    throw std::out_of_range(path);
}

/// The powers of a steepness depend on its exponent: ks and ksn are S·A^θ, Hack's coefficient L·A^(−h).
std::optional<Dimension> fitted_dimension(const Json& flat, const std::string& path) {
    const auto number = [&](const std::string& key) { return flat.contains(key) ? flat[key].get<double>() : 0.0; };
    static const std::regex slope_area_ks("(/slope_area(_cells|_links)?)/ks");
    std::smatch match;
    if (std::regex_match(path, match, slope_area_ks)) return Dimension{2 * number(match[1].str() + "/theta") - 1, 1};
    if (path == "/hack/coefficient") return Dimension{1 - 2 * number("/hack/exponent"), 0};
    if (path == "/chi/ksn_median") return Dimension{2 * 0.45 - 1, 1};
    if (std::regex_match(path, std::regex("/basins/\\d+/ksn_.*"))) return Dimension{2 * 0.45 - 1, 1};
    static const std::regex basin_ks("(/basins/\\d+)/ks");
    if (std::regex_match(path, match, basin_ks)) return Dimension{2 * number(match[1].str() + "/theta") - 1, 1};
    return {};
}

/// Errors of coefficients mix with those of exponents when the unit changes; they are looked at where it does not.
bool hangs_on_unit(const std::string& path) {
    return std::regex_match(path, std::regex(".*/ks_se|/hack/coefficient_.*"));
}

struct Change {
    double length = 1, height = 1, raised_m = 0;
};

/// Compares two summaries; returns how many numbers were looked at.
int check_change(const Json& before, const Json& after, const Change& change, double slack = 1) {
    const Json a = before.flatten(), b = after.flatten();
    int compared = 0;
    for (const auto& [path, value] : a.items()) {
        const Kind& kind = kind_of(path);
        if (!kind.dimension || kind.trunk_decides) continue;
        if ((change.length != 1 || change.height != 1) && hangs_on_unit(path)) continue;
        INFO(path << ": " << value << " became " << (b.contains(path) ? b[path].dump() : "nothing"));
        REQUIRE(b.contains(path));
        if (!value.is_number() || !b[path].is_number()) {
            CHECK(value == b[path]);
            continue;
        }
        const Dimension d = fitted_dimension(a, path).value_or(*kind.dimension);
        const double expected =
            value.get<double>() * std::pow(change.length, d.length) * std::pow(change.height, d.height) +
            (d.above_datum ? change.raised_m : 0);
        CHECK(b[path].get<double>() == Approx(expected).epsilon(kind.tolerance * slack).margin(1e-9));
        ++compared;
    }
    return compared;
}

constexpr Index rows = 90, cols = 110;
constexpr double cell_m = 37;

/// A steady landscape whose heights are roughened, so that there are pits, and no two ways are as steep.
Raster landscape(std::uint64_t seed) {
    const Grid grid = plane_grid(rows, cols, cell_m, cell_m);
    std::vector<double> height = support::steady_raster(grid, {.theta = 0.45, .scatter = 0.3}, seed);
    Random random(seed, 9);
    for (double& each : height) each = 700 + each + 2 * random.uniform();
    return raster_of({"landscape", grid, height});
}

/// Turned by right angles clockwise and, before that, mirrored east–west.
Raster moved(const Raster& raster, int turns, bool mirrored) {
    std::vector<double> values = raster.values;
    Index r = raster.grid.rows, c = raster.grid.cols;
    if (mirrored) {
        for (Index row = 0; row < r; ++row) std::reverse(values.begin() + row * c, values.begin() + (row + 1) * c);
    }
    for (int turn = 0; turn < turns; ++turn) {
        std::vector<double> turned(values.size());
        for (Index row = 0; row < r; ++row) {
            for (Index col = 0; col < c; ++col) turned[col * r + (r - 1 - row)] = values[row * c + col];
        }
        values = std::move(turned);
        std::swap(r, c);
    }
    const double side = raster.grid.east_west[0];
    return raster_of({"moved", plane_grid(r, c, side, side), values});
}

Raster rescaled(const Raster& raster, const Change& change) {
    const double side = raster.grid.east_west[0] * change.length;
    std::vector<double> values = raster.values;
    for (double& height : values) height = height * change.height + change.raised_m;
    return raster_of({"rescaled", plane_grid(raster.grid.rows, raster.grid.cols, side, side), values});
}

/// Basins of one size stand in the order of their outlets' numbers: here in that of their heights.
void sort_basins(Json& summary) {
    std::sort(summary["basins"].begin(), summary["basins"].end(), [](const Json& a, const Json& b) {
        const double area_a = a["area_m2"], area_b = b["area_m2"];
        if (std::abs(area_a - area_b) > 1e-9 * area_a) return area_a > area_b;
        return a["elevation_mean_m"].get<double>() > b["elevation_mean_m"].get<double>();
    });
}

Json summary(const Raster& raster, double channel_area_m2, Conditioning conditioning = Conditioning::carve,
             terrain::EdgeBasins edge_basins = terrain::EdgeBasins::keep) {
    const test::TempFolder temp;
    std::filesystem::create_directories(temp / "out");
    MeasureOptions options;
    options.conditioning = conditioning;
    options.channel_area_m2 = channel_area_m2;
    options.edge_basins = edge_basins;
    NamedRaster named{};
    named.raster = raster;
    named.file = "made.tif";
    Json result = Json::parse(analyze(named, options, temp / "out", {}));
    sort_basins(result);
    return result;
}

/// What a summary would say of the same terrain with rows and columns exchanged.
Json exchanged(Json summary) {
    Json& ingest = summary["ingest"];
    std::swap(ingest["row_roughness_m"], ingest["column_roughness_m"]);
    std::swap(ingest["row_striping"], ingest["column_striping"]);
    std::swap(ingest["repeated_rows"], ingest["repeated_columns"]);
    std::swap(ingest["cell_width"], ingest["cell_height"]);
    ingest["cell_anisotropy"] = 1 / ingest["cell_anisotropy"].get<double>();
    return summary;
}

/// After a number of turns by a right angle.
Json turned(const Json& summary, int turns) { return turns % 2 == 1 ? exchanged(summary) : summary; }

constexpr double threshold_m2 = 40.5 * cell_m * cell_m;

double at(const Json& json, const char* path) { return json.at(Json::json_pointer(path)).get<double>(); }

/// The embedded DEM on a plane: whole metres, full of ties and flats.
Raster jacksboro() {
    Raster raster = io::read_raster(THALWEG_SOURCE_DIR "/validation/data/jacksboro.tif").raster;
    return raster_of({"jacksboro", plane_grid(raster.grid.rows, raster.grid.cols, 90, 90), raster.values});
}

/// The same with noise of less than its step, by which no two ways are as steep.
Raster jacksboro_without_ties() {
    Raster raster = jacksboro();
    Random random(1, 9);
    for (double& height : raster.values) height += 0.4 * random.uniform();
    return raster;
}

/// How many basins have the asymmetry that theory gives after a change; the others have tributaries with as many cells.
double share_of_asymmetries(const Json& plain, const Json& other, bool mirrored) {
    int compared = 0, as_expected = 0;
    for (std::size_t b = 0; b < plain["basins"].size(); ++b) {
        const Json &before = plain["basins"][b]["asymmetry_percent"], &after = other["basins"][b]["asymmetry_percent"];
        if (!before.is_number() || !after.is_number()) continue;
        const double expected = mirrored ? 100 - before.get<double>() : before.get<double>();
        ++compared;
        as_expected += std::abs(after.get<double>() - expected) < 1e-6;
    }
    return static_cast<double>(as_expected) / compared;
}

}  // namespace

TEST_CASE("Turning and mirroring a DEM without ties leaves every number of the summary", "[invariance]") {
    for (std::uint64_t seed = 1; seed <= 3; ++seed) {
        const Raster dem = landscape(seed);
        const Json plain = summary(dem, threshold_m2);
        REQUIRE(plain["basins"].size() > 20);
        for (int symmetry = 1; symmetry < 8; symmetry += seed == 1 ? 1 : 3) {
            INFO("seed " << seed << ", " << symmetry % 4 << " turns" << (symmetry >= 4 ? ", mirrored" : ""));
            const Json other = summary(moved(dem, symmetry % 4, symmetry >= 4), threshold_m2);
            CHECK(check_change(turned(plain, symmetry), other, {}) > 500);
            CHECK(share_of_asymmetries(plain, other, symmetry >= 4) > 0.9);
        }
    }
    const Raster real = jacksboro_without_ties();
    const Json plain = summary(real, 4e5);
    for (const int symmetry : {3, 5}) {
        const Json other = summary(moved(real, symmetry % 4, symmetry >= 4), 4e5);
        CHECK(check_change(turned(plain, symmetry), other, {}) > 1000);
        CHECK(share_of_asymmetries(plain, other, symmetry >= 4) > 0.9);
    }
}

TEST_CASE("Raising a DEM changes its heights alone", "[invariance]") {
    for (const Conditioning conditioning : {Conditioning::fill, Conditioning::carve, Conditioning::none}) {
        Raster dem = landscape(4);
        for (double& height : dem.values) height = std::round(height * 1024) / 1024;  // so that sums are exact
        const Change change{.raised_m = 4096};
        check_change(summary(dem, threshold_m2, conditioning),
                     summary(rescaled(dem, change), threshold_m2, conditioning), change);
    }
    const Raster real = jacksboro();
    const Change sunk{.raised_m = -2000};
    CHECK(check_change(summary(real, 4e5, Conditioning::fill), summary(rescaled(real, sunk), 4e5, Conditioning::fill),
                       sunk) > 1000);
}

TEST_CASE("Other units of distance and height change every number by its dimension", "[invariance]") {
    // Tenfold, since areas are binned by tenths of their decimal logarithm.
    for (const Change& change : {Change{.length = 10}, Change{.height = 4}, Change{.length = 10, .height = 10}}) {
        const Raster dem = landscape(5);
        const double square = change.length * change.length;
        CHECK(check_change(summary(dem, threshold_m2), summary(rescaled(dem, change), threshold_m2 * square), change) >
              500);
        const Raster real = jacksboro();
        CHECK(check_change(summary(real, 4e5, Conditioning::fill),
                           summary(rescaled(real, change), 4e5 * square, Conditioning::fill), change) > 1000);
    }
}

TEST_CASE("Turning and mirroring a real DEM changes its statistics by no more than ties do", "[invariance]") {
    const Raster dem = jacksboro();
    const Json plain = summary(dem, 4e5, Conditioning::fill, terrain::EdgeBasins::drop);
    for (int symmetry = 1; symmetry < 8; ++symmetry) {
        INFO(symmetry % 4 << " turns" << (symmetry >= 4 ? ", mirrored" : ""));
        const Json other =
            summary(moved(dem, symmetry % 4, symmetry >= 4), 4e5, Conditioning::fill, terrain::EdgeBasins::drop);
        const auto within = [&](const char* path, double share) {
            INFO(path);
            CHECK(at(other, path) == Approx(at(plain, path)).epsilon(share));
        };
        for (const char* same : {"/conditioning/pits", "/conditioning/cells_changed", "/conditioning/volume_m3",
                                 "/conditioning/flat_cells", "/hypsometry/integral", "/hypsometry/skewness"}) {
            within(same, 1e-12);
        }
        within("/basins/0/area_m2", 5e-4);
        within("/channels/basin_area_m2", 5e-3);  // by a cell at the edge a small basin is complete or not
        within("/strahler/0/streams", 0.03);
        within("/channels/total_length_m", 0.01);
        within("/basins/0/length_m", 0.01);
        within("/basins/0/perimeter_m", 0.01);
        within("/horton/RB/mean_ratio", 0.1);
        within("/slope_area/theta", 0.05);
        within("/chi/ksn_median", 0.03);
        within("/hack/exponent", 0.02);
    }
}

namespace {

/// The cell of a moved raster where a cell of the plain one has come to lie.
struct Move {
    Index rows, cols;  ///< of the plain raster
    int turns;
    bool mirrored;

    std::pair<int, int> operator()(int row, int col) const {
        int r = static_cast<int>(rows), c = static_cast<int>(cols);
        if (mirrored) col = c - 1 - col;
        for (int turn = 0; turn < turns; ++turn) {
            std::tie(row, col) = std::pair(col, r - 1 - row);
            std::swap(r, c);
        }
        return {row, col};
    }
};

/// Receivers on the filled surface that are as steep as any, and how many: none on a flat.
int steepest_ways(const RasterMeasurement& m, const Grid& grid, Index cell) {
    double steepest = 0;
    int ways = 0;
    grid.neighbors(cell, [&](Index other, double length, Slot) {
        const double slope = (m.terrain.elevation_m[cell] - m.terrain.elevation_m[other]) / length;
        if (slope > steepest * (1 + 1e-12)) ways = 0;
        if (slope > steepest) steepest = slope;
        ways += slope > 0 && slope >= steepest * (1 - 1e-12);
    });
    return ways;
}

}  // namespace

TEST_CASE("A real DEM turned or mirrored flows the same way in every cell that has one steepest way", "[invariance]") {
    const Raster dem = jacksboro();
    const RasterMeasurement plain = measure_raster(dem, {.channel_area_m2 = 4e5});
    for (int symmetry = 1; symmetry < 8; ++symmetry) {
        INFO(symmetry % 4 << " turns" << (symmetry >= 4 ? ", mirrored" : ""));
        const Raster other = moved(dem, symmetry % 4, symmetry >= 4);
        const RasterMeasurement m = measure_raster(other, {.channel_area_m2 = 4e5});
        const Move move{dem.grid.rows, dem.grid.cols, symmetry % 4, symmetry >= 4};
        const auto moved_cell = [&](Index cell) {
            const auto [row, col] = move(static_cast<int>(dem.grid.row(cell)), static_cast<int>(dem.grid.col(cell)));
            return static_cast<Index>(row) * other.grid.cols + static_cast<Index>(col);
        };
        Index without_reason = 0, by_ties = 0, in_flats = 0;
        for (Index cell = 0; cell < dem.grid.size(); ++cell) {
            const Index before = plain.terrain.graph.receiver[cell], after = m.terrain.graph.receiver[moved_cell(cell)];
            const bool stays = before == none || after == none;
            const bool same = stays ? before == after : moved_cell(before) == after;
            if (same) continue;
            const int ways = steepest_ways(plain, dem.grid, cell);
            by_ties += ways > 1;
            in_flats += ways == 0;
            without_reason += ways == 1;
        }
        CHECK(without_reason == 0);
        CHECK(by_ties > 500);
        CHECK(by_ties < 0.05 * dem.grid.size());
        CHECK(in_flats < 0.005 * dem.grid.size());
    }
}
