// SPDX-License-Identifier: GPL-3.0-or-later
#include "thalweg/evolve/hillslope.hpp"

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

using Heights = std::vector<double>;

/// A grid whose rows differ, as those of a geographic one do.
Grid tapering_grid(Index rows, Index cols) {
    Grid grid{.rows = rows, .cols = cols, .cell_area = {}, .east_west = {}, .north_south = {}, .diagonal = {}};
    for (Index row = 0; row < rows; ++row) {
        grid.east_west.push_back(80 + 2.0 * row);
        grid.cell_area.push_back(grid.east_west[row] * 110);
        if (row + 1 == rows) break;
        grid.north_south.push_back(110 + 0.1 * row);
        grid.diagonal.push_back(std::hypot(grid.east_west[row] + 1, grid.north_south[row]));
    }
    return grid;
}

/// What a node has won by the step, over dt, plus what leaves it through its faces at the end: 0 everywhere if the step
/// is right. The faces are computed here from circumcentres, and the gradients not at all.
double face_width(const Grid& grid, Index node, Slot slot) {
    const Index row = grid.row(node);
    if (slot == 2) return (grid.east_west[row] + grid.east_west[row + 1]) / 2;
    if (slot == 6) return (grid.east_west[row] + grid.east_west[row - 1]) / 2;
    if (slot % 2 == 1) return 0;
    const double own = grid.cell_area[row] / grid.east_west[row];
    const double north = row > 0 ? grid.north_south[row - 1] : own;
    const double south = row + 1 < grid.rows ? grid.north_south[row] : own;
    return (north + south) / 2;
}

Point circumcentre(const Mesh& mesh, const std::array<Index, 3>& t) {
    const double ax = mesh.x[t[0]], ay = mesh.y[t[0]];
    const double bx = mesh.x[t[1]] - ax, by = mesh.y[t[1]] - ay, cx = mesh.x[t[2]] - ax, cy = mesh.y[t[2]] - ay;
    const double d = 2 * (bx * cy - by * cx);
    const double b2 = bx * bx + by * by, c2 = cx * cx + cy * cy;
    return {ax + (cy * b2 - by * c2) / d, ay + (bx * c2 - cx * b2) / d};
}

double face_width(const Mesh& mesh, Index node, Slot slot) {
    const Index other = mesh.neighbor(node, slot);
    const double ex = mesh.x[other] - mesh.x[node], ey = mesh.y[other] - mesh.y[node];
    const double length = std::hypot(ex, ey);
    double width = 0;
    for (const auto& t : mesh.triangles) {
        if (std::ranges::count(t, node) == 0 || std::ranges::count(t, other) == 0) continue;
        Index third = none;
        for (const Index corner : t) {
            if (corner != node && corner != other) third = corner;
        }
        // Distance of the circumcentre from the edge, positive on the side of the third corner.
        const Point centre = circumcentre(mesh, t);
        const auto across = [&](double x, double y) {
            return (ex * (y - mesh.y[node]) - ey * (x - mesh.x[node])) / length;
        };
        width += std::copysign(1.0, across(mesh.x[third], mesh.y[third])) * across(centre.x, centre.y);
    }
    return width;
}

template <class T>
double worst_imbalance(const T& topology, const Setting& setting, double diffusivity, double dt_yr,
                       const Heights& before, const Heights& after) {
    double worst = 0;
    for (Index node = 0; node < topology.size(); ++node) {
        if (setting.boundary[node] == Boundary::base_level || std::isnan(before[node])) continue;
        double balance = topology.area(node) * (after[node] - before[node]);
        topology.neighbors(node, [&](Index other, double length, Slot slot) {
            if (std::isnan(before[other])) return;
            const double slope = (after[node] - after[other]) / length;
            balance += dt_yr * diffusivity * slope * face_width(topology, node, slot);
        });
        worst = std::max(worst, std::abs(balance) / topology.area(node));
    }
    return worst;
}

