// SPDX-License-Identifier: GPL-3.0-or-later
#include "thalweg/channel/slope_area.hpp"

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <limits>
#include <numeric>

#include "support/flow_trees.hpp"
#include "support/steady_landscape.hpp"
#include "thalweg/core/parallel.hpp"

using namespace thalweg;
using namespace thalweg::channel;
using support::graph_of;
using terrain::FlowGraph;

namespace {

/// A single river: node i flows to i − 1, with the given falls (m) and areas (m²) of its steps, 10 m long each.
struct River {
    FlowGraph graph;
    std::vector<double> area{1e9}, height{0};
    River(const std::vector<double>& falls, const std::vector<double>& areas) {
        std::vector<Index> receiver{none};
        for (std::size_t i = 0; i < falls.size(); ++i) {
            receiver.push_back(static_cast<Index>(i));
            height.push_back(height.back() + falls[i]);
            area.push_back(areas[i]);
        }
        graph = graph_of(receiver, 10);
    }
    std::vector<SlopeAreaPoint> segments(const SegmentOptions& options) const {
        return fixed_drop_segments(graph, area, height, {}, options);
    }
};

/// k·A0^m relative to the truth and m less the truth (n = 1), from a DEM of a steady landscape.
struct Bias {
    double m, k_at_reference;
};

Bias dem_bias(const Grid& grid, const std::vector<double>& height, const support::SteadyLaw& law) {
    const support::RoutedDem dem = support::routed_dem(grid, height);
    const double quantum = vertical_quantum(height);
    const double relief = *std::ranges::max_element(height) - *std::ranges::min_element(height);
    const auto points = fixed_drop_segments(
        dem.graph, dem.area_m2, dem.carved_m, {},
        {.drop_m = std::max(0.025 * relief, 3 * quantum), .smallest_drop_m = 3 * quantum, .smallest_area_m2 = 2e5});
    const SlopeArea fit = fit_slope_area(slope_area_bins(points));
    const double slope = fit.ks.value * std::pow(law.reference_area_m2, -fit.theta.value);
    return {fit.theta.value - law.theta, law.slope_at_reference / slope - 1};
}

std::vector<double> rounded(std::vector<double> height, double quantum) {
    for (double& each : height) each = quantum * std::round(each / quantum);
    return height;
}

}  // namespace

TEST_CASE("An even river is cut into pieces of the asked drop, with their slope and area") {
    const River river(std::vector<double>(12, 1.0), std::vector<double>(12, 5e5));
    const auto points = river.segments({.drop_m = 3});
    REQUIRE(points.size() == 4);
    for (const SlopeAreaPoint& point : points) {
        CHECK(point.slope == Approx(0.1));
        CHECK(point.area_m2 == Approx(5e5));
        CHECK(point.weight == 30);
    }
}

TEST_CASE("What is left over goes to the last piece, and a reach too low for one piece is kept whole") {
    const std::vector<double> same(11, 5e5);
    const auto eleven = River(std::vector<double>(11, 1.0), same).segments({.drop_m = 3});
    REQUIRE(eleven.size() == 3);
    CHECK(eleven[0].weight == 30);
    CHECK(eleven[1].weight == 30);
    CHECK(eleven[2].weight == 50);
    const auto whole = River({0.2, 0.3, 0.1}, {5e5, 5e5, 5e5}).segments({.drop_m = 3});
    REQUIRE(whole.size() == 1);
    CHECK(whole[0].slope == Approx(0.02));
    CHECK(River({0.2, 0.3, 0.1}, {5e5, 5e5, 5e5}).segments({.drop_m = 3, .smallest_drop_m = 1}).empty());
    CHECK(River({0, 0, 0}, {5e5, 5e5, 5e5}).segments({.drop_m = 3}).empty());
}

TEST_CASE("No segment crosses a jump of the area, and a gentle change is averaged geometrically") {
    const auto points = River({1, 1, 1, 1, 1, 1}, {9e5, 9e5, 6e5, 2e5, 2e5, 2e5}).segments({.drop_m = 100});
    REQUIRE(points.size() == 2);  // 9/6 = 1.5 is no jump, 6/2 = 3 is one
    CHECK(points[0].area_m2 == Approx(std::cbrt(9e5 * 9e5 * 6e5)));
    CHECK(points[0].weight == 30);
    CHECK(points[1].area_m2 == Approx(2e5));
    const auto at_limit = River({1, 1}, {1.6e5, 1e5}).segments({.drop_m = 100});
    CHECK(at_limit.size() == 1);
    CHECK(River({1, 1}, {1.61e5, 1e5}).segments({.drop_m = 100}).size() == 2);
}

