// SPDX-License-Identifier: GPL-3.0-or-later
#include "thalweg/evolve/tectonics.hpp"

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <numbers>
#include <numeric>

#include "support/temp_folder.hpp"
#include "thalweg/core/random.hpp"

using namespace thalweg;
using namespace thalweg::evolve;

namespace {

constexpr Box box{{10, 0}, {30, 8}};  // 20 wide, 8 high

std::vector<double> values_at(const Shape& shape, const std::vector<Point>& points) {
    return pattern_values(shape, box, points);
}

/// Centres of the cells of a fine grid over the square [0, side]².
std::vector<Point> fine_grid(int count, double side) {
    std::vector<Point> points;
    for (int row = 0; row < count; ++row) {
        for (int col = 0; col < count; ++col)
            points.push_back({(col + 0.5) * side / count, (row + 0.5) * side / count});
    }
    return points;
}

double mean_of(const std::vector<double>& values) {
    return std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
}

/// Distance to the nearest segment of all lines, slowly.
double distance_to_lines(const std::vector<std::vector<Point>>& lines, const Point& p) {
    double nearest = std::numeric_limits<double>::infinity();
    for (const auto& line : lines) {
        for (std::size_t i = 0; i + 1 < line.size(); ++i) {
            const Point a = line[i], b = line[i + 1];
            const double length = std::hypot(b.x - a.x, b.y - a.y);
            const double along = ((p.x - a.x) * (b.x - a.x) + (p.y - a.y) * (b.y - a.y)) / length;
            const double off = std::abs((b.x - a.x) * (p.y - a.y) - (b.y - a.y) * (p.x - a.x)) / length;
            const double to_ends = std::min(std::hypot(p.x - a.x, p.y - a.y), std::hypot(p.x - b.x, p.y - b.y));
            nearest = std::min(nearest, along >= 0 && along <= length ? off : to_ends);
        }
    }
    return nearest;
}

}  // namespace

TEST_CASE("Patterns have their values by hand at chosen places") {
    const std::vector<Point> points{{10, 0}, {30, 8}, {20, 4}, {25, 4}, {20, 6}, {30, 4}, {29, 7}};
    CHECK(values_at({.pattern = Pattern::constant}, points) == std::vector<double>(7, 1.0));
    const auto gradient = [&](double direction) {
        return values_at({.pattern = Pattern::gradient, .direction_deg = direction}, points);
    };
    const auto check = [](const std::vector<double>& values, const std::vector<double>& expected) {
        for (std::size_t i = 0; i < expected.size(); ++i) CHECK(values[i] == Approx(expected[i]).margin(1e-12));
    };
    check(gradient(0), {0, 1, 0.5, 0.5, 0.75, 0.5, 0.875});    // northwards
    check(gradient(180), {1, 0, 0.5, 0.5, 0.25, 0.5, 0.125});  // southwards
    check(gradient(90), {0, 1, 0.5, 0.75, 0.5, 1, 0.95});      // eastwards
    check(gradient(270), {1, 0, 0.5, 0.25, 0.5, 0, 0.05});     // westwards
    check(gradient(45), {0, 1, 0.5, 0.5 + 5.0 / 28, 0.5 + 2.0 / 28, 0.5 + 10.0 / 28, 0.5 + 12.0 / 28});
    check(values_at({.pattern = Pattern::stepped, .direction_deg = 90, .steps = 4}, points),
          {0.25, 1, 0.75, 1, 0.75, 1, 1});
    check(values_at({.pattern = Pattern::stepped, .steps = 1}, points), std::vector<double>(7, 1.0));
    check(values_at({.pattern = Pattern::diamond}, points), {0, 0, 1, 0.5, 0.5, 0, 0});
    check(values_at({.pattern = Pattern::radial}, points), {0, 0, 1, 0, 0.5, 0, 0});
}

TEST_CASE("Patterns have the means that their integrals over the box say") {
    const Box square{{0, 0}, {100, 100}};
    const std::vector<Point> points = fine_grid(400, 100);
    const auto mean = [&](const Shape& shape) { return mean_of(pattern_values(shape, square, points)); };
    CHECK(mean({.pattern = Pattern::gradient, .direction_deg = 30}) == Approx(0.5).epsilon(1e-9));
    CHECK(mean({.pattern = Pattern::stepped, .steps = 5}) == Approx(0.6).epsilon(1e-9));  // mean of 0.2, 0.4 … 1
    CHECK(mean({.pattern = Pattern::diamond}) == Approx(1.0 / 6).epsilon(1e-4));          // a pyramid's third of half
    CHECK(mean({.pattern = Pattern::radial}) == Approx(std::numbers::pi / 12).epsilon(1e-4));  // a cone's third
}

