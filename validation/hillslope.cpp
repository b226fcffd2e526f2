// SPDX-License-Identifier: GPL-3.0-or-later
// Creep against mathematics: steady profiles, linear and with a critical slope, and a spreading Gaussian, on rasters
// and on TINs, refined to show the order in space.
#include <fmt/format.h>

#include <catch2/catch.hpp>
#include <cmath>
#include <functional>

#include "landscapes.hpp"
#include "series.hpp"
#include "thalweg/evolve/hillslope.hpp"

using namespace thalweg;
using namespace thalweg::validation;

namespace {

using Height = std::function<double(double x, double y)>;

struct Domain {
    double width, height;  // m
};

/// Cell centres of a grid: its outer ring lies half a cell inside.
struct Raster {
    Grid grid;
    double dx, dy;
    double x(Index node) const { return dx * grid.col(node); }
    double y(Index node) const { return dy * grid.row(node); }
};

Raster raster_over(const Domain& domain, Index cols, Index rows) {
    const double dx = domain.width / (cols - 1), dy = domain.height / (rows - 1);
    return {plane_grid(rows, cols, dx, dy), dx, dy};
}

struct Tin {
    Mesh grid;
    double x(Index node) const { return grid.x[node]; }
    double y(Index node) const { return grid.y[node]; }
};

Tin tin_over(const Domain& domain, Index nodes) {
    const Polygon outline{{0, 0}, {domain.width, 0}, {domain.width, domain.height}, {0, domain.height}};
    return {mesh::triangulate(outline, mesh::poisson_disk_count(outline, nodes, 5))};
}

/// Root of the mean square of the error over the nodes that move, weighted by area.
template <class Surface>
double error(const Surface& surface, const evolve::Setting& setting, const std::vector<double>& z,
             const Height& exact) {
    double sum = 0, area = 0;
    for (Index node = 0; node < surface.grid.size(); ++node) {
        if (setting.boundary[node] == Boundary::base_level) continue;
        const double difference = z[node] - exact(surface.x(node), surface.y(node));
        sum += surface.grid.area(node) * difference * difference;
        area += surface.grid.area(node);
    }
    return std::sqrt(sum / area);
}

/// Steps of uplift and creep until nothing moves; the outline is held at the exact heights.
template <class Surface>
double steady_error(const Surface& surface, const evolve::Hillslope& hillslope, double uplift, double dt_yr,
                    const Height& exact) {
    evolve::Setting setting = support::island(surface.grid, uplift);
    evolve::Landscape landscape;
    for (Index node = 0; node < surface.grid.size(); ++node) {
        const bool held = setting.boundary[node] == Boundary::base_level;
        landscape.elevation_m.push_back(held ? exact(surface.x(node), surface.y(node)) : 0);
    }
    evolve::HillslopeSolver solver(surface.grid, hillslope, setting);
    double largest = 1;
    for (int step = 0; step < 60 && largest > 1e-9; ++step) {
        const std::vector<double> before = landscape.elevation_m;
        for (Index node = 0; node < surface.grid.size(); ++node) {
            if (setting.boundary[node] != Boundary::base_level) landscape.elevation_m[node] += dt_yr * uplift;
        }
        CHECK(solver.step(dt_yr, landscape).converged);
        largest = 0;
        for (Index node = 0; node < surface.grid.size(); ++node) {
            largest = std::max(largest, std::abs(landscape.elevation_m[node] - before[node]));
        }
    }
    CHECK(largest < 1e-6);
    return error(surface, setting, landscape.elevation_m, exact);
}

/// Errors of one case at halved spacings, printed with the order between the first and the last.
void judge(const char* name, const std::vector<double>& errors, double least_order) {
    std::string list;
    for (const double e : errors) list += fmt::format(" {:.3e}", e);
    const double order = std::log2(errors.front() / errors.back()) / static_cast<double>(errors.size() - 1);
    fmt::print("{:34} errors (m){}, order {:.2f}\n", name, list, order);
    CHECK(order > least_order);
}

constexpr Domain oblong{400, 300};

void refine_steady(const char* name, const evolve::Hillslope& hillslope, double uplift, double dt_yr,
                   const Height& exact) {
    std::vector<double> on_raster, on_tin;
    for (const Index halving : {0U, 1U, 2U}) {
        const Index n = 16U << halving;
        on_raster.push_back(steady_error(raster_over(oblong, n + 1, n / 2 + 1), hillslope, uplift, dt_yr, exact));
        on_tin.push_back(steady_error(tin_over(oblong, 300U << (2 * halving)), hillslope, uplift, dt_yr, exact));
    }
    judge(fmt::format("{}, raster", name).c_str(), on_raster, 1.85);
    judge(fmt::format("{}, TIN", name).c_str(), on_tin, 1.7);
    write_series(
        hillslope.critical_slope > 0 ? "creep_critical" : "creep_linear",
        {{"cells_along", std::vector{16.0, 32.0, 64.0}}, {"raster_error_m", on_raster}, {"TIN_error_m", on_tin}});
}

}  // namespace