/// As diffuse, with the balance of every step looked at.
template <class T>
HillslopeReport diffused(const T& topology, const Hillslope& hillslope, const Setting& setting, double dt_yr,
                         Landscape& landscape) {
    const Heights before = landscape.elevation_m;
    const HillslopeReport report = diffuse(topology, hillslope, setting, dt_yr, landscape);
    CAPTURE(dt_yr, hillslope.critical_slope, report.diffused_m3, report.newton_iterations, report.linear_iterations);
    CHECK(report.converged);
    double stored = 0, taken = 0;
    for (Index node = 0; node < topology.size(); ++node) {
        if (setting.boundary[node] == Boundary::base_level) CHECK(landscape.elevation_m[node] == before[node]);
        if (std::isnan(before[node])) continue;
        const double change = landscape.elevation_m[node] - before[node];
        stored += topology.area(node) * change;
        taken += topology.area(node) * std::max(0.0, -change);
    }
    CHECK(report.stored_m3 == Approx(stored).margin(1e-9 * taken));
    CHECK(report.moved_m3 == Approx(taken));
    CHECK(std::abs(report.diffused_m3 + report.stored_m3) <= 1e-10 * taken);
    return report;
}

/// Flux law of Roering et al. along a row of cells.
double row_imbalance(const Grid& row, const Hillslope& hillslope, double dt_yr, const Heights& before,
                     const Heights& after) {
    const double spacing = row.east_west[0];
    const auto flux = [&](Index i) {
        const double s = (after[i + 1] - after[i]) / spacing;
        const double ratio = s / hillslope.critical_slope;
        return -hillslope.diffusivity_m2_per_yr * s / (1 - ratio * ratio);
    };
    double worst = 0;
    for (Index i = 1; i < row.cols; ++i) {
        const double out = (i + 1 < row.cols ? flux(i) : 0) - flux(i - 1);
        worst = std::max(worst, std::abs(after[i] - before[i] + dt_yr * out / spacing));
    }
    return worst;
}

}  // namespace

TEST_CASE("One linear step of a chain of three cells is what one computes by hand") {
    // Cells of 10 m, r = D·dt/dx² = 1, west end at base level 0, the east end closed:
    // 3x − y = 5, −x + 2y = 11 gives x = 21/5, y = 38/5. The outlet receives D·dt/dx·dy·x = 100 m²·x.
    const Grid grid = plane_grid(1, 3, 10, 10);
    Setting setting = support::island(grid, 0);
    setting.boundary = {Boundary::base_level, Boundary::interior, Boundary::interior};
    Landscape landscape{.elevation_m = {0, 5, 11}};
    const HillslopeReport report = diffused(grid, {.diffusivity_m2_per_yr = 0.01}, setting, 1e4, landscape);
    CHECK(landscape.elevation_m[1] == Approx(4.2).epsilon(1e-14));
    CHECK(landscape.elevation_m[2] == Approx(7.6).epsilon(1e-14));
    CHECK(report.diffused_m3 == Approx(420).epsilon(1e-13));
    CHECK(report.moved_m3 == Approx(100 * (0.8 + 3.4)));
    CHECK(report.steepest_slope == Approx(0.42));
    CHECK(landscape.time_yr == 0);
}

TEST_CASE("Every node of a linear step balances its faces, on grids with unequal spacings and on a mesh, whatever dt") {
    const auto check = [](const auto& topology, std::uint64_t seed) {
        const Setting setting = support::island(topology, 0);
        for (const double dt_yr : {1.0, 1e4, 1e6, 1e9}) {
            Landscape landscape = support::rough_start(setting, 100, seed);
            const Heights before = landscape.elevation_m;
            diffused(topology, {.diffusivity_m2_per_yr = 0.02}, setting, dt_yr, landscape);
            const double scale = std::max(1.0, dt_yr * 0.02 / 1e4);
            CHECK(worst_imbalance(topology, setting, 0.02, dt_yr, before, landscape.elevation_m) < 1e-10 * scale);
        }
    };
    for (const std::uint64_t seed : {1, 2, 3}) {
        check(plane_grid(24, 31, 100, 130), seed);
        check(tapering_grid(30, 20), seed);
        check(support::lattice_mesh(25, 25, 120, 0.15, seed), seed);
    }
}

