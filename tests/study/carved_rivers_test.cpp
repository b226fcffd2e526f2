// SPDX-License-Identifier: GPL-3.0-or-later
// Slopes and long profiles are measured along rivers that are carved, never filled, of which only the channels are kept
// in memory. Here everything is found again on the whole raster, by walking down from every cell.
#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <map>
#include <tuple>

#include "support/drawn_catchment.hpp"
#include "support/terrain_oracles.hpp"
#include "support/terrains.hpp"
#include "thalweg/study/measure.hpp"
#include "thalweg/terrain/flats.hpp"
#include "thalweg/terrain/lakes.hpp"
#include "thalweg/terrain/route.hpp"

using namespace thalweg;
using namespace thalweg::study;

namespace {

/// A terrain that drains along its lakes' passes, and what lies upstream of each cell.
struct Carved {
    const Grid& grid;
    std::vector<Boundary> boundary;
    FlowDirections directions;
    std::vector<double> area_m2, carved_m;
    std::vector<std::uint8_t> complete;

    explicit Carved(const Raster& raster) : grid(raster.grid), boundary(terrain::data_edge(grid, raster.values)) {
        directions = terrain::route(grid, raster.values, boundary);
        terrain::resolve_flats(grid, raster.values, boundary, directions);
        terrain::drain_lakes(grid, raster.values, boundary, directions);
        area_m2.assign(grid.size(), 0);
        carved_m = raster.values;
        complete.assign(grid.size(), 1);
        for (Index start = 0; start < grid.size(); ++start) {
            if (std::isnan(raster.values[start])) continue;
            const bool cut = is_cut(start);
            for (Index node = start; node != none; node = receiver(node)) {
                area_m2[node] += grid.area(start);
                carved_m[node] = std::min(carved_m[node], raster.values[start]);
                if (cut) complete[node] = 0;
            }
        }
    }

    Index receiver(Index node) const {
        return directions[node] == no_flow ? none : grid.neighbor(node, directions[node]);
    }

    /// On the edge of the data, and more than two rows or columns from where its water leaves.
    bool is_cut(Index node) const {
        const Index end = support::end_of_flow(grid, directions, node);
        const auto apart = [](Index a, Index b) { return a > b ? a - b : b - a; };
        const bool beside_outlet =
            apart(grid.row(node), grid.row(end)) <= 2 && apart(grid.col(node), grid.col(end)) <= 2;
        return boundary[node] != Boundary::interior && !beside_outlet;
    }

    std::vector<std::uint8_t> below(const std::vector<Index>& heads) const {
        std::vector<std::uint8_t> channel(grid.size(), 0);
        for (const Index head : heads) {
            for (Index node = head; node != none; node = receiver(node)) channel[node] = 1;
        }
        return channel;
    }

    std::vector<std::uint8_t> from_area(double threshold_m2) const {
        std::vector<std::uint8_t> channel(grid.size(), 0);
        for (Index node = 0; node < grid.size(); ++node) channel[node] = area_m2[node] >= threshold_m2;
        return channel;
    }
};

/// Cell of the receiver among the channels, length to it, area, height, chi.
using Row = std::tuple<Index, double, double, double, double>;

/// Long profiles by walking down from each channel cell; chi for θ = 0.45 and 1 km².
std::map<Index, Row> profiles(const Carved& carved, const std::vector<std::uint8_t>& channel) {
    std::map<Index, Row> rows;
    for (Index node = 0; node < carved.grid.size(); ++node) {
        if (!channel[node]) continue;
        const auto step = [&](Index from) {
            const Index to = carved.receiver(from);
            return to != none && channel[to] ? to : none;
        };
        double chi = 0;
        for (Index at = node; step(at) != none; at = step(at)) {
            chi += carved.grid.length(at, carved.directions[at]) * std::pow(1e6 / carved.area_m2[at], 0.45);
        }
        const Index to = step(node);
        const double length = to == none ? 0 : carved.grid.length(node, carved.directions[node]);
        rows[node] = {to, length, carved.area_m2[node], carved.carved_m[node], chi};
    }
    return rows;
}

void check_profiles(const ChiStatistics& chi, const std::map<Index, Row>& expected) {
    REQUIRE(chi.profile.size() == expected.size());
    for (Index i = 0; i < chi.profile.size(); ++i) {
        REQUIRE(expected.contains(chi.profile.node[i]));
        const auto& [below, length, area, height, chi_m] = expected.at(chi.profile.node[i]);
        const Index found = chi.profile.below[i] == none ? none : chi.profile.node[chi.profile.below[i]];
        CHECK(found == below);
        CHECK(chi.profile.length_m[i] == length);
        CHECK(chi.profile.area_m2[i] == Approx(area).epsilon(1e-12));
        CHECK(chi.profile.elevation_m[i] == height);
        CHECK(chi.chi_m[i] == Approx(chi_m).epsilon(1e-12));
    }
}

/// Segments add up to the reaches that they are cut from: none is longer than the rivers, all lie on them, and the
/// slope of each is that of carved heights, whose falls a filled lake would not have.
void check_segments(const RasterMeasurement& m, const Carved& carved, const std::vector<std::uint8_t>& channel) {
    const terrain::FlowGraph graph = terrain::flow_graph(carved.grid, carved.carved_m, carved.directions);
    auto expected =
        channel::fixed_drop_segments(graph, carved.area_m2, carved.carved_m, channel,
                                     {.drop_m = m.segment_drop_m, .smallest_drop_m = 3 * m.vertical_quantum_m});
    auto found = m.statistics.slope_area_points;
    REQUIRE(found.size() == expected.size());
    const auto by_node = [](const auto& a, const auto& b) {
        return std::tuple(a.node, a.area_m2, a.slope) < std::tuple(b.node, b.area_m2, b.slope);
    };
    std::ranges::sort(expected, by_node);
    std::ranges::sort(found, by_node);
    for (std::size_t i = 0; i < found.size(); ++i) {
        CHECK(found[i].node == expected[i].node);
        CHECK(found[i].area_m2 == Approx(expected[i].area_m2).epsilon(1e-12));
        CHECK(found[i].slope == Approx(expected[i].slope).epsilon(1e-12));
        CHECK(found[i].weight == Approx(expected[i].weight).epsilon(1e-12));
    }
}

/// Valleys with pits, flats, and holes in every other.
Raster rough_valleys(std::uint64_t seed) {
    auto terrain = support::noise_terrain(40, 50, seed);
    const bool in_steps = seed % 2 == 0;
    for (Index node = 0; node < terrain.grid.size(); ++node) {
        const double valley = 0.3 * std::abs(std::sin(0.25 * terrain.grid.col(node)));
        double& z = terrain.elevation_m[node];
        z += 0.2 * terrain.grid.row(node) + 5 * valley;
        if (in_steps) z = std::round(2 * z) / 2;
    }
    return support::raster_of(seed % 3 == 0 ? support::with_holes(terrain, 0.003, seed) : terrain);
}

}  // namespace

