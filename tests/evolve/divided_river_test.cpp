// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <limits>

#include "support/lattice_mesh.hpp"
#include "support/settings.hpp"
#include "thalweg/core/error.hpp"
#include "thalweg/core/parallel.hpp"
#include "thalweg/evolve/simulate.hpp"

using namespace thalweg;
using namespace thalweg::evolve;

namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();

River dividing(double k, double m, double n) { return {.k = k, .m = m, .n = n, .flow = Flow::multiple}; }

/// k that gives slopes of a few per cent at A = 1e6 m² under 1 mm/yr, whatever m and n.
double erodibility(double m, double n) { return 1e-3 / (std::pow(1e6, m) * std::pow(0.05, n)); }

template <class T>
StepReport step(const T& topology, const River& river, const Setting& setting, double dt_yr, Landscape& landscape) {
    return erode(topology, drain(topology, landscape, setting, river), river, setting, dt_yr, landscape);
}

/// A rough pyramid: neither pits nor ties, so that nothing hangs on passes and numbering.
Landscape pyramid(const Grid& grid, const Setting& setting) {
    Landscape landscape = support::rough_start(setting, 9, 8);
    for (Index node = 0; node < grid.size(); ++node) {
        const Index r = grid.row(node), c = grid.col(node);
        landscape.elevation_m[node] += 10.0 * std::min({r, c, grid.rows - 1 - r, grid.cols - 1 - c});
    }
    return landscape;
}

/// Cells of 100 m in rows that close to rings, as a mesh: every cell of a row is like every other.
Mesh ring_mesh(Index rows, Index cols) {
    Mesh mesh;
    mesh.offset.push_back(0);
    for (Index node = 0; node < rows * cols; ++node) {
        const Index r = node / cols, c = node % cols;
        mesh.x.push_back(c);
        mesh.y.push_back(r);
        mesh.cell_area.push_back(1e4);
        mesh.on_outline.push_back(0);
        for (int dr = -1; dr <= 1; ++dr) {
            for (int dc = -1; dc <= 1; ++dc) {
                if ((dr == 0 && dc == 0) || r + dr >= rows) continue;  // row −1 wraps round to a large number
                mesh.neighbor_list.push_back((r + dr) * cols + (c + dc + cols) % cols);
                mesh.length_list.push_back(dr != 0 && dc != 0 ? 100 * std::sqrt(2.0) : 100.0);
            }
        }
        mesh.offset.push_back(static_cast<Index>(mesh.neighbor_list.size()));
    }
    return mesh;
}

/// Cells with base level on both sides, 10 m apart: the middle one has two receivers.
struct Saddle {
    Grid grid = plane_grid(1, 3, 10, 10);
    Setting setting{.uplift_m_per_yr = {0.01, 0.01, 0.01},
                    .rainfall = {1, 1, 1},
                    .boundary = {Boundary::base_level, Boundary::interior, Boundary::base_level}};
    Landscape landscape{.elevation_m = {0, 5, 2}};
};

/// Height of a node above receivers of the given heights by halving an interval, with numbers of more digits.
long double height_by_bisection(double raised, const terrain::MultipleFlow& flow, Index node,
                                const std::vector<double>& z, double c, double n) {
    const auto excess = [&](long double x) {
        long double sum = x - raised;
        flow.receivers(node, [&](Index receiver, double length, double share) {
            if (x > z[receiver]) sum += c * share * std::pow((x - z[receiver]) / length, static_cast<long double>(n));
        });
        return sum;
    };
    long double low = -1e6L, high = raised;
    for (int i = 0; i < 200; ++i) {
        const long double middle = (low + high) / 2;
        (excess(middle) > 0 ? high : low) = middle;
    }
    return high;
}

/// Volume that the law takes at the heights after a step.
template <class T>
double eroded_by_law(const T& topology, const Drainage& drainage, const River& river, double dt_yr,
                     const std::vector<double>& z) {
    double volume = 0;
    for (const Index node : drainage.order) {
        drainage.flow.receivers(node, [&](Index receiver, double length, double share) {
            const double slope = std::max(0.0, z[node] - z[receiver]) / length;
            volume += topology.area(node) * dt_yr * river.k * std::pow(drainage.area_m2[node], river.m) * share *
                      std::pow(slope, river.n);
        });
    }
    return volume;
}