TEST_CASE("Open sides and holes without data let nothing pass") {
    const Grid grid = tapering_grid(20, 25);
    Setting setting = support::island(grid, 0);
    for (Index node = 0; node < grid.size(); ++node) {
        setting.boundary[node] = grid.col(node) == 0 ? Boundary::base_level : Boundary::interior;
    }
    Landscape landscape = support::rough_start(setting, 100, 5);
    for (const Index node : {30U, 31U, 57U, 212U, 499U}) {
        landscape.elevation_m[node] = std::numeric_limits<double>::quiet_NaN();
    }
    const Heights before = landscape.elevation_m;
    for (const double critical : {0.0, 1.2}) {
        Landscape now = landscape;
        diffused(grid, {.diffusivity_m2_per_yr = 0.02, .critical_slope = critical}, setting, 1e5, now);
        CHECK(std::isnan(now.elevation_m[57]));
        if (critical == 0) CHECK(worst_imbalance(grid, setting, 0.02, 1e5, before, now.elevation_m) < 1e-9);
    }
    setting.boundary.assign(grid.size(), Boundary::interior);
    for (const double critical : {0.0, 1.2}) {
        Landscape now = landscape;
        const HillslopeReport shut =
            diffused(grid, {.diffusivity_m2_per_yr = 0.02, .critical_slope = critical}, setting, 1e9, now);
        CHECK(shut.diffused_m3 == 0);
        CHECK(shut.steepest_slope < 1e-3);
    }
}

TEST_CASE("Linear diffusion makes no height that lay outside the old ones") {
    const Grid grid = plane_grid(40, 40, 90, 110);
    const Mesh mesh = support::lattice_mesh(40, 40, 100, 0.1, 1);
    const auto check = [](const auto& topology) {
        const Setting setting = support::island(topology, 0);
        for (const double dt_yr : {10.0, 1e5, 1e8}) {
            Landscape landscape = support::rough_start(setting, 100, 9);
            const auto [low, high] = std::ranges::minmax(landscape.elevation_m);
            diffused(topology, {.diffusivity_m2_per_yr = 0.02}, setting, dt_yr, landscape);
            const auto [lowest, highest] = std::ranges::minmax(landscape.elevation_m);
            CHECK(lowest >= low - 1e-10);
            CHECK(highest <= high + 1e-10);
        }
    };
    check(grid);
    check(mesh);
}

TEST_CASE(
    "Every cell of a row obeys the nonlinear law at the end of the step, from gentle and from impossible slopes") {
    const Grid row = plane_grid(1, 60, 10, 10);
    Setting setting = support::island(row, 0);
    setting.boundary.assign(60, Boundary::interior);
    setting.boundary[0] = Boundary::base_level;
    const Hillslope hillslope{.diffusivity_m2_per_yr = 0.01, .critical_slope = 0.8};
    for (const double height : {1.0, 20.0, 500.0, 2000.0}) {
        for (const double dt_yr : {100.0, 1e4, 1e6, 1e9}) {
            Landscape landscape = support::rough_start(setting, height, 3);
            const Heights before = landscape.elevation_m;
            const HillslopeReport report = diffused(row, hillslope, setting, dt_yr, landscape);
            CAPTURE(height, dt_yr, report.newton_iterations, report.steepest_slope);
            CHECK(report.steepest_slope < 0.8);
            CHECK(row_imbalance(row, hillslope, dt_yr, before, landscape.elevation_m) < 1e-5 * height);
        }
    }
}

