// SPDX-License-Identifier: GPL-3.0-or-later
#include "thalweg/study/domain.hpp"

#include <catch2/catch.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <nlohmann/json.hpp>
#include <numeric>

#include "support/drawn_catchment.hpp"
#include "support/temp_folder.hpp"
#include "thalweg/study/simulate.hpp"

using namespace thalweg;
using namespace thalweg::study;
using test::TempFolder;
using Json = nlohmann::json;

namespace {

MeasureOptions channels_from(double area_m2) {
    MeasureOptions options;
    options.channel_area_m2 = area_m2;
    return options;
}

/// The drawn terrain with rows and columns of no data around it, on cells that change from row to row.
Raster padded(Index above, Index left, Index below, Index right) {
    const Raster inner = support::drawn_catchment();
    const Index rows = 8 + above + below, cols = 8 + left + right;
    Raster raster{support::uneven_grid(rows, cols), inner.placement, {}};
    raster.placement.cell_width = 30;
    raster.placement.cell_height = 20;
    raster.values.assign(raster.grid.size(), support::nodata);
    for (Index node = 0; node < 64; ++node) {
        raster.values[(node / 8 + above) * cols + node % 8 + left] = inner.values[node];
    }
    return raster;
}

Experiment on_dem(MeshKind mesh) {
    Experiment e;
    e.domain.mesh = mesh;
    if (mesh == MeshKind::tin) e.domain.nodes = 300;
    e.uplift.rate_m_per_yr = 1e-3;
    e.river.k = 1e-5;
    e.river.m = 0.5;
    e.time.solver = Solver::steady;
    return e;
}

constexpr double us_foot_m = 1200.0 / 3937;

/// The drawn terrain with cells of 100 US survey feet on the map of North Carolina.
Raster drawn_in_feet(const TempFolder& temp) {
    Raster drawn = support::drawn_catchment();
    drawn.placement.west = 2e6;
    drawn.placement.north = 6e5;
    drawn.placement.cell_width = drawn.placement.cell_height = 100;
    io::write_raster(temp / "feet.tif", drawn.grid, drawn.placement, drawn.values, {});
    Raster raster = io::read_raster(temp / "feet.tif", {.crs = "EPSG:2264"}).raster;
    raster.values = drawn.values;  // in metres, whatever unit the coordinate system has for heights
    return raster;
}

Index base_levels(const Domain& domain) {
    return static_cast<Index>(
        std::count(domain.setting.boundary.begin(), domain.setting.boundary.end(), Boundary::base_level));
}

}  // namespace

TEST_CASE("A catchment is cut out with a margin of one cell, and keeps its measures and its place") {
    for (const auto& [above, left, below, right] :
         {std::array<Index, 4>{0, 0, 0, 0}, {2, 0, 1, 3}, {3, 2, 0, 0}, {1, 1, 2, 1}}) {
        const Raster dem = padded(above, left, below, right);
        const Catchment c = largest_complete_catchment(dem, channels_from(1200));
        const Index margin_below = below > 0 ? 1 : 0;
        REQUIRE(c.raster.grid.rows == 8 + margin_below);  // seven rows, and the rim above
        REQUIRE(c.raster.grid.cols == 7);
        CHECK(c.outlet == 7 * 7 + 3);
        CHECK(c.raster.placement.west == dem.placement.west + 30 * (left + 1));
        CHECK(c.raster.placement.north == dem.placement.north - 20 * above);
        CHECK(c.raster.placement.cell_width == 30);
        for (Index row = 0; row < c.raster.grid.rows; ++row) {
            CHECK(c.raster.grid.cell_area[row] == dem.grid.cell_area[row + above]);
            CHECK(c.raster.grid.east_west[row] == dem.grid.east_west[row + above]);
            if (row + 1 == c.raster.grid.rows) continue;
            CHECK(c.raster.grid.north_south[row] == dem.grid.north_south[row + above]);
            CHECK(c.raster.grid.diagonal[row] == dem.grid.diagonal[row + above]);
        }
        for (Index row = 0; row < 8 + margin_below; ++row) {
            for (Index col = 0; col < 7; ++col) {
                const bool inside = row >= 1 && row <= 7 && col >= 1 && col <= 5;
                const double value = c.raster.values[row * 7 + col];
                if (!inside) CHECK(std::isnan(value));
                if (inside) CHECK(value == dem.values[(row + above) * dem.grid.cols + col + 1 + left]);
            }
        }
    }
}