template <class T>
void check_balance(const T& topology, const River& river, double dt_yr, std::uint64_t seed) {
    const Setting setting = support::island(topology, 1e-3);
    Landscape landscape = support::rough_start(setting, 50, seed);
    MassBalance total;
    CAPTURE(river.n, river.talus_slope, dt_yr);
    for (int i = 0; i < 20; ++i) {
        const Drainage drainage = drain(topology, landscape, setting, river);
        const StepReport report = erode(topology, drainage, river, setting, dt_yr, landscape);
        if (std::isinf(river.talus_slope)) {
            const double expected = eroded_by_law(topology, drainage, river, dt_yr, landscape.elevation_m);
            CHECK(report.mass.eroded_m3 == Approx(expected).epsilon(1e-5));
        }
        total.uplifted_m3 += report.mass.uplifted_m3;
        total.eroded_m3 += report.mass.eroded_m3;
        total.talus_m3 += report.mass.talus_m3;
        total.exported_m3 += report.mass.exported_m3;
        total.stored_m3 += report.mass.stored_m3;
    }
    CHECK(total.eroded_m3 > 0);
    CHECK((total.talus_m3 > 0) == std::isfinite(river.talus_slope));
    CHECK(std::abs(total.relative_residual()) < 1e-9);
}

template <class T>
void check_steady(const T& topology, double n) {
    const double m = 0.5 * n, uplift = 1e-3;
    const River river = dividing(erodibility(m, n), m, n);
    const Setting setting = support::island(topology, uplift);
    Landscape landscape = support::rough_start(setting, 10, 4);
    simulate(topology, {river}, setting, {.step_yr = 1e5, .max_steps = 2000, .convergence = 1e-11}, landscape);
    const Drainage drainage = drain(topology, landscape, setting, river);
    const std::vector<double> slope = slopes_along_flow(topology, drainage, river, landscape);
    CHECK(drainage.lakes == 0);
    double worst = 0;
    for (const Index node : drainage.order) {
        if (drainage.directions[node] == no_flow) continue;
        const double expected = std::pow(uplift / river.k, 1 / n) * std::pow(drainage.area_m2[node], -m / n);
        worst = std::max(worst, std::abs(slope[node] / expected - 1));
    }
    CAPTURE(n);
    CHECK(worst < 1e-8);
}

}  // namespace

TEST_CASE("A cell between two receivers is dug towards both in proportion to its shares, by hand") {
    // Slopes 0.5 and 0.3: with p = 1 shares 5/8 and 3/8. u·dt = 1, so b = 6. c = dt·k·A = 10 m:
    // x = 6 − 10·(5/8·x/10 + 3/8·(x − 2)/10), 2 x = 6.75.
    Saddle saddle;
    River river = dividing(1e-3, 1, 1);
    river.flow_exponent = 1;
    const Drainage drainage = drain(saddle.grid, saddle.landscape, saddle.setting, river);
    CHECK(drainage.area_m2[0] == Approx(100 + 500.0 / 8).epsilon(1e-15));
    CHECK(drainage.area_m2[2] == Approx(100 + 300.0 / 8).epsilon(1e-15));
    const StepReport report = erode(saddle.grid, drainage, river, saddle.setting, 100, saddle.landscape);
    CHECK(saddle.landscape.elevation_m[1] == Approx(3.375).epsilon(1e-15));
    CHECK(report.mass.eroded_m3 == Approx(262.5).epsilon(1e-14));
    CHECK(report.mass.stored_m3 == Approx(-162.5).epsilon(1e-14));
}

TEST_CASE("A receiver that ends above the node neither digs nor fills it") {
    // c = 100 m would bring x to 1.23 m with both receivers, under the second one's 2 m: x·(1 + 6.25) = 6.
    Saddle saddle;
    River river = dividing(1e-2, 1, 1);
    river.flow_exponent = 1;
    const StepReport report = step(saddle.grid, river, saddle.setting, 100, saddle.landscape);
    CHECK(saddle.landscape.elevation_m[1] == Approx(6 / 7.25).epsilon(1e-15));
    CHECK(report.mass.eroded_m3 == Approx(100 * 6 * 6.25 / 7.25).epsilon(1e-14));
}

TEST_CASE("The talus limit holds towards the steepest receiver") {
    // As the first case, 3.375 m; tan 0.1 allows 1 m above 0 and 3 m above 2: the steepest decides.
    Saddle saddle;
    River river = dividing(1e-3, 1, 1);
    river.flow_exponent = 1;
    river.talus_slope = 0.1;
    const StepReport report = step(saddle.grid, river, saddle.setting, 100, saddle.landscape);
    CHECK(saddle.landscape.elevation_m[1] == Approx(1).epsilon(1e-15));
    CHECK(report.mass.talus_m3 == Approx(237.5).epsilon(1e-14));
    saddle.landscape.elevation_m[1] = 1;
    const Drainage after = drain(saddle.grid, saddle.landscape, saddle.setting, river);
    CHECK(at_talus_limit(saddle.grid, after, river, saddle.landscape) == std::vector<std::uint8_t>{0, 1, 0});
}