TEST_CASE("No slope passes the critical one after a step, between no two neighbours, whatever dt and however rough") {
    const auto check = [](const auto& topology, std::uint64_t seed) {
        const Setting setting = support::island(topology, 0);
        const Hillslope hillslope{.diffusivity_m2_per_yr = 0.01, .critical_slope = 0.6};
        for (const double amplitude : {10.0, 300.0, 3000.0}) {
            for (const double dt_yr : {1e3, 1e5, 1e8}) {
                Landscape landscape = support::rough_start(setting, amplitude, seed);
                const HillslopeReport report = diffused(topology, hillslope, setting, dt_yr, landscape);
                CHECK(report.newton_iterations < 80);
                CHECK(report.steepest_slope < 0.6);
                for (Index node = 0; node < topology.size(); ++node) {
                    topology.neighbors(node, [&](Index other, double length, Slot) {
                        const double drop = std::abs(landscape.elevation_m[node] - landscape.elevation_m[other]);
                        CHECK(drop < 0.6 * length);
                    });
                }
            }
        }
    };
    check(plane_grid(20, 23, 100, 80), 1);
    check(tapering_grid(20, 15), 2);
    check(support::lattice_mesh(20, 20, 100, 0.2, 3), 3);
}

TEST_CASE("A critical slope far above all slopes makes no difference") {
    const Mesh mesh = support::lattice_mesh(20, 20, 100, 0.2, 3);
    const Grid grid = plane_grid(20, 20, 100, 90);
    const auto check = [](const auto& topology) {
        const Setting setting = support::island(topology, 0);
        Landscape linear = support::rough_start(setting, 1, 1);
        Landscape steep = linear;
        diffused(topology, {.diffusivity_m2_per_yr = 0.01}, setting, 1e6, linear);
        diffused(topology, {.diffusivity_m2_per_yr = 0.01, .critical_slope = 1e4}, setting, 1e6, steep);
        for (Index node = 0; node < topology.size(); ++node) {
            CHECK(std::abs(linear.elevation_m[node] - steep.elevation_m[node]) < 1e-9);
        }
    };
    check(mesh);
    check(grid);
}

TEST_CASE("A step back in space gives the same landscape: mirrored rows and columns") {
    const Grid grid = plane_grid(21, 18, 100, 70);
    const Setting setting = support::island(grid, 0);
    for (const double critical : {0.0, 0.9}) {
        Landscape a = support::rough_start(setting, 200, 4);
        Landscape b = a;
        std::ranges::reverse(b.elevation_m);
        const Hillslope hillslope{.diffusivity_m2_per_yr = 0.01, .critical_slope = critical};
        diffused(grid, hillslope, setting, 1e5, a);
        diffused(grid, hillslope, setting, 1e5, b);
        std::ranges::reverse(b.elevation_m);
        for (Index node = 0; node < grid.size(); ++node) {
            CHECK(std::abs(a.elevation_m[node] - b.elevation_m[node]) < 1e-7);
        }
    }
}

TEST_CASE("In metres and years or kilometres and thousands of years diffusion does the same") {
    // h' = h/1000, t' = t/1000, D' = D·1e-6·1e3.
    const Grid metres = plane_grid(30, 30, 512, 512);
    const Grid kilometres = plane_grid(30, 30, 0.512, 0.512);
    const Setting setting = support::island(metres, 0);
    for (const double critical : {0.0, 0.5}) {
        Landscape a = support::rough_start(setting, 400, 7);
        Landscape b = a;
        for (double& height : b.elevation_m) height /= 1000;
        diffused(metres, {.diffusivity_m2_per_yr = 0.05, .critical_slope = critical}, setting, 5e5, a);
        diffused(kilometres, {.diffusivity_m2_per_yr = 5e-5, .critical_slope = critical}, setting, 500, b);
        for (Index node = 0; node < metres.size(); ++node) {
            CHECK(std::abs(a.elevation_m[node] - 1000 * b.elevation_m[node]) < 1e-6);
        }
    }
}