TEST_CASE("A steady dome of linear creep is reached at second order in space") {
    // ∇²z = −u/D with a harmonic part that no polynomial of low degree gives exactly.
    const double diffusivity = 0.02, uplift = 1e-4;
    const Height exact = [&](double x, double y) {
        const double dome = uplift * (4e4 - (x - 200) * (x - 200)) / (2 * diffusivity);
        return dome + 20 * std::exp(y / 150) * std::sin(x / 150);
    };
    refine_steady("linear, steady", {.diffusivity_m2_per_yr = diffusivity}, uplift, 1e9, exact);
}

TEST_CASE("The steady profile of creep with a critical slope is reached at second order in space") {
    // Roering et al. 2007: with b = u and x from the divide, S = Sc²/(2bx)·(√(D² + (2bx/Sc)²) − D), and its integral
    // z = −Sc²/(2b)·(√(D² + (2bx/Sc)²) − D·ln((√(D² + (2bx/Sc)²) + D)/(2b/Sc))) + constant. The divide runs obliquely.
    const double diffusivity = 0.01, critical = 1.25, uplift = 2e-4;
    const Height exact = [&](double x, double y) {
        const double along = ((x - 180) + 0.5 * (y - 140)) / std::sqrt(1.25);
        const double root = std::hypot(diffusivity, 2 * uplift * along / critical);
        return -critical * critical / (2 * uplift) *
               (root - diffusivity - diffusivity * std::log((root + diffusivity) / (2 * diffusivity)));
    };
    refine_steady("critical slope, steady", {.diffusivity_m2_per_yr = diffusivity, .critical_slope = critical}, uplift,
                  1e9, exact);
}

TEST_CASE("A Gaussian spreads as it should, at second order in space and first in time") {
    // z = s0²/s²·exp(−r²/(2s²)) with s² = s0² + 2Dt: variance grows by 2Dt in each direction.
    const Domain square{1000, 1000};
    const double diffusivity = 0.02, width0 = 60, time_yr = 2e5;
    const auto gaussian = [&](double t) {
        return [=](double x, double y) {
            const double square_width = width0 * width0 + 2 * diffusivity * t;
            const double r2 = (x - 500) * (x - 500) + (y - 480) * (y - 480);
            return 100 * width0 * width0 / square_width * std::exp(-r2 / (2 * square_width));
        };
    };
    const auto spread = [&](const auto& surface, int steps) {
        const evolve::Setting setting = support::island(surface.grid, 0);
        evolve::Landscape landscape;
        const Height start = gaussian(0);
        for (Index node = 0; node < surface.grid.size(); ++node) {
            landscape.elevation_m.push_back(start(surface.x(node), surface.y(node)));
        }
        evolve::HillslopeSolver solver(surface.grid, {.diffusivity_m2_per_yr = diffusivity}, setting);
        for (int step = 0; step < steps; ++step) solver.step(time_yr / steps, landscape);
        return error(surface, setting, landscape.elevation_m, gaussian(time_yr));
    };
    std::vector<double> on_raster, on_tin, in_time;
    for (const Index halving : {0U, 1U, 2U}) {
        const int steps = 32 << (2 * halving);  // dt falls with the square of the spacing, so that space decides
        on_raster.push_back(spread(raster_over(square, (24U << halving) + 1, (20U << halving) + 1), steps));
        on_tin.push_back(spread(tin_over(square, 600U << (2 * halving)), steps));
        in_time.push_back(spread(raster_over(square, 129, 129), 2 << halving));
    }
    judge("Gaussian, raster", on_raster, 1.9);
    judge("Gaussian, TIN", on_tin, 1.8);
    judge("Gaussian, in time", in_time, 0.8);
    write_series(
        "gaussian_in_space",
        {{"cells_along", std::vector{24.0, 48.0, 96.0}}, {"raster_error_m", on_raster}, {"TIN_error_m", on_tin}});
    write_series("gaussian_in_time", {{"steps", std::vector{2.0, 4.0, 8.0}}, {"raster_error_m", in_time}});
    CHECK(on_raster.back() < 0.02);
    CHECK(on_tin.back() < 0.05);
}