TEST_CASE("Channels begin at the smallest area, and only nodes in use enter") {
    const River river({1, 1, 1, 1}, {4e5, 4e5, 3e5, 2e5});
    const auto large = river.segments({.drop_m = 100, .smallest_area_m2 = 2.5e5});
    REQUIRE(large.size() == 1);
    CHECK(large[0].weight == 30);
    const std::vector<std::uint8_t> used{1, 0, 1, 1, 0};
    const auto middle = fixed_drop_segments(river.graph, river.area, river.height, used, {.drop_m = 100});
    REQUIRE(middle.size() == 1);
    CHECK(middle[0].weight == 20);
    CHECK(middle[0].area_m2 == Approx(std::sqrt(4e5 * 3e5)));
}

TEST_CASE("At a junction the river goes on along the larger donor and the tributary is a river of its own") {
    // 0 ← 1 ← {2, 3}, 2 ← 4; the donor 3 has more area than 2.
    const FlowGraph graph = graph_of({none, 0, 1, 1, 2}, 10);
    const std::vector<double> area{10e5, 9e5, 3e5, 6e5, 3e5};
    const std::vector<double> height{0, 1, 3, 4, 6};
    const auto points = fixed_drop_segments(graph, area, height, {}, {.drop_m = 100});
    REQUIRE(points.size() == 2);
    CHECK(points[0].area_m2 == Approx(std::sqrt(9e5 * 6e5)));
    CHECK(points[0].slope == Approx(4 / 20.0));
    CHECK(points[1].area_m2 == Approx(3e5));
    CHECK(points[1].slope == Approx(5 / 20.0));
}

TEST_CASE("Lengths and drops of the segments add up to those of all channels: nothing steep is preferred") {
    const Grid grid = plane_grid(60, 60, 90, 90);
    std::vector<double> height = support::steady_raster(grid, {.slope_at_reference = 0.02}, 3);
    for (Index node = 0; node < grid.size(); ++node) height[node] += 2 * uniform_at(8, 0, node);
    const support::RoutedDem dem = support::routed_dem(grid, height);
    double length = 0, drop = 0;
    for (Index node = 0; node < grid.size(); ++node) {
        const Index receiver = dem.graph.receiver[node];
        if (receiver == none || dem.area_m2[node] < 1e5) continue;
        length += dem.graph.length[node];
        drop += dem.carved_m[node] - dem.carved_m[receiver];
    }
    for (const double piece : {0.5, 3.0, 20.0}) {
        double measured_length = 0, measured_drop = 0;
        for (const SlopeAreaPoint& point : fixed_drop_segments(dem.graph, dem.area_m2, dem.carved_m, {},
                                                               {.drop_m = piece, .smallest_area_m2 = 1e5})) {
            measured_length += point.weight;
            measured_drop += point.weight * point.slope;
        }
        CHECK(measured_drop == Approx(drop).epsilon(1e-9));
        CHECK(measured_length <= length * (1 + 1e-12));
        CHECK(measured_length > 0.95 * length);  // only reaches without any fall are missing
    }
}

TEST_CASE("A river of steep and gentle steps has its mean slope, however it is cut") {
    std::vector<double> falls;
    for (Index i = 0; i < 20000; ++i) falls.push_back(uniform_at(4, 0, i) < 0.2 ? 4.0 : 0.25);  // mean 1 m per 10 m
    const River river(falls, std::vector<double>(falls.size(), 5e5));
    for (const double drop : {10.0, 30.0}) {
        const auto bins = slope_area_bins(river.segments({.drop_m = drop}));
        REQUIRE(bins.size() == 1);
        // The mean of ln lies below ln of the mean by half the variance of a piece: cv² = 2.25/4 per metre of drop.
        const double half_variance = 0.5 * 2.25 / drop;
        CHECK(std::log(bins[0].slope / 0.1) == Approx(-half_variance).margin(0.05));
    }
}

