// SPDX-License-Identifier: GPL-3.0-or-later
// Nothing depends on where north is or on the unit of length: one step from a surface without ties turned and mirrored
// comes out turned and mirrored, whole runs do so as ensembles.
#include <fmt/format.h>

#include <catch2/catch.hpp>
#include <cmath>
#include <map>

#include "landscapes.hpp"
#include "thalweg/core/statistics.hpp"
#include "thalweg/terrain/accumulate.hpp"
#include "thalweg/terrain/hypsometry.hpp"

using namespace thalweg;
using namespace thalweg::validation;

namespace {

constexpr Index across = 40;

/// Node to which one of the square's eight symmetries takes a cell: mirrored east–west first (4 and up), then turned.
Index moved(Index node, int symmetry) {
    Index row = node / across, col = node % across;
    if (symmetry >= 4) col = across - 1 - col;
    for (int turn = 0; turn < symmetry % 4; ++turn) {
        const Index old_row = row;
        row = col;
        col = across - 1 - old_row;
    }
    return row * across + col;
}

template <class T>
std::vector<T> moved_values(const std::vector<T>& values, int symmetry) {
    std::vector<T> result(values.size());
    for (Index node = 0; node < values.size(); ++node) result[moved(node, symmetry)] = values[node];
    return result;
}

/// The ways in which water may leave, by name.
std::map<std::string, std::vector<Boundary>> boundaries(const Grid& grid) {
    std::map<std::string, std::vector<Boundary>> all;
    all["whole rim"] = support::rim(grid);
    for (const char* name : {"one side", "two sides", "corner", "one cell inside", "open rim"}) {
        all[name].assign(grid.size(), Boundary::interior);
    }
    for (Index node = 0; node < grid.size(); ++node) {
        const Index r = grid.row(node), c = grid.col(node);
        if (r == 0) all["one side"][node] = Boundary::base_level;
        if (r == 0 || c == 0) all["two sides"][node] = Boundary::base_level;
        if (r == 0 && c == 0) all["corner"][node] = Boundary::base_level;
        if (r == 12 && c == 30) all["one cell inside"][node] = Boundary::base_level;
        if (all["whole rim"][node] == Boundary::base_level) all["open rim"][node] = Boundary::open;
    }
    return all;
}

evolve::Landscape after_one_step(const Grid& grid, const evolve::River& law, const evolve::Setting& setting,
                                 evolve::Landscape landscape) {
    const auto drainage = evolve::drain(grid, landscape, setting, law.receiver);
    evolve::erode(grid, drainage, law, setting, 2e4, landscape);
    return landscape;
}

struct Shape {
    double mean_m, highest_m, integral;
};

Shape run_to_rest(const Grid& grid, const evolve::River& law, evolve::Landscape landscape) {
    const evolve::Setting setting = support::island(grid, 1e-3);
    evolve::simulate(grid, {law}, setting, {.step_yr = 1e5, .max_steps = 2000}, landscape);
    const auto h = terrain::hypsometry(landscape.elevation_m, terrain::cell_areas(grid));
    return {h.mean_m, h.maximum_m, h.integral};
}

}  // namespace

TEST_CASE("One step from a surface without ties commutes with the square's eight symmetries, whatever the outlets") {
    const Grid grid = plane_grid(across, across, 100, 100);
    for (const auto& [name, boundary] : boundaries(grid)) {
        for (const double n : {0.7, 1.0, 2.0}) {
            for (const double talus : {std::numeric_limits<double>::infinity(), 0.6}) {
                const evolve::River law{.k = 1e-3 / std::pow(0.05 * 300, n), .m = 0.5 * n, .n = n, .talus_slope = talus};
                evolve::Setting setting = support::island(grid, 1e-3);
                setting.boundary = boundary;
                for (Index node = 0; node < grid.size(); ++node) setting.rainfall[node] = 0.5 + uniform_at(3, 1, node);
                const auto start = support::rough_start(setting, 50, 11);
                const auto plain = after_one_step(grid, law, setting, start);
                double worst = 0;
                for (int symmetry = 1; symmetry < 8; ++symmetry) {
                    evolve::Setting turned = setting;
                    turned.boundary = moved_values(setting.boundary, symmetry);
                    turned.rainfall = moved_values(setting.rainfall, symmetry);
                    const auto there =
                        after_one_step(grid, law, turned, {.elevation_m = moved_values(start.elevation_m, symmetry)});
                    const auto expected = moved_values(plain.elevation_m, symmetry);
                    for (Index node = 0; node < grid.size(); ++node) {
                        worst = std::max(worst, std::abs(there.elevation_m[node] / expected[node] - 1));
                        if (expected[node] == 0) worst = std::max(worst, std::abs(there.elevation_m[node]));
                    }
                }
                INFO(name << " n " << n << " talus " << talus);
                CHECK(worst < 1e-12);
            }
        }
    }
}