TEST_CASE("A DEM without a complete catchment as large as its channels is refused") {
    CHECK(test::is_sentence(
        test::error_of([] { largest_complete_catchment(support::drawn_catchment(), channels_from(3600)); })));
}

TEST_CASE("On a raster the DEM's outlet keeps its height, and the start is the DEM or noise above the outlet") {
    const Catchment c = largest_complete_catchment(support::drawn_catchment(), channels_from(200));
    Experiment e = on_dem(MeshKind::raster);
    e.initial.amplitude_m = 0.25;
    for (const InitialSurface initial : {InitialSurface::noise, InitialSurface::dem}) {
        e.domain.initial = initial;
        const Domain domain = make_domain(e, c);
        CHECK(domain.area_m2 == 3500);
        CHECK(base_levels(domain) == 1);
        CHECK(domain.setting.boundary[c.outlet] == Boundary::base_level);
        CHECK(domain.start.elevation_m[c.outlet] == -0.5);
        for (Index node = 0; node < c.raster.grid.size(); ++node) {
            const double start = domain.start.elevation_m[node], dem = c.raster.values[node];
            CHECK(std::isnan(start) == std::isnan(dem));
            if (std::isnan(dem)) continue;
            if (initial == InitialSurface::dem) CHECK(start == dem);
            if (initial == InitialSurface::noise) CHECK(std::abs(start + 0.5) <= 0.25);
        }
    }
    e.outlets = Outlets{OutletRule::all};
    CHECK(base_levels(make_domain(e, c)) == 20);  // the rim of 7 x 5 cells
}

TEST_CASE("On a TIN one node of the outline, the nearest to the outlet, is base level, and the DEM may be the start") {
    const Catchment c = largest_complete_catchment(support::drawn_catchment(), channels_from(200));
    Experiment e = on_dem(MeshKind::tin);
    e.domain.initial = InitialSurface::dem;
    const Domain domain = make_domain(e, c);
    const Mesh& mesh = std::get<Mesh>(domain.topology);
    const Point outlet = c.raster.placement.center(7, 3);
    REQUIRE(base_levels(domain) == 1);
    const auto distance = [&](Index node) { return std::hypot(mesh.x[node] - outlet.x, mesh.y[node] - outlet.y); };
    Index base = 0;
    while (domain.setting.boundary[base] != Boundary::base_level) ++base;
    CHECK(domain.start.elevation_m[base] == -0.5);
    CHECK(mesh.on_outline[base] == 1);
    for (Index node = 0; node < mesh.size(); ++node) {
        if (mesh.on_outline[node]) CHECK(distance(node) >= distance(base));
        // Inside a cell of the valley the start is that cell; on its outline a cell beside it may hold the node.
        const double col = (mesh.x[node] - c.raster.placement.west) / 10, row = (4e6 - mesh.y[node]) / 10;
        if (mesh.on_outline[node] || node == base) continue;
        const auto cell = static_cast<std::size_t>(row) * 7 + static_cast<std::size_t>(col);
        CHECK(domain.start.elevation_m[node] == c.raster.values[cell]);
    }
    e.outlets = Outlets{OutletRule::all};
    const Domain open = make_domain(e, c);
    CHECK(base_levels(open) == static_cast<Index>(std::count(mesh.on_outline.begin(), mesh.on_outline.end(), 1)));
}