TEST_CASE("Nodes' own slopes leave out what has none") {
    const FlowGraph graph = graph_of({none, 0, 1, 2, 3}, 10);
    const std::vector<double> area{5, 4, 3, 2, 1};
    const auto points = node_slopes(graph, area, std::vector<double>{0, 1, 3, 3, 2});
    REQUIRE(points.size() == 2);
    CHECK(points[0].area_m2 == 4);
    CHECK(points[0].slope == Approx(0.1));
    CHECK(points[1].slope == Approx(0.2));
    CHECK(points[1].weight == 1);
    const auto one =
        node_slopes(graph, area, std::vector<double>{0, 1, 3, 3, 2}, std::vector<std::uint8_t>{1, 0, 1, 1, 1});
    CHECK(one.size() == 1);
    const double nan = std::numeric_limits<double>::quiet_NaN();
    CHECK(node_slopes(graph, area, std::vector<double>{0, nan, 3, 3, 2}).empty());
}

TEST_CASE("Bins hold geometric means and their standard errors") {
    // ln S = 0, 2 in one bin: mean 1, sd √2, error 1.
    const std::vector<SlopeAreaPoint> points{{1.00e5, 1}, {1.21e5, std::exp(2.0)}, {3e6, 0.5}};
    const auto bins = slope_area_bins(points);
    REQUIRE(bins.size() == 2);
    CHECK(bins[0].area_m2 == Approx(1.1e5));
    CHECK(bins[0].slope == Approx(std::exp(1.0)));
    CHECK(bins[0].slope_se == Approx(std::exp(1.0)));
    CHECK(bins[0].count == 2);
    CHECK(bins[1].slope == Approx(0.5));
    CHECK(std::isnan(bins[1].slope_se));
    CHECK(slope_area_bins({}).empty());
}

TEST_CASE("Bins are a tenth of a decade wide, from each power of ten on") {
    const std::vector<SlopeAreaPoint> points{{0.999e5, 1}, {1.0e5, 1},  {1.25e5, 1},
                                             {1.26e5, 1},  {1.58e5, 1}, {1.59e5, 1}};
    const auto bins = slope_area_bins(points);
    REQUIRE(bins.size() == 4);
    CHECK(bins[0].count == 1);
    CHECK(bins[1].count == 2);
    CHECK(bins[2].count == 2);
    CHECK(slope_area_bins(points, 1).size() == 2);
}

TEST_CASE("Weights of points count like lengths in the mean and in its error") {
    const auto bins = slope_area_bins(std::vector<SlopeAreaPoint>{{1e5, 1, 3}, {1e5, std::exp(1.0), 1}});
    REQUIRE(bins.size() == 1);
    CHECK(bins[0].slope == Approx(std::exp(0.25)));
    // Σ(w·(x − x̄))² = (3·¼)² + (1·¾)² = 1.125; times 2/1, root, over Σw = 4.
    CHECK(bins[0].slope_se / bins[0].slope == Approx(std::sqrt(2.25) / 4));
    const auto equal = slope_area_bins(std::vector<SlopeAreaPoint>{{1e5, 1, 7}, {1e5, 2, 7}, {1e5, 5, 7}});
    const auto unit = slope_area_bins(std::vector<SlopeAreaPoint>{{1e5, 1}, {1e5, 2}, {1e5, 5}});
    CHECK(equal[0].slope_se == Approx(unit[0].slope_se));
}

TEST_CASE("The steepness law is found again exactly on exact bins") {
    std::vector<SlopeAreaBin> bins;
    for (int i = 0; i < 12; ++i) {
        const double area = 1e5 * std::pow(10, 0.2 * i);
        bins.push_back({area, 90 * std::pow(area, -0.47), 0.01, 5});
    }
    const SlopeArea fit = fit_slope_area(bins);
    CHECK(fit.theta.value == Approx(0.47).epsilon(1e-10));
    CHECK(fit.ks.value == Approx(90).epsilon(1e-9));
    CHECK(fit.r2 == Approx(1));
    CHECK(fit.theta.interval95[0] <= fit.theta.interval95[1]);
    CHECK(fit.ks.interval95[0] > 0);
    const SlopeArea two = fit_slope_area({bins[0], bins[1]});
    CHECK(two.theta.value == Approx(0.47));
    CHECK(std::isnan(two.theta.standard_error));
    CHECK(std::isnan(fit_slope_area({}).theta.value));
}

TEST_CASE("A steady landscape written as a DEM gives back m and k as measured heights allow") {
    const Grid grid = plane_grid(160, 160, 90, 90);
    for (const double n : {1.0, 1.5}) {
        for (const double m : {0.35, 0.5}) {
            for (const double slope_at_reference : {0.08, 0.01}) {  // relief about 800 and 100 m
                const support::SteadyLaw law{.theta = m / n, .slope_at_reference = slope_at_reference};
                const auto height = support::steady_raster(grid, law, 1);
                const Bias exact = dem_bias(grid, height, law);
                CHECK(std::abs(n * exact.m) < 0.0005);
                CHECK(std::abs(n * exact.k_at_reference) < 0.002);
                const Bias whole_metres = dem_bias(grid, rounded(height, 1), law);
                CHECK(std::abs(n * whole_metres.m) < 0.01);
                CHECK(std::abs(n * whole_metres.k_at_reference) < 0.02);
            }
        }
    }
}

