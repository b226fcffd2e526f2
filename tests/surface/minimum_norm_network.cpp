// SPDX-License-Identifier: GPL-3.0-or-later
#include "thalweg/surface/minimum_norm_network.hpp"

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <cstring>
#include <limits>
#include <set>

#include "support/tension_surfaces.hpp"
#include "thalweg/core/error.hpp"
#include "thalweg/core/parallel.hpp"
#include "thalweg/surface/tension_spline.hpp"

using namespace thalweg;
using namespace thalweg::surface;
using namespace support;

namespace {

/// One side of a triangle with the integrals of its energy a² pp + 2 a c pq + c² pp, by quadrature.
struct Side {
    Index from, to;
    double x, y, chord;  ///< direction, slope
    double pp, pq;
};

double tension_between(const TensionSurface& s, Index a, Index b) {
    double tension = (s.tension[a] + s.tension[b]) / 2;
    for (const ExtraTension& extra : s.extra) {
        if (std::min(extra.a, extra.b) == a && std::max(extra.a, extra.b) == b) tension += extra.tension;
    }
    return tension;
}

/// F″ from the slopes at the ends of each piece, F′ in its middle.
void integrate(Side& side, double tension, double length) {
    constexpr int pieces = 5000;
    const double h = 1.0 / pieces;
    for (int i = 0; i < pieces; ++i) {
        const auto bend = [&](auto slope) { return (slope((i + 1) * h) - slope(i * h)) / (h * length); };
        const auto stretch = [&](auto slope) { return tension / length * slope((i + 0.5) * h); };
        const auto first = [&](double b) { return tension_shape(tension, b).slope; };
        const auto second = [&](double b) { return tension_shape(tension, 1 - b).slope; };
        side.pp += (bend(first) * bend(first) + stretch(first) * stretch(first)) * h * length;
        side.pq += (bend(first) * bend(second) + stretch(first) * stretch(second)) * h * length;
    }
}

std::vector<Side> sides_of(const TensionSurface& s) {
    std::set<std::pair<Index, Index>> ends;
    for (const auto& t : s.triangles) {
        for (int k = 0; k < 3; ++k) ends.insert(std::minmax(t[k], t[(k + 1) % 3]));
    }
    std::vector<Side> sides;
    for (const auto& [a, b] : ends) {
        const double length = std::hypot(s.x[b] - s.x[a], s.y[b] - s.y[a]);
        Side side{a,   b,  (s.x[b] - s.x[a]) / length, (s.y[b] - s.y[a]) / length, (s.height[b] - s.height[a]) / length,
                  0.0, 0.0};
        integrate(side, tension_between(s, a, b), length);
        sides.push_back(side);
    }
    return sides;
}

/// Σ ∫ [F″² + α²(F′ − s)²]; slopes are x0, y0, x1, y1, …
double energy_of(const std::vector<Side>& sides, const std::vector<double>& slopes) {
    double sum = 0;
    for (const Side& side : sides) {
        const double a = slopes[2 * side.from] * side.x + slopes[2 * side.from + 1] * side.y - side.chord;
        const double c = slopes[2 * side.to] * side.x + slopes[2 * side.to + 1] * side.y - side.chord;
        sum += side.pp * (a * a + c * c) + 2 * side.pq * a * c;
    }
    return sum;
}

/// The least of a quadratic function of many numbers: its matrix from its values, then Gauss's elimination.
template <class Function>
std::vector<double> least_of(std::size_t count, Function f) {
    const auto at = [&](std::size_t i, std::size_t j, double a, double b) {
        std::vector<double> v(count, 0.0);
        v[i] += a;
        if (j < count) v[j] += b;
        return f(v);
    };
    const double zero = f(std::vector<double>(count, 0.0));
    std::vector<std::vector<double>> rows(count, std::vector<double>(count + 1));
    std::vector<double> single(count);
    for (std::size_t i = 0; i < count; ++i) single[i] = at(i, count, 1, 0);
    for (std::size_t i = 0; i < count; ++i) {
        for (std::size_t j = 0; j < count; ++j) rows[i][j] = at(i, j, 1, 1) - single[i] - single[j] + zero;
        rows[i][count] = -(single[i] - at(i, count, -1, 0)) / 2;
    }
    for (std::size_t i = 0; i < count; ++i) {
        for (std::size_t r = 0; r < count; ++r) {
            if (r == i) continue;
            const double factor = rows[r][i] / rows[i][i];
            for (std::size_t c = i; c <= count; ++c) rows[r][c] -= factor * rows[i][c];
        }
    }
    std::vector<double> least(count);
    for (std::size_t i = 0; i < count; ++i) least[i] = rows[i][count] / rows[i][i];
    return least;
}

std::vector<double> slopes_of(const MinimumNormNetwork& network) {
    std::vector<double> slopes;
    for (std::size_t i = 0; i < network.slope_x.size(); ++i) {
        slopes.push_back(network.slope_x[i]);
        slopes.push_back(network.slope_y[i]);
    }
    return slopes;
}

/// A unit square of two triangles.
TensionSurface square() { return {{0, 1, 1, 0}, {0, 0, 1, 1}, {1, 2, 4, 3}, {0, 0, 0, 0}, {{0, 1, 2}, {0, 2, 3}}, {}}; }

}  // namespace

