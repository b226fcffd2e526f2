// SPDX-License-Identifier: GPL-3.0-or-later
// Nothing depends on where north is or on the unit of length: one step from a surface without ties turned and mirrored
// comes out turned and mirrored, whole runs do so as ensembles.
#include <fmt/format.h>

#include <catch2/catch.hpp>
#include <cmath>
#include <map>

#include "landscapes.hpp"
#include "series.hpp"
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

evolve::Landscape after_one_step(const Grid& grid, const evolve::Model& model, const evolve::Setting& setting,
                                 evolve::Landscape landscape) {
    evolve::simulate(grid, model, setting, {.step_yr = 2e4, .max_steps = 1, .convergence = 0}, landscape);
    return landscape;
}

/// Every process alone and together, by name.
std::map<std::string, evolve::Model> models(double n, double talus_slope) {
    const evolve::River river{.k = 1e-3 / std::pow(0.05 * 300, n), .m = 0.5 * n, .n = n};
    evolve::Model talus{river}, sediment{river}, divided{river}, creep{river}, all{river};
    talus.river.talus_slope = all.river.talus_slope = talus_slope;
    sediment.river.g = all.river.g = 1;
    divided.river.flow = all.river.flow = evolve::Flow::multiple;
    creep.hillslope.diffusivity_m2_per_yr = all.hillslope.diffusivity_m2_per_yr = 0.02;
    return {{"rivers", {river}},       {"talus", talus}, {"sediment", sediment},
            {"divided flow", divided}, {"creep", creep}, {"all", all}};
}

/// Largest difference between a step from a moved start and the moved result of a step, relative to the height or 1 m,
/// over the square's seven symmetries.
double worst_of_one_step(const Grid& grid, const evolve::Model& model, const evolve::Setting& setting) {
    const auto start = support::rough_start(setting, 50, 11);
    const auto plain = after_one_step(grid, model, setting, start);
    double worst = 0;
    for (int symmetry = 1; symmetry < 8; ++symmetry) {
        evolve::Setting turned = setting;
        turned.boundary = moved_values(setting.boundary, symmetry);
        turned.rainfall = moved_values(setting.rainfall, symmetry);
        const auto there =
            after_one_step(grid, model, turned, {.elevation_m = moved_values(start.elevation_m, symmetry)});
        const auto expected = moved_values(plain.elevation_m, symmetry);
        for (Index node = 0; node < grid.size(); ++node) {
            const double off = std::abs(there.elevation_m[node] - expected[node]);
            worst = std::max(worst, off / std::max(1.0, std::abs(expected[node])));
        }
    }
    return worst;
}

struct Shape {
    double mean_m, highest_m, integral;
};

Shape run_to_rest(const Grid& grid, const evolve::Setting& setting, evolve::Landscape landscape) {
    const evolve::River law{.k = 2e-6, .m = 0.5, .n = 1};
    evolve::simulate(grid, {law}, setting, {.step_yr = 1e5, .max_steps = 2000}, landscape);
    const auto h = terrain::hypsometry(landscape.elevation_m, terrain::cell_areas(grid));
    return {h.mean_m, h.maximum_m, h.integral};
}

struct Ensemble {
    std::vector<double> mean_m, highest_m, integral;

    void add(const Shape& shape) {
        mean_m.push_back(shape.mean_m);
        highest_m.push_back(shape.highest_m);
        integral.push_back(shape.integral);
    }
};

}  // namespace