TEST_CASE("The height after a step solves the equation for any exponent, receivers and digging") {
    const Grid grid = plane_grid(3, 3, 30, 20);
    Setting setting = support::island(grid, 1e-3);
    for (const double n : {0.3, 0.5, 0.8, 1.0, 1.5, 2.0, 4.0, 5.0}) {
        for (std::uint64_t seed = 1; seed <= 120; ++seed) {
            Random random(seed, 3);
            Landscape landscape;
            for (Index node = 0; node < 9; ++node) landscape.elevation_m.push_back(40 * random.uniform());
            landscape.elevation_m[4] = 40 * random.uniform() + 10;
            const River river = dividing(std::pow(10, -8 + 8 * random.uniform()), 0.5, n);
            const double dt_yr = std::pow(10, 2 + 4 * random.uniform());
            const Drainage drainage = drain(grid, landscape, setting, river);
            const double c = dt_yr * river.k * std::sqrt(drainage.area_m2[4]);
            const double raised = landscape.elevation_m[4] + dt_yr * 1e-3;
            const auto expected =
                static_cast<double>(height_by_bisection(raised, drainage.flow, 4, landscape.elevation_m, c, n));
            erode(grid, drainage, river, setting, dt_yr, landscape);
            CAPTURE(n, seed, c);
            if (drainage.directions[4] == no_flow) continue;
            REQUIRE(landscape.elevation_m[4] == Approx(expected).epsilon(1e-13).margin(1e-12));
        }
    }
}

TEST_CASE("With divided flow the mass balance closes to 1e-9 for every exponent, on grid and mesh") {
    const Grid grid = plane_grid(20, 24, 100, 130);
    const Mesh mesh = support::lattice_mesh(20, 20, 120, 0.25, 3);
    std::uint64_t seed = 1;
    for (const double n : {0.3, 0.7, 1.0, 1.5, 5.0}) {
        for (const double talus : {infinity, 0.06}) {
            River river = dividing(erodibility(0.5 * n, n), 0.5 * n, n);
            river.talus_slope = talus;
            for (const double dt_yr : {100.0, 2e4, 1e6}) {
                check_balance(grid, river, dt_yr, ++seed);
                check_balance(mesh, river, dt_yr, ++seed);
            }
        }
    }
}

TEST_CASE("At rest every node stands at the steady slope of its divided area, on grid and mesh") {
    for (const double n : {0.5, 0.7, 1.0, 1.5, 2.0, 4.0}) {
        check_steady(plane_grid(14, 15, 100, 100), n);
        check_steady(support::lattice_mesh(12, 13, 100, 0.2, 3), n);
    }
}

TEST_CASE("A planar ramp that rises evenly keeps its level lines, and its profile is the law's") {
    // All cells of a row are alike, so the area of each is that of the rows above it, whatever way it divides. With a
    // fall of d per row, straight slope d/L and askew d/(√2 L): Σ w·S = d/L·(1 + 2^(1/2 − p/2))/(1 + 2^(1 − p/2)).
    const Index rows = 12, cols = 9;
    const Mesh mesh = ring_mesh(rows, cols);
    Setting setting = support::island(mesh, 1e-3);
    Landscape landscape;
    for (Index node = 0; node < mesh.size(); ++node) {
        setting.boundary[node] = node / cols == rows - 1 ? Boundary::base_level : Boundary::interior;
        landscape.elevation_m.push_back(0.1 * (rows - 1 - node / cols));
    }
    const River river = dividing(1e-5, 0.5, 1);
    simulate(mesh, {river}, setting, {.step_yr = 1e6, .max_steps = 40, .convergence = 0}, landscape);
    const Drainage drainage = drain(mesh, landscape, setting, river);
    const double p = river.flow_exponent;
    const double per_fall = (1 + std::pow(2, 0.5 - p / 2)) / (1 + std::pow(2, 1 - p / 2)) / 100;
    for (Index r = rows - 1; r-- > 0;) {
        for (Index c = 0; c < cols; ++c) {
            const Index node = r * cols + c;
            CHECK(drainage.area_m2[node] == Approx(1e4 * (r + 1)).epsilon(1e-9));
            const double fall = landscape.elevation_m[node] - landscape.elevation_m[node + cols];
            CHECK(fall * per_fall == Approx(1e-3 / 1e-5 / std::sqrt(1e4 * (r + 1))).epsilon(1e-9));
        }
    }
}

TEST_CASE("A very large exponent of the flow gives the landscape of one receiver") {
    const Grid grid = plane_grid(40, 40, 100, 100);
    const Setting setting = support::island(grid, 1e-3);
    for (const double n : {0.7, 1.0, 1.5}) {
        Landscape divided = pyramid(grid, setting), single = divided;
        River river = dividing(erodibility(0.5, n), 0.5, n);
        river.flow_exponent = 1e9;
        River of_one = river;
        of_one.flow = Flow::single;
        for (int i = 0; i < 5; ++i) {
            step(grid, river, setting, 1e4, divided);
            step(grid, of_one, setting, 1e4, single);
        }
        double worst = 0;
        for (Index node = 0; node < grid.size(); ++node) {
            worst = std::max(worst, std::abs(divided.elevation_m[node] - single.elevation_m[node]));
        }
        CHECK(worst < 1e-9);
    }
}