TEST_CASE("Vertical noise of a metre or two leaves m within 0.02 and k within 10 % at 800 m of relief") {
    const Grid grid = plane_grid(160, 160, 90, 90);
    const support::SteadyLaw law;
    const auto steady = support::steady_raster(grid, law, 2);
    for (const double sd : {1.0, 2.0}) {
        auto height = steady;
        Random random(31, 0);
        for (double& each : height) each += sd * random.normal();
        for (const double quantum : {0.0, 1.0}) {
            const Bias bias = dem_bias(grid, quantum > 0 ? rounded(height, quantum) : height, law);
            CHECK(std::abs(bias.m) < 0.02);
            CHECK(std::abs(bias.k_at_reference) < 0.10);
        }
    }
}

TEST_CASE("A link is one point: its drop over its length, and the geometric mean of its areas, by hand") {
    // 0 ← 1 ← 2 ← {3 ← 5, 4}: the outlet's link of two steps, one of two and one of a single step above the junction 2.
    const FlowGraph graph = graph_of({none, 0, 1, 2, 2, 3}, 10);
    const std::vector<double> area{9e5, 8e5, 2e5, 5e5, 1e5, 2e5}, height{0, 1, 4, 6, 4, 9};
    const StreamNetwork network = stream_network(graph, std::vector<std::uint8_t>(6, 1), area, height);
    REQUIRE(network.size() == 3);
    const auto points = link_slopes(network, graph, area);
    REQUIRE(points.size() == 2);  // the step from 4 to 2 does not fall
    CHECK(points[0].slope == Approx(4 / 20.0));
    CHECK(points[0].area_m2 == Approx(std::sqrt(8e5 * 2e5)));
    CHECK(points[0].weight == 20);
    CHECK(points[0].node == 1);
    CHECK(points[1].slope == Approx(5 / 20.0));
    CHECK(points[1].area_m2 == Approx(std::sqrt(5e5 * 2e5)));
    CHECK(points[1].node == 3);
}

TEST_CASE("Bins of nodes are those of their points, in any number of blocks and for any number of threads") {
    for (const Index side : {40u, 90u, 620u}) {
        const Grid grid = plane_grid(side, side, 30, 30);
        std::vector<double> height(grid.size());
        std::vector<std::uint8_t> used(grid.size());
        for (Index node = 0; node < grid.size(); ++node) {
            height[node] =
                std::floor(8 * uniform_at(side, 0, node)) / 4;  // quarters of a metre, so that some are level
            used[node] = uniform_at(side, 1, node) < 0.9;
        }
        const support::RoutedDem dem = support::routed_dem(grid, height);
        const auto points = node_slopes(dem.graph, dem.area_m2, dem.carved_m, used);
        const auto expected = slope_area_bins(points);
        const NodeSlopeBins found = node_slope_bins(dem.graph, dem.area_m2, dem.carved_m, used);
        CHECK(found.looked_at - found.level == points.size());
        CHECK(found.level > 0);
        REQUIRE(found.bins.size() == expected.size());
        for (std::size_t i = 0; i < expected.size(); ++i) {
            CHECK(found.bins[i].count == expected[i].count);
            CHECK(found.bins[i].area_m2 == Approx(expected[i].area_m2).epsilon(1e-10));
            CHECK(found.bins[i].slope == Approx(expected[i].slope).epsilon(1e-10));
            if (expected[i].count > 1) CHECK(found.bins[i].slope_se == Approx(expected[i].slope_se).epsilon(1e-8));
        }
        const ThreadLimit limit(1);
        const NodeSlopeBins alone = node_slope_bins(dem.graph, dem.area_m2, dem.carved_m, used);
        for (std::size_t i = 0; i < alone.bins.size(); ++i) CHECK(alone.bins[i].slope == found.bins[i].slope);
    }
}