TEST_CASE("One step from a surface without ties commutes with the square's eight symmetries, whatever the outlets") {
    const Grid grid = plane_grid(across, across, 100, 100);
    Categories errors;
    for (const auto& [name, boundary] : boundaries(grid)) {
        evolve::Setting setting = support::island(grid, 1e-3);
        setting.boundary = boundary;
        for (Index node = 0; node < grid.size(); ++node) setting.rainfall[node] = 0.5 + uniform_at(3, 1, node);
        for (const double n : {0.7, 1.0, 2.0}) {
            for (const auto& [process, model] : models(n, 0.2)) {
                const double worst = worst_of_one_step(grid, model, setting);
                INFO(name << ", " << process << ", n " << n);
                CHECK(worst < 1e-12);
                errors.add(fmt::format("{}, {}", name, process), worst);
            }
        }
    }
    for (const auto& [name, values] : errors.all()) {
        fmt::print("one step turned, {:32} worst {:.1e}\n", name, *std::max_element(values.begin(), values.end()));
    }
    write_series("one_step_turned", errors);
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
    for (Index node = 0; node < plain.size(); ++node)
        place.push_back(at.at(key(side_m - plain.y[node], plain.x[node])));

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

TEST_CASE(
    "Whole runs from turned and mirrored starts differ by no more than runs from other seeds, whatever the outlets") {
    const Grid grid = plane_grid(across, across, 250, 250);
    Categories differences;
    for (const auto& [name, boundary] : boundaries(grid)) {
        if (name == "open rim") continue;  // where water leaves at an open rim nothing digs: it rises for ever
        Ensemble plain, turned;
        for (std::uint64_t seed = 0; seed < 8; ++seed) {
            const int symmetry = 1 + static_cast<int>(seed % 7);
            evolve::Setting setting = support::island(grid, 1e-3);
            setting.boundary = boundary;
            const auto start = support::rough_start(setting, 1, seed);
            plain.add(run_to_rest(grid, setting, start));
            setting.boundary = moved_values(boundary, symmetry);
            turned.add(run_to_rest(grid, setting, {.elevation_m = moved_values(start.elevation_m, symmetry)}));
        }
        const auto check = [&](const char* what, const std::vector<double>& a, const std::vector<double>& b) {
            const double off = std::abs(mean(a) - mean(b)) / standard_deviation(a);
            fmt::print("turned runs, {:16} {:9}: {:.6g} and {:.6g}, {:.1e} of the scatter\n", name, what, mean(a),
                       mean(b), off);
            CHECK(off < 1);
            differences.add(name, off);
        };
        check("mean", plain.mean_m, turned.mean_m);
        check("highest", plain.highest_m, turned.highest_m);
        check("integral", plain.integral, turned.integral);
    }
    write_series("turned_runs", differences);
}

namespace {

Grid in_kilometres(const Grid& grid) { return plane_grid(grid.rows, grid.cols, 0.25, 0.25); }

Mesh in_kilometres(Mesh mesh) {
    for (auto* lengths : {&mesh.x, &mesh.y, &mesh.length_list}) {
        for (double& length : *lengths) length /= 1e3;
    }
    for (double& area : mesh.cell_area) area /= 1e6;
    return mesh;
}

/// Largest difference between a run in m and yr and one in km and kyr, over the relief.
template <class Topology>
double worst_of_units(const Topology& metres, const evolve::Model& model) {
    const Topology kilometres = in_kilometres(metres);
    const evolve::Setting setting = support::island(metres, 1e-3);
    evolve::Model scaled = model;  // m/yr is km/kyr; areas are in km², so k' = k·(10⁶)^m and D' = D·10³/10⁶
    scaled.river.k *= std::pow(1e6, model.river.m);
    scaled.hillslope.diffusivity_m2_per_yr *= 1e-3;
    evolve::Landscape a = support::rough_start(setting, 1, 2), b = a;
    for (double& height : b.elevation_m) height /= 1000;
    evolve::simulate(metres, model, setting, {.step_yr = 5e4, .max_steps = 30, .convergence = 0}, a);
    evolve::simulate(kilometres, scaled, setting, {.step_yr = 50, .max_steps = 30, .convergence = 0}, b);
    double worst = 0, highest = 0;
    for (Index node = 0; node < metres.size(); ++node) {
        worst = std::max(worst, std::abs(a.elevation_m[node] - 1000 * b.elevation_m[node]));
        highest = std::max(highest, a.elevation_m[node]);
    }
    return worst / highest;
}

}  // namespace

TEST_CASE("A whole run in kilometres and thousands of years is the same landscape, whatever the processes") {
    const Grid grid = plane_grid(across, across, 250, 250);
    const Mesh mesh = island_mesh(1600, 6);
    Categories errors;
    for (const auto& [process, model] : models(1.3, 0.04)) {
        errors.add("TIN, " + process, worst_of_units(mesh, model));
        // Slopes at one limit are alike on a raster's faces: which of them a node follows is then left to rounding.
        if (process != "talus") errors.add("raster, " + process, worst_of_units(grid, model));
    }
    for (const auto& [name, worst] : errors.all()) {
        fmt::print("km and kyr, {:20}: worst {:.1e} of the relief\n", name, worst.front());
        CHECK(worst.front() < 1e-9);
    }
    write_series("kilometres", errors);
}