TEST_CASE("Rivers for slopes and profiles are those of the whole carved raster, by area", "[carved]") {
    std::size_t rows = 0, incomplete = 0;
    for (std::uint64_t seed = 1; seed <= 12; ++seed) {
        const Raster raster = rough_valleys(seed);
        const Carved carved(raster);
        for (const auto edge : {terrain::EdgeBasins::keep, terrain::EdgeBasins::drop}) {
            INFO("seed " << seed << (edge == terrain::EdgeBasins::keep ? ", all" : ", complete only"));
            MeasureOptions options;
            options.channel_area_m2 = 12;
            options.edge_basins = edge;
            const RasterMeasurement m = measure_raster(raster, options);
            auto channel = carved.from_area(12);
            for (Index node = 0; edge == terrain::EdgeBasins::drop && node < raster.grid.size(); ++node) {
                incomplete += channel[node] && !carved.complete[node];
                channel[node] &= carved.complete[node];
            }
            const auto expected = profiles(carved, channel);
            check_profiles(m.statistics.chi, expected);
            check_segments(m, carved, channel);
            rows += expected.size();
            CHECK(m.conditioning.pits > 10);
        }
    }
    CHECK(rows > 2000);
    CHECK(incomplete > 100);
}

TEST_CASE("Heads given, or found by slope and area, begin the same rivers on the carved raster", "[carved]") {
    for (std::uint64_t seed = 1; seed <= 6; ++seed) {
        INFO("seed " << seed);
        const Raster raster = rough_valleys(seed);
        const Carved carved(raster);
        MeasureOptions options;
        options.edge_basins = terrain::EdgeBasins::keep;
        options.channels = ChannelRule::slope_area;
        options.slope_area_m2 = 2;
        const RasterMeasurement by_product = measure_raster(raster, options);
        std::vector<std::uint8_t> channel(raster.grid.size());
        for (Index node = 0; node < raster.grid.size(); ++node)
            channel[node] = by_product.statistics.strahler_of[node] > 0;
        const std::vector<Index> heads = channel::channel_heads(by_product.terrain.graph, channel);
        REQUIRE(heads.size() > 3);
        check_profiles(by_product.statistics.chi, profiles(carved, carved.below(heads)));

        options.channels = ChannelRule::heads;
        options.heads = ChannelHeads{.cells = heads};
        const RasterMeasurement by_heads = measure_raster(raster, options);
        check_profiles(by_heads.statistics.chi, profiles(carved, carved.below(heads)));
        check_segments(by_heads, carved, carved.below(heads));

        // Of complete catchments alone: some heads then lie beside all rivers that are kept.
        options.edge_basins = terrain::EdgeBasins::drop;
        const RasterMeasurement complete = measure_raster(raster, options);
        auto kept = carved.below(heads);
        for (Index node = 0; node < raster.grid.size(); ++node) kept[node] &= carved.complete[node];
        check_profiles(complete.statistics.chi, profiles(carved, kept));
    }
}