TEST_CASE("Nodes of a steady landscape have its law to rounding, links to the curvature along them") {
    const Grid grid = plane_grid(160, 160, 90, 90);
    for (const double theta : {0.3, 0.5, 0.7}) {
        const support::SteadyLaw law{.theta = theta};
        const support::RoutedDem dem = support::routed_dem(grid, support::steady_raster(grid, law, 7));
        const double ks = law.slope(1);
        const NodeSlopeBins nodes = node_slope_bins(dem.graph, dem.area_m2, dem.carved_m);
        const SlopeArea by_nodes = fit_slope_area(nodes.bins);
        CHECK(by_nodes.theta.value == Approx(theta).margin(1e-5));
        CHECK(by_nodes.ks.value == Approx(ks).epsilon(1e-4));
        const auto channels = channels_by_area(dem.area_m2, 2e5);
        const StreamNetwork network = stream_network(dem.graph, channels, dem.area_m2, dem.carved_m);
        const SlopeArea by_links = fit_slope_area(slope_area_bins(link_slopes(network, dem.graph, dem.area_m2)));
        CHECK(std::abs(by_links.theta.value - theta) < 0.01);
        const double at_reference = by_links.ks.value * std::pow(law.reference_area_m2, -by_links.theta.value);
        CHECK(at_reference == Approx(law.slope_at_reference).epsilon(0.03));
    }
}

TEST_CASE("The turnover is the steepest of the bins, and its range those that errors do not tell from it") {
    const std::vector<SlopeAreaBin> bins{{1e3, 0.20, 0.01, 50}, {2e3, 0.29, 0.01, 50}, {4e3, 0.30, 0.01, 50},
                                         {8e3, 0.28, 0.01, 50}, {2e4, 0.25, 0.01, 50}, {3e4, 0.90, 0.01, 4}};
    const Turnover turnover = hillslope_turnover(bins);
    CHECK(turnover.area_m2 == 4e3);
    CHECK(turnover.range_m2[0] == 2e3);
    CHECK(turnover.range_m2[1] == 8e3);  // 0.02 < 1.96·0.01·√2 = 0.0277 < 0.05
    CHECK(std::isnan(hillslope_turnover(std::span(bins).first(3)).area_m2));
    CHECK(std::isnan(hillslope_turnover(std::span(bins).subspan(2)).area_m2));
    CHECK(std::isnan(hillslope_turnover({}).range_m2[0]));
}

TEST_CASE("Only nodes in use enter, as points and in bins") {
    // Ten nodes in a row that fall by 1, 2, 3, … m over 100 m each, of which every third counts.
    std::vector<Index> receiver{none};
    std::vector<double> height{0}, area{11};
    std::vector<std::uint8_t> used{0};
    for (Index node = 1; node <= 10; ++node) {
        receiver.push_back(node - 1);
        height.push_back(height.back() + node);
        area.push_back(11.0 - node);
        used.push_back(node % 3 == 0);
    }
    const auto graph = support::graph_of(receiver, 100);
    const auto points = node_slopes(graph, area, height, used);
    REQUIRE(points.size() == 3);
    for (std::size_t i = 0; i < 3; ++i) {
        CHECK(points[i].node == 3 * (i + 1));
        CHECK(points[i].slope == Approx(0.03 * (i + 1)));
        CHECK(points[i].area_m2 == 8 - 3.0 * i);
    }
    const NodeSlopeBins binned = node_slope_bins(graph, area, height, used);
    CHECK(binned.looked_at == 3);
    REQUIRE(binned.bins.size() == 3);
    CHECK(binned.bins[0].slope == Approx(0.09));
    CHECK(binned.bins[2].area_m2 == Approx(8));
}

TEST_CASE("Errors of bins lean on the scatter that all bins show, by hand") {
    // Variance of a point, from n·(se/slope)²: 0.03 with 2 degrees of freedom, 0.24 with 5: pooled 0.18, counting 4.
    const std::vector<SlopeAreaBin> bins{{1e5, 0.1, 0.01, 3}, {2e5, 0.05, 0.01, 6}, {4e5, 0.03, std::nan(""), 1}};
    const auto errors = bin_errors(bins, 0);
    CHECK(errors[0] == Approx(std::sqrt((4 * 0.18 + 2 * 0.03) / 6 / 3)));
    CHECK(errors[1] == Approx(std::sqrt((4 * 0.18 + 5 * 0.24) / 9 / 6)));
    CHECK(errors[2] == Approx(std::sqrt(0.18)));
    const auto floored = bin_errors(bins, 0.1);
    CHECK(floored[0] == Approx(0.1 * std::log(10.0)));
    CHECK(floored[2] == Approx(std::sqrt(0.18)));
}