TEST_CASE("Diffusion gives the same bytes for one thread, two threads and a solver that has stepped before") {
    const Grid grid = plane_grid(150, 170, 50, 60);  // several pieces of work
    const Setting setting = support::island(grid, 0);
    for (const double critical : {0.0, 0.7}) {
        const Hillslope hillslope{.diffusivity_m2_per_yr = 0.02, .critical_slope = critical};
        const auto run = [&](int threads) {
            const ThreadLimit limit(threads);
            Landscape landscape = support::rough_start(setting, 20, 9);
            HillslopeSolver solver(grid, hillslope, setting);
            solver.step(2e4, landscape);
            solver.step(5e4, landscape);
            return landscape.elevation_m;
        };
        const auto once = run(1);
        CHECK(run(2) == once);
        Landscape apart = support::rough_start(setting, 20, 9);
        diffuse(grid, hillslope, setting, 2e4, apart);
        diffuse(grid, hillslope, setting, 5e4, apart);
        CHECK(apart.elevation_m == once);
    }
}

TEST_CASE("The number of iterations hardly grows with the number of nodes, however long the step") {
    int small = 0;
    for (const Index size : {50U, 150U, 400U}) {
        const Grid grid = plane_grid(size, size, 100, 100);
        const Setting setting = support::island(grid, 0);
        Landscape landscape = support::rough_start(setting, 100, 9);
        const HillslopeReport report = diffuse(grid, {.diffusivity_m2_per_yr = 0.01}, setting, 1e12, landscape);
        CAPTURE(size, report.linear_iterations);
        if (small == 0) small = report.linear_iterations;
        CHECK(report.linear_iterations <= 2 * small);
        CHECK(report.linear_iterations < 60);
    }
}

TEST_CASE("Where base-level heights force slopes beyond the critical one, only there is it passed") {
    // A rim with a cliff in it: 0 m in the west, 100 m in the east.
    const Grid grid = plane_grid(20, 20, 10, 10);
    const Setting setting = support::island(grid, 0);
    Landscape landscape = support::rough_start(setting, 300, 1);
    for (Index node = 0; node < grid.size(); ++node) {
        if (setting.boundary[node] == Boundary::base_level && grid.col(node) >= 10) landscape.elevation_m[node] = 100;
    }
    for (const double dt_yr : {1e3, 1e5, 1e9}) {
        Landscape now = landscape;
        const HillslopeReport report =
            diffused(grid, {.diffusivity_m2_per_yr = 0.01, .critical_slope = 1}, setting, dt_yr, now);
        CHECK(report.steepest_slope > 9);
        for (Index node = 0; node < grid.size(); ++node) {
            const Index from_cliff = grid.col(node) < 10 ? 9 - grid.col(node) : grid.col(node) - 10;
            if (from_cliff < 6) continue;
            grid.neighbors(node, [&](Index other, double length, Slot) {
                CHECK(std::abs(now.elevation_m[node] - now.elevation_m[other]) < length);
            });
        }
    }
}

TEST_CASE("Without diffusivity nothing happens, and numbers without meaning are refused in a sentence") {
    const Grid grid = plane_grid(5, 5, 10, 10);
    const Setting setting = support::island(grid, 0);
    Landscape landscape = support::rough_start(setting, 100, 1);
    const Heights before = landscape.elevation_m;
    CHECK(diffuse(grid, {}, setting, 1e4, landscape).moved_m3 == 0);
    CHECK(landscape.elevation_m == before);
    CHECK_THROWS_AS(diffuse(grid, {.diffusivity_m2_per_yr = -1}, setting, 1, landscape), Error);
    CHECK_THROWS_AS(diffuse(grid, {.diffusivity_m2_per_yr = 1, .critical_slope = -1}, setting, 1, landscape), Error);
    CHECK_THROWS_AS(diffuse(grid, {.diffusivity_m2_per_yr = 1}, setting, 0, landscape), Error);
    landscape.elevation_m.pop_back();
    CHECK_THROWS_AS(diffuse(grid, {.diffusivity_m2_per_yr = 1}, setting, 1, landscape), Error);
}