TEST_CASE("Every noise fills 0 to 1, whatever the places asked for, and depends on seed, kind and scale") {
    const Box square{{0, 0}, {1000, 1000}};
    const std::vector<Point> fine = fine_grid(200, 1000), few = fine_grid(11, 1000);
    std::vector<std::vector<double>> seen;
    for (const auto variant : {NoiseVariant::fbm, NoiseVariant::billow, NoiseVariant::ridge, NoiseVariant::warped}) {
        const Shape shape{.pattern = Pattern::noise, .variant = variant, .seed = 3};
        const auto values = pattern_values(shape, square, fine);
        CHECK(*std::min_element(values.begin(), values.end()) >= 0);
        CHECK(*std::max_element(values.begin(), values.end()) <= 1);
        CHECK(*std::min_element(values.begin(), values.end()) < 0.03);
        CHECK(*std::max_element(values.begin(), values.end()) > 0.97);
        // One place alone has the value that it has among many.
        const auto among_few = pattern_values(shape, square, few);
        for (std::size_t i = 0; i < few.size(); ++i) {
            CHECK(pattern_values(shape, square, std::vector<Point>{few[i]})[0] == among_few[i]);
        }
        for (const auto& other : seen) CHECK(other != values);
        seen.push_back(values);
        Shape changed = shape;
        changed.seed = 4;
        CHECK(pattern_values(changed, square, fine) != values);
        changed = shape;
        changed.noise_scale = 8;
        CHECK(pattern_values(changed, square, fine) != values);
    }
    // Ridges are billows turned upside down.
    for (std::size_t i = 0; i < fine.size(); ++i) CHECK(seen[1][i] == Approx(1 - seen[2][i]).margin(1e-12));
}

TEST_CASE("A painted corridor has the area and the mean depth that its cross-section says") {
    // A straight line of 60 m, 10 m wide, in the middle of 100 m x 100 m: (1 − t²)² has the mean 8/15 across the
    // corridor and 1/3 over the discs at its ends.
    const std::vector<Corridor> corridors{{{{{20, 50}, {80, 50}}}, 10, 0.25}};
    const std::vector<Point> points = fine_grid(1000, 100);
    const std::vector<double> values = corridor_values(corridors, points);
    const double cell = 0.01;
    double area = 0, missing = 0;
    for (const double value : values) {
        area += cell * (value < 1);
        missing += cell * (1 - value);
    }
    CHECK(area == Approx(60 * 10 + std::numbers::pi * 25).epsilon(2e-3));
    CHECK(missing == Approx(0.75 * (60 * 10 * 8.0 / 15 + std::numbers::pi * 25 / 3)).epsilon(1e-3));
    CHECK(*std::min_element(values.begin(), values.end()) == Approx(0.25).epsilon(1e-3));
    CHECK(*std::max_element(values.begin(), values.end()) == 1);
}

TEST_CASE("Corridors of random lines are those of their definition, also outside the domain and with many pieces") {
    for (std::uint64_t seed = 0; seed < 30; ++seed) {
        Random random(seed, 1);
        const auto place = [&] { return Point{200 * random.uniform() - 50, 200 * random.uniform() - 50}; };
        std::vector<Corridor> corridors;
        for (int c = 0; c < 3; ++c) {
            Corridor corridor{.lines = {}, .width_m = 0.5 + 40 * random.uniform(), .value = 3 * random.uniform()};
            for (int l = 0; l < 4; ++l) corridor.lines.push_back({place(), place(), place()});
            corridors.push_back(corridor);
        }
        std::vector<Point> points;
        for (int i = 0; i < 500; ++i) points.push_back({100 * random.uniform(), 100 * random.uniform()});
        const auto values = corridor_values(corridors, points);
        double largest = 1;
        for (const Corridor& c : corridors) largest = std::max(largest, c.value);
        for (std::size_t i = 0; i < points.size(); ++i) {
            double low = 1, high = 1;
            for (const Corridor& c : corridors) {
                const double t = distance_to_lines(c.lines, points[i]) / (c.width_m / 2);
                const double value = t < 1 ? 1 + (c.value - 1) * (1 - t * t) * (1 - t * t) : 1;
                (value < 1 ? low : high) = value < 1 ? std::min(low, value) : std::max(high, value);
            }
            REQUIRE(values[i] == Approx(low * high / largest).epsilon(1e-9).margin(1e-12));
        }
    }
}

TEST_CASE("A ridge above 1 stands at the maximum and lowers what lies beside it") {
    const std::vector<Point> points{{5, 5}, {5, 9}, {1, 1}};
    const auto values = corridor_values(std::vector<Corridor>{{{{{5, 0}, {5, 6}}}, 2, 4}}, points);
    CHECK(values == std::vector<double>{1, 0.25, 0.25});
}

TEST_CASE("Shapes and corridors that make no sense are refused") {
    const std::vector<Point> points{{5, 5}, {6, 6}};
    const auto refuses = [](auto call) {
        const auto error = test::error_of(call);
        CHECK(test::is_sentence(error));
    };
    refuses([&] { values_at({.pattern = Pattern::stepped, .steps = 0}, points); });
    refuses([&] { values_at({.pattern = Pattern::noise, .noise_scale = 0}, points); });
    refuses([&] { corridor_values(std::vector<Corridor>{{{}, 0, 1}}, points); });
    refuses([&] { corridor_values(std::vector<Corridor>{{{}, 1, -1}}, points); });
    refuses([&] { corridor_values(std::vector<Corridor>{{{}, 1, std::nan("")}}, points); });
    refuses([&] { bounding_box({}); });
}