TEST_CASE("Lake water does not dig: a pit behind a sill that stays above it is only lifted") {
    const Grid grid = plane_grid(1, 3, 10, 10);
    Setting setting{.uplift_m_per_yr = {0.01, 0.01, 0.01},
                    .rainfall = {1, 1, 1},
                    .boundary = {Boundary::base_level, Boundary::interior, Boundary::interior}};
    Landscape landscape{.elevation_m = {0, 10, 1}};
    const River river = dividing(1e-4, 1, 1);
    const Drainage drainage = drain(grid, landscape, setting, river);
    CHECK(drainage.lakes == 1);
    CHECK(drainage.area_m2 == std::vector<double>{300, 200, 100});
    erode(grid, drainage, river, setting, 100, landscape);
    CHECK(landscape.elevation_m[1] == Approx(110.0 / 12).epsilon(1e-14));
    CHECK(landscape.elevation_m[2] == 2);
}

TEST_CASE("Rainfall and erodibility weigh divided flow as they weigh single flow") {
    Saddle saddle;
    saddle.setting.rainfall = {0, 2, 0};
    saddle.setting.relative_erodibility = {1, 0.5, 1};
    River river = dividing(1e-3, 1, 1);
    river.flow_exponent = 1;
    step(saddle.grid, river, saddle.setting, 100, saddle.landscape);  // 2 · 0.5 = 1: as the first case
    CHECK(saddle.landscape.elevation_m[1] == Approx(3.375).epsilon(1e-15));
}

TEST_CASE("The slope to no receiver of divided flow exceeds the talus limit") {
    const Mesh mesh = support::lattice_mesh(30, 30, 100, 0.3, 5);
    const Setting setting = support::island(mesh, 1e-3);
    Landscape landscape = support::rough_start(setting, 500, 6);
    River river = dividing(1e-6, 0.5, 1);
    river.talus_slope = 0.6;
    for (int i = 0; i < 20; ++i) {
        const Drainage drainage = drain(mesh, landscape, setting, river);
        erode(mesh, drainage, river, setting, 5e4, landscape);
        double steepest = 0;
        for (const Index node : drainage.order) {
            drainage.flow.receivers(node, [&](Index receiver, double length, double) {
                const double drop = landscape.elevation_m[node] - landscape.elevation_m[receiver];
                steepest = std::max(steepest, drop / length);
            });
        }
        CHECK(steepest <= 0.6 * (1 + 1e-12));
        CHECK(steepest > 0.59);
    }
}

TEST_CASE("A mirrored grid gives the mirrored landscape of divided flow, and any number of threads the same bytes") {
    const Grid grid = plane_grid(33, 27, 100, 100);
    const Setting setting = support::island(grid, 1e-3);
    const Landscape start = pyramid(grid, setting);
    const auto mirrored = [&](const std::vector<double>& values) {
        std::vector<double> turned(values.size());
        for (Index node = 0; node < grid.size(); ++node) {
            turned[grid.row(node) * grid.cols + grid.cols - 1 - grid.col(node)] = values[node];
        }
        return turned;
    };
    const auto run = [&](std::vector<double> elevation_m, int threads) {
        const ThreadLimit limit(threads);
        Landscape landscape{.elevation_m = std::move(elevation_m)};
        simulate(grid, {dividing(erodibility(0.5, 1.5), 0.5, 1.5)}, setting, {.step_yr = 2e4, .max_steps = 3},
                 landscape);
        return landscape.elevation_m;
    };
    const std::vector<double> once = run(start.elevation_m, 1);
    CHECK(run(start.elevation_m, 2) == once);
    const std::vector<double> back = mirrored(run(mirrored(start.elevation_m), 1));
    double worst = 0;
    for (Index node = 0; node < grid.size(); ++node) worst = std::max(worst, std::abs(back[node] - once[node]));
    CHECK(worst < 1e-9);
}

TEST_CASE("What cannot be done with divided flow is refused in a sentence") {
    Saddle saddle;
    CHECK_THROWS_AS(solve_steady(saddle.grid, dividing(1e-3, 1, 1), saddle.setting, 10, saddle.landscape), Error);
    River river = dividing(1e-3, 1, 1);
    river.flow_exponent = -1;
    CHECK_THROWS_AS(step(saddle.grid, river, saddle.setting, 100, saddle.landscape), Error);
}