TEST_CASE("Edges are numbered once, in order, and triangles know them by the corner opposite") {
    TensionSurface s = square();
    s.tension = {0, 2, 4, 6};
    s.extra = {{2, 0, 1}, {0, 2, 0.5}};
    const MinimumNormNetwork network = minimum_norm_network(s.mesh());
    CHECK(network.edges == std::vector<std::array<Index, 2>>{{0, 1}, {0, 2}, {0, 3}, {1, 2}, {2, 3}});
    CHECK(network.edge_tension == std::vector<double>{1, 3.5, 3, 3, 5});
    CHECK(network.edges_of_triangle == std::vector<std::array<Index, 3>>{{3, 1, 0}, {4, 2, 1}});
}

TEST_CASE("Linear heights give back their gradient, whatever the tension") {
    const auto plane = [](double x, double y) { return 3 + 2 * x - 5 * y; };
    for (const auto& [name, outline] : many_outlines()) {
        for (const double tension : {0.0, 1.0, 5.0, 50.0, -1.0}) {
            INFO(name << ", tension " << tension);
            TensionSurface s = surface_over(outline, 300, plane, tension);
            if (tension < 0) set_channel_and_ridge_tension(s);
            const MinimumNormNetwork network = minimum_norm_network(s.mesh());
            for (Index i = 0; i < s.x.size(); ++i) {
                REQUIRE(std::abs(network.slope_x[i] - 2) < 1e-11);
                REQUIRE(std::abs(network.slope_y[i] + 5) < 1e-11);
            }
        }
    }
}

TEST_CASE("The gradients are those that a dense elimination finds for the integrals") {
    for (std::uint64_t seed = 1; seed < 4; ++seed) {
        TensionSurface s = rough_surface(random_star(7, seed), 20, seed);
        for (double& tension : s.tension) tension = std::min(tension, 20.0);  // what the quadrature resolves
        const std::vector<Side> sides = sides_of(s);
        const auto expected = least_of(2 * s.x.size(), [&](const auto& v) { return energy_of(sides, v); });
        const std::vector<double> slopes = slopes_of(minimum_norm_network(s.mesh()));
        const double size = std::abs(*std::max_element(expected.begin(), expected.end(),
                                                       [](double a, double b) { return std::abs(a) < std::abs(b); }));
        for (std::size_t i = 0; i < slopes.size(); ++i) CHECK(std::abs(slopes[i] - expected[i]) < 1e-5 * size);
    }
}

TEST_CASE("The system is solved to rounding: its energy has no slope in any direction") {
    for (std::uint64_t seed = 1; seed < 20; ++seed) {
        const TensionSurface s = rough_surface(random_star(9, seed), 300, seed);
        const MinimumNormNetwork network = minimum_norm_network(s.mesh());
        CHECK(network.iterations <= 32);
        CHECK(network.last_change < 1e-14);
        const double least = network_energy(s.mesh(), network, network.slope_x, network.slope_y);
        Random random(seed, 3);
        for (int trial = 0; trial < 20; ++trial) {
            std::vector<double> up_x = network.slope_x, up_y = network.slope_y;
            std::vector<double> down_x = up_x, down_y = up_y;
            for (std::size_t i = 0; i < up_x.size(); ++i) {
                const double dx = random.normal();
                const double dy = random.normal();
                up_x[i] += dx, up_y[i] += dy;
                down_x[i] -= dx, down_y[i] -= dy;
            }
            const double up = network_energy(s.mesh(), network, up_x, up_y) - least;
            const double down = network_energy(s.mesh(), network, down_x, down_y) - least;
            REQUIRE(up > 0);
            REQUIRE(std::abs(up - down) < 1e-11 * (least + up));  // a quadratic function about its least
        }
    }
}

TEST_CASE("Gradients do not depend on the unit of length, and turn with the mesh") {
    const TensionSurface s = rough_surface(l_shape(), 200, 5);
    const MinimumNormNetwork network = minimum_norm_network(s.mesh());
    TensionSurface other = s;
    for (Index i = 0; i < s.x.size(); ++i) {  // kilometres, a quarter turn to the left, elsewhere
        other.x[i] = 7 - s.y[i] / 1000;
        other.y[i] = s.x[i] / 1000 - 3;
        other.height[i] = s.height[i] / 1000;
    }
    const MinimumNormNetwork turned = minimum_norm_network(other.mesh());
    for (Index i = 0; i < s.x.size(); ++i) {
        CHECK(turned.slope_x[i] == Approx(-network.slope_y[i]).epsilon(1e-8).margin(1e-8));
        CHECK(turned.slope_y[i] == Approx(network.slope_x[i]).epsilon(1e-8).margin(1e-8));
    }
}