TEST_CASE("A map in feet gives a TIN of the right area in metres, and its results lie on the map") {
    const TempFolder temp;
    const Raster dem = drawn_in_feet(temp);
    CHECK(dem.grid.east_west[0] == Approx(100 * us_foot_m).epsilon(1e-12));
    const Catchment c = largest_complete_catchment(dem, channels_from(200));
    const double area_m2 = 35 * std::pow(100 * us_foot_m, 2);
    const Domain domain = make_domain(on_dem(MeshKind::tin), c);
    const Mesh& mesh = std::get<Mesh>(domain.topology);
    CHECK(domain.area_m2 == Approx(area_m2).epsilon(1e-9));
    CHECK(std::accumulate(mesh.cell_area.begin(), mesh.cell_area.end(), 0.0) == Approx(area_m2).epsilon(1e-9));
    CHECK(domain.extent_m == Approx(700 * us_foot_m).epsilon(1e-6));

    std::filesystem::create_directory(temp / "out");
    const Json s = Json::parse(simulate(on_dem(MeshKind::tin), c, temp / "out", {}));
    CHECK(s["domain_area_m2"].get<double>() == Approx(area_m2).epsilon(1e-9));
    // The valley reaches from 2 000 200 to 2 000 700 ft east and from 599 200 to 599 900 ft north.
    const io::ReadResult written = io::read_raster(temp / "out/elevation.tif");
    const Placement& place = written.raster.placement;
    CHECK(place.west == Approx(2000200).margin(1));
    CHECK(place.north == Approx(599900).margin(1));
    CHECK(place.cell_height * written.raster.grid.rows == Approx(700).margin(3));
    CHECK(place.cell_width * written.raster.grid.cols == Approx(500).margin(3));
    CHECK(data_area(written.raster) == Approx(area_m2).epsilon(0.02));
    const Json& basin = s["terrain"]["basins"][0];
    CHECK(basin["outlet_x"].get<double>() == Approx(2000450).margin(60));
    CHECK(basin["outlet_y"].get<double>() == Approx(599200).margin(60));
    CHECK(basin["area_m2"].get<double>() == Approx(area_m2).epsilon(1e-9));
}

TEST_CASE("In feet, too, a TIN may start from the DEM") {
    const TempFolder temp;
    const Catchment c = largest_complete_catchment(drawn_in_feet(temp), channels_from(200));
    Experiment e = on_dem(MeshKind::tin);
    e.domain.initial = InitialSurface::dem;
    const Domain domain = make_domain(e, c);
    const auto highest = std::max_element(domain.start.elevation_m.begin(), domain.start.elevation_m.end());
    CHECK(*highest == 25);
}

TEST_CASE("A drawn domain across ±180° is as large as one elsewhere") {
    const TempFolder folder;
    const auto area_of = [&](const std::string& ring) {
        Experiment e;
        e.domain.outline = folder.text("outline.geojson", R"({"type": "Polygon", "coordinates": [)" + ring + "]}");
        e.domain.nodes = 500;
        return make_domain(e, Messages{}).area_m2;
    };
    const double elsewhere = area_of("[[9.95, -17], [10.05, -17], [10.05, -16.9], [9.95, -16.9], [9.95, -17]]");
    CHECK(elsewhere == Approx(1.1788e8).epsilon(1e-3));
    CHECK(area_of("[[179.95, -17], [-179.95, -17], [-179.95, -16.9], [179.95, -16.9], [179.95, -17]]") ==
          Approx(elsewhere).epsilon(1e-9));
    CHECK(area_of("[[179.95, -17], [180.05, -17], [180.05, -16.9], [179.95, -16.9], [179.95, -17]]") ==
          Approx(elsewhere).epsilon(1e-9));
    // A hole across the line, written as its ring is or a turn away.
    const std::string ring = "[[179.95, -17], [-179.95, -17], [-179.95, -16.9], [179.95, -16.9], [179.95, -17]], ";
    const double holed = area_of(ring + "[[179.98, -16.97], [179.98, -16.93], [-179.98, -16.93], [179.98, -16.97]]");
    CHECK(holed == Approx(0.92 * elsewhere).epsilon(1e-3));
    CHECK(area_of(ring + "[[-180.02, -16.97], [-180.02, -16.93], [-179.98, -16.93], [-180.02, -16.97]]") ==
          Approx(holed).epsilon(1e-9));
}