TEST_CASE("A run with rivers and creep is its processes one by one, and its mass balance closes") {
    const Mesh mesh = support::lattice_mesh(20, 20, 100, 0.2, 1);
    const Grid grid = plane_grid(20, 22, 100, 80);
    const auto check = [](const auto& topology, const Model& model) {
        const Setting setting = support::island(topology, 1e-3);
        Landscape run = support::rough_start(setting, 5, 1);
        Landscape by_hand = run;
        const SimulationResult result =
            simulate(topology, model, setting, {.step_yr = 2e4, .max_steps = 12, .convergence = 0}, run);
        MassBalance mass;
        double change = 0;
        for (int i = 0; i < 12; ++i) {
            const Heights before = by_hand.elevation_m;
            const Drainage drainage = drain(topology, by_hand, setting, model.river.receiver);
            mass.eroded_m3 += erode(topology, drainage, model.river, setting, 2e4, by_hand).mass.eroded_m3;
            mass.diffused_m3 += diffuse(topology, model.hillslope, setting, 2e4, by_hand).diffused_m3;
            change = 0;
            for (Index node = 0; node < topology.size(); ++node) {
                change = std::max(change, std::abs(by_hand.elevation_m[node] - before[node]));
            }
        }
        CHECK(run.elevation_m == by_hand.elevation_m);
        CHECK(result.mass.eroded_m3 == Approx(mass.eroded_m3).epsilon(1e-12));
        CHECK(result.mass.diffused_m3 == Approx(mass.diffused_m3).epsilon(1e-12));
        CHECK(result.mass.diffused_m3 > 0);
        CHECK(result.mass.exported_m3 ==
              Approx(result.mass.eroded_m3 + result.mass.talus_m3 + result.mass.diffused_m3).epsilon(1e-12));
        CHECK(std::abs(result.mass.relative_residual()) < 1e-12);
        CHECK(result.max_rate_m_per_yr == change / 2e4);
        CHECK(result.largest_hillslope_iterations >= 1);
        CHECK(result.unconverged_hillslope_steps == 0);
    };
    for (const double critical : {0.0, 0.4}) {
        const Model model{.river = {.k = 1e-5, .m = 0.5, .n = 1.2, .talus_slope = 0.9},
                          .hillslope = {.diffusivity_m2_per_yr = 0.05, .critical_slope = critical}};
        check(mesh, model);
        check(grid, model);
    }
}

TEST_CASE("A ridge without rivers comes to rest on the parabola u(L² − x²)/(2D), in one long step or in many") {
    // Rows of cells between two walls of base level at x = ±L: on the nodes the parabola is exact.
    const double spacing = 10, length = 300, uplift = 1e-3, diffusivity = 0.02;
    const Grid grid = plane_grid(5, 61, spacing, 25);
    Setting setting = support::island(grid, uplift);
    for (Index node = 0; node < grid.size(); ++node) {
        const bool wall = grid.col(node) == 0 || grid.col(node) == 60;
        setting.boundary[node] = wall ? Boundary::base_level : Boundary::interior;
    }
    const Model model{.river = {.k = 0}, .hillslope = {.diffusivity_m2_per_yr = diffusivity}};
    for (const double dt_yr : {1e10, 1e6}) {
        Landscape landscape = support::rough_start(setting, 1, 1);
        const SimulationResult result =
            simulate(grid, model, setting, {.step_yr = dt_yr, .max_steps = 3000, .convergence = 1e-9}, landscape);
        CHECK(result.stop_reason == StopReason::converged);
        for (Index node = 0; node < grid.size(); ++node) {
            const double x = spacing * grid.col(node) - length;
            const double exact = uplift * (length * length - x * x) / (2 * diffusivity);
            CHECK(std::abs(landscape.elevation_m[node] - exact) < 1e-6 * exact + 1e-9);
        }
    }
}
