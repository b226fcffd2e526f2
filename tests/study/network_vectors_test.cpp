// SPDX-License-Identifier: GPL-3.0-or-later
// Rivers as lines: they meet in nodes only, end in corners too, and are as long as the ground under them.
#include <catch2/catch.hpp>

#include <cmath>

#include "support/drawn_catchment.hpp"
#include "support/terrains.hpp"
#include "thalweg/io/geodesy.hpp"
#include "thalweg/study/tables.hpp"

using namespace thalweg;
using namespace thalweg::study;
using support::raster_of;

namespace {

/// Pairs of diagonal steps that cross in the middle between four cells; steps to neighbours can cross nowhere else.
int crossings(const Grid& grid, const terrain::FlowGraph& graph) {
    const auto joined = [&](Index a, Index b) { return graph.receiver[a] == b || graph.receiver[b] == a; };
    int count = 0;
    for (Index row = 0; row + 1 < grid.rows; ++row) {
        for (Index col = 0; col + 1 < grid.cols; ++col) {
            const Index corner = row * grid.cols + col;
            count += joined(corner, corner + grid.cols + 1) && joined(corner + 1, corner + grid.cols);
        }
    }
    return count;
}

MeasureOptions everything(Conditioning conditioning) {
    MeasureOptions options;
    options.conditioning = conditioning;
    options.channel_area_m2 = 1;
    options.edge_basins = terrain::EdgeBasins::keep;
    return options;
}

}  // namespace

TEST_CASE("No river crosses another, on noise, on steps full of flats, and around holes", "[network vectors]") {
    const terrain::FlowGraph crossed{.receiver = std::vector<Index>{3, 2, none, none},
                                     .length = std::vector<double>{1, 1, 0, 0},
                                     .order = {2, 3, 0, 1}};
    REQUIRE(crossings(plane_grid(2, 2, 1, 1), crossed) == 1);
    for (std::uint64_t seed = 0; seed < 30; ++seed) {
        for (const auto& terrain : {support::noise_terrain(30, 40, seed), support::stepped_terrain(30, 40, 3, seed),
                                    support::stepped_terrain(30, 40, 40, seed),
                                    support::with_holes(support::noise_terrain(30, 40, seed), 0.03, seed)}) {
            for (const Conditioning conditioning :
                 {Conditioning::fill, Conditioning::breach, Conditioning::carve, Conditioning::none}) {
                const RasterMeasurement m = measure_raster(raster_of(terrain), everything(conditioning));
                INFO(terrain.name << ", conditioning " << static_cast<int>(conditioning));
                CHECK(crossings(terrain.grid, m.terrain.graph) == 0);
            }
        }
    }
}

TEST_CASE("A river may leave by a corner of the raster, and meet two others in one cell", "[network vectors]") {
    // Rows 1 and 2 lead to (2, 1), where three streams meet; from there the diagonal goes to the corner (3, 0).
    const Raster raster = raster_of(support::terrain_of(
        "corner", 4, 4,
        [](Index r, Index c) {
            const double heights[4][4] = {{30, 30, 30, 30}, {20, 21, 19, 30}, {22, 10, 18, 30}, {1, 23, 24, 30}};
            return heights[r][c];
        },
        10, 10));
    MeasureOptions options = everything(Conditioning::fill);
    options.channels = ChannelRule::heads;
    options.heads = ChannelHeads{.cells = {4, 6, 10}};
    const Statistics s = measure_raster(raster, options).statistics;
    REQUIRE(s.network.size() == 4);
    const auto last = s.network.nodes_of(0);
    CHECK(last.front() == 9);
    CHECK(last.back() == 12);
    CHECK(s.network.length_m[0] == Approx(std::sqrt(200.0)));
    CHECK(s.network.strahler[0] == 2);
    CHECK(s.network.shreve[0] == 3);
    const Table links = links_table(s, positions(raster));
    REQUIRE(links.geometry.size() == 4);
    CHECK(links.geometry[0].back() == raster.placement.center(3, 0));
}

TEST_CASE("Links in degrees are as long as the geodesics between their cells", "[network vectors]") {
    // On the ellipsoid: 0.01° of the meridian at 45° N are 1111.3 m, of the parallel 788.5 m.
    Raster raster = raster_of(support::terrain_of(
        "slope", 12, 12, [](Index r, Index c) { return c == 6 ? 50.0 - r : 100.0 + std::abs(c - 6.0) - r; }));
    raster.placement = {10, 45.06, 0.01, 0.01, raster.placement.crs_wkt, true};
    raster.grid = io::geographic_grid(12, 12, 45.06, 0.01, 0.01);
    MeasureOptions options = everything(Conditioning::fill);
    options.channels = ChannelRule::heads;
    options.heads = ChannelHeads{.cells = {6}};
    const Statistics s = measure_raster(raster, options).statistics;
    REQUIRE(s.network.size() == 1);
    CHECK(s.network.length_m[0] == Approx(11 * 1111.3).epsilon(1e-4));
}