TEST_CASE("A vertex of no triangle has no gradient, and a chain of triangles without area has it along its line") {
    TensionSurface s{{0, 1, 3, 4, 9}, {0, 2, 6, 8, 9}, {0, 1, 3, 4, 7}, {0, 5, 0, 5, 0}, {{0, 1, 2}, {1, 2, 3}}, {}};
    const MinimumNormNetwork network = minimum_norm_network(s.mesh());
    for (Index i = 0; i < 4; ++i) {
        CHECK(network.slope_x[i] == Approx(0.2));  // height x along (1, 2): gradient (1, 2)/5
        CHECK(network.slope_y[i] == Approx(0.4));
    }
    CHECK(std::isnan(network.slope_x[4]));
    CHECK(std::isnan(network.slope_y[4]));
}

TEST_CASE("Extra tension on an edge is felt there") {
    TensionSurface s = square();
    s.height = {0, 1, 0, 3};
    const MinimumNormNetwork before = minimum_norm_network(s.mesh());
    s.extra = {{2, 3, 40}};
    const MinimumNormNetwork after = minimum_norm_network(s.mesh());
    const auto bend = [](const MinimumNormNetwork& n) {
        return std::abs(n.slope_x[3] + 3);
    };  // beyond the chord's slope
    CHECK(bend(after) < 0.5 * bend(before));
}

TEST_CASE("One thread and two give the same gradients to the last bit") {
    const TensionSurface s = rough_surface(random_star(15, 2), 8000, 1);
    const auto run = [&](int threads) {
        const ThreadLimit limit(threads);
        return slopes_of(minimum_norm_network(s.mesh()));
    };
    const auto one = run(1);
    const auto two = run(2);
    CHECK(std::memcmp(one.data(), two.data(), one.size() * sizeof(double)) == 0);
}

TEST_CASE("What is no surface is refused with a sentence") {
    const auto refused = [](auto spoil) {
        TensionSurface s = square();
        spoil(s);
        CHECK_THROWS_AS(minimum_norm_network(s.mesh()), Error);
    };
    refused([](TensionSurface& s) { s.height.pop_back(); });
    refused([](TensionSurface& s) { s.tension.push_back(1); });
    refused([](TensionSurface& s) { s.triangles[0][1] = 4; });
    refused([](TensionSurface& s) { s.triangles[0][1] = 2; });
    refused([](TensionSurface& s) { s.height[2] = std::numeric_limits<double>::quiet_NaN(); });
    refused([](TensionSurface& s) { s.x[3] = std::numeric_limits<double>::infinity(); });
    refused([](TensionSurface& s) { s.tension[0] = -1; });
    refused([](TensionSurface& s) { s.tension[0] = std::numeric_limits<double>::infinity(); });
    refused([](TensionSurface& s) { s.x[1] = s.y[1] = 0; });
    refused([](TensionSurface& s) { s.extra = {{1, 3, 1}}; });
    refused([](TensionSurface& s) { s.extra = {{0, 9, 1}}; });
    refused([](TensionSurface& s) { s.extra = {{0, 1, -1}}; });
    CHECK_NOTHROW(minimum_norm_network(square().mesh()));
    CHECK(minimum_norm_network(TensionMesh{}).edges.empty());
}

TEST_CASE("Given gradients stay, and the others are the best beside them") {
    const support::TensionSurface s = support::rough_surface(support::random_star(9, 4), 150, 4);
    const auto count = static_cast<Index>(s.mesh().x.size());
    std::vector<double> given_x(count, std::nan("")), given_y(count, std::nan(""));
    for (Index i = 0; i < count; i += 3) {
        given_x[i] = 0.3 - 0.01 * i;
        given_y[i] = 0.02 * i;
    }
    surface::TensionMesh mesh = s.mesh();
    mesh.given_slope_x = given_x;
    mesh.given_slope_y = given_y;
    const auto network = surface::minimum_norm_network(mesh);
    const double least = surface::network_energy(mesh, network, network.slope_x, network.slope_y);
    for (Index i = 0; i < count; ++i) {
        if (i % 3 == 0) {
            CHECK(network.slope_x[i] == given_x[i]);
            CHECK(network.slope_y[i] == given_y[i]);
            continue;
        }
        for (const double change : {-1e-3, 1e-3}) {  // any other gradient costs more
            auto x = network.slope_x, y = network.slope_y;
            x[i] += change;
            CHECK(surface::network_energy(mesh, network, x, y) > least);
            x[i] -= change;
            y[i] += change;
            CHECK(surface::network_energy(mesh, network, x, y) > least);
        }
    }
    mesh.given_slope_y = std::span(given_y).first(3);
    CHECK_THROWS_WITH(surface::minimum_norm_network(mesh), Catch::Contains("one for each, or none"));
}