TEST_CASE("One step on a triangulation turned by a right angle comes out turned") {
    const Polygon square{{0, 0}, {side_m, 0}, {side_m, side_m}, {0, side_m}};
    auto points = mesh::poisson_disk_count(square, 2000, 5);
    const Mesh plain = mesh::triangulate(square, points);
    for (Point& p : points.points) p = {side_m - p.y, p.x};
    const Mesh turned = mesh::triangulate(square, points);
    REQUIRE(plain.size() == turned.size());
    const auto key = [](double x, double y) { return std::pair{std::llround(x * 1e6), std::llround(y * 1e6)}; };
    std::map<std::pair<long long, long long>, Index> at;
    for (Index node = 0; node < turned.size(); ++node) at[key(turned.x[node], turned.y[node])] = node;
    std::vector<Index> place;
    for (Index node = 0; node < plain.size(); ++node) place.push_back(at.at(key(side_m - plain.y[node], plain.x[node])));

    const evolve::River law{.k = 1e-5, .m = 0.5, .n = 1.5, .talus_slope = 0.5};
    const evolve::Setting here = support::island(plain, 1e-3), there = support::island(turned, 1e-3);
    evolve::Landscape a = support::rough_start(here, 50, 4), b{.elevation_m = a.elevation_m};
    for (Index node = 0; node < plain.size(); ++node) b.elevation_m[place[node]] = a.elevation_m[node];
    evolve::erode(plain, evolve::drain(plain, a, here, law.receiver), law, here, 2e4, a);
    evolve::erode(turned, evolve::drain(turned, b, there, law.receiver), law, there, 2e4, b);
    double worst = 0;
    for (Index node = 0; node < plain.size(); ++node) {
        worst = std::max(worst, std::abs(a.elevation_m[node] - b.elevation_m[place[node]]) /
                                    std::max(1.0, std::abs(a.elevation_m[node])));
    }
    fmt::print("triangulation turned by a right angle: worst {:.1e}\n", worst);
    CHECK(worst < 1e-9);  // coordinates are rounded anew when they are turned
}

TEST_CASE("Whole runs from turned and mirrored starts differ by no more than runs from other seeds do") {
    const Grid grid = plane_grid(across, across, 250, 250);
    const evolve::River law{.k = 2e-6, .m = 0.5, .n = 1};
    std::vector<double> mean_m, highest_m, integral, mean_turned, highest_turned, integral_turned;
    for (std::uint64_t seed = 0; seed < 8; ++seed) {
        const auto start = support::rough_start(support::island(grid, 1e-3), 1, seed);
        const Shape plain = run_to_rest(grid, law, start);
        const Shape turned =
            run_to_rest(grid, law, {.elevation_m = moved_values(start.elevation_m, 1 + static_cast<int>(seed % 7))});
        mean_m.push_back(plain.mean_m);
        highest_m.push_back(plain.highest_m);
        integral.push_back(plain.integral);
        mean_turned.push_back(turned.mean_m);
        highest_turned.push_back(turned.highest_m);
        integral_turned.push_back(turned.integral);
    }
    const auto within = [](const std::vector<double>& a, const std::vector<double>& b) {
        return std::abs(mean(a) - mean(b)) <= standard_deviation(a);
    };
    fmt::print("turned ensembles: mean {:.2f} and {:.2f} m, highest {:.2f} and {:.2f} m\n", mean(mean_m),
               mean(mean_turned), mean(highest_m), mean(highest_turned));
    CHECK(within(mean_m, mean_turned));
    CHECK(within(highest_m, highest_turned));
    CHECK(within(integral, integral_turned));
}

TEST_CASE("A whole run in kilometres and thousands of years is the same landscape") {
    const Grid metres = plane_grid(across, across, 250, 250), kilometres = plane_grid(across, across, 0.25, 0.25);
    const evolve::River law{.k = 2e-6, .m = 0.4, .n = 1.3};
    evolve::River scaled = law;  // k' = k·(10⁶)^m·10³/10³: areas in km², m/yr is km/kyr
    scaled.k *= std::pow(1e6, law.m);
    const evolve::Setting setting = support::island(metres, 1e-3);
    evolve::Landscape a = support::rough_start(setting, 1, 2), b = a;
    for (double& height : b.elevation_m) height /= 1000;
    evolve::simulate(metres, {law}, setting, {.step_yr = 5e4, .max_steps = 30, .convergence = 0}, a);
    evolve::simulate(kilometres, {scaled}, setting, {.step_yr = 50, .max_steps = 30, .convergence = 0}, b);
    double worst = 0, highest = 0;
    for (Index node = 0; node < metres.size(); ++node) {
        worst = std::max(worst, std::abs(a.elevation_m[node] - 1000 * b.elevation_m[node]));
        highest = std::max(highest, a.elevation_m[node]);
    }
    fmt::print("km and kyr: worst {:.1e} m of {:.0f} m\n", worst, highest);
    CHECK(worst < 1e-9 * highest);
}
