// SPDX-License-Identifier: GPL-3.0-or-later
#include "thalweg/render/wireframe.hpp"

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <limits>

#include "thalweg/core/parallel.hpp"
#include "thalweg/render/colors.hpp"
#include "thalweg/render/trace.hpp"

using namespace thalweg;
using namespace thalweg::render;

namespace {

constexpr double degree = std::numbers::pi / 180;
constexpr double no_data = std::numeric_limits<double>::quiet_NaN();

struct Lattice {
    Grid grid;
    std::vector<double> heights;
    TriangleSurface surface;
};

template <class Height>
Lattice lattice(Index rows, Index cols, Height height) {
    Lattice l{plane_grid(rows, cols, 10, 10), {}, {}};
    for (Index i = 0; i < l.grid.size(); ++i) {
        l.surface.x.push_back(10.0 * l.grid.col(i));
        l.surface.y.push_back(-10.0 * l.grid.row(i));
        l.heights.push_back(height(l.grid.row(i), l.grid.col(i)));
    }
    l.surface.z = l.heights;
    for (Index row = 0; row + 1 < rows; ++row) {
        for (Index col = 0; col + 1 < cols; ++col) {
            const Index nw = row * cols + col, sw = nw + cols;
            l.surface.triangles.push_back({sw, sw + 1, nw + 1});
            l.surface.triangles.push_back({sw, nw + 1, nw});
        }
    }
    return l;
}

double length_of(std::span<const Stroke> strokes) {
    double sum = 0;
    for (const Stroke& s : strokes) sum += std::hypot(s.to.x - s.from.x, s.to.y - s.from.y);
    return sum;
}

std::vector<Stroke> all_strokes(const Lattice& l, const std::vector<Edge>& edges, const Camera& camera) {
    std::vector<Stroke> strokes;
    const auto pixel = [&](Index v) { return camera.project({l.surface.x[v], l.surface.y[v], l.surface.z[v]}); };
    for (const Edge& e : edges) strokes.push_back({pixel(e.first), pixel(e.second)});
    return strokes;
}

}  // namespace

TEST_CASE("A grid's lines join neighbours with data") {
    Lattice l = lattice(3, 4, [](Index, Index) { return 0.0; });
    CHECK(grid_edges(l.grid, l.heights).size() == 3 * 3 + 2 * 4);
    l.heights[5] = no_data;
    CHECK(grid_edges(l.grid, l.heights).size() == 3 * 3 + 2 * 4 - 4);
}

TEST_CASE("Of a plain nothing is hidden, and every edge is one stroke") {
    const Lattice l = lattice(20, 30, [](Index, Index) { return 0.0; });
    const auto edges = grid_edges(l.grid, l.heights);
    for (const double azimuth : {10.0, 130.0, 250.0}) {
        const View view{.azimuth = azimuth * degree, .elevation = 20 * degree};
        const Camera camera = fitting_camera(view, l.surface);
        const auto strokes = visible_strokes(l.surface, edges, camera);
        CHECK(strokes.size() == edges.size());
        CHECK(length_of(strokes) == Approx(length_of(all_strokes(l, edges, camera))));
    }
}

TEST_CASE("A ridge hides what lies behind it, up to the line of sight over its crest") {
    // The ridge of 100 m runs along row 20; behind it, in the north, the plain.
    const Lattice l = lattice(41, 41, [](Index row, Index) { return row == 20 ? 100.0 : 0.0; });
    Lattice probe = l;
    const Index crest = 20 * 41 + 20;
    probe.surface.x.push_back(l.surface.x[crest]);
    probe.surface.y.push_back(l.surface.y[crest] + 10.001);
    probe.surface.z.push_back(0);
    const std::vector<Edge> ground{{static_cast<Index>(l.grid.size()), 20}};
    const Camera camera =
        fitting_camera({.azimuth = 180 * degree, .elevation = 35 * degree, .width = 400, .height = 400}, l.surface);
    const auto strokes = visible_strokes(probe.surface, ground, camera);
    REQUIRE(strokes.size() == 1);
    const double crest_y = l.surface.y[crest];
    const double reach = 100 * (crest_y - camera.eye.y) / (camera.eye.z - 100);  // of the shadow of sight
    const Point expected = camera.project({l.surface.x[crest], crest_y + reach, 0});
    CHECK(strokes[0].from.y == Approx(expected.y).margin(1));
    CHECK(strokes[0].to.y == Approx(camera.project({l.surface.x[20], l.surface.y[20], 0}).y).margin(0.01));
}

TEST_CASE("Hidden lines are the same for any number of threads, and fewer than all") {
    const Lattice l = lattice(50, 50, [](Index r, Index c) { return 60 * std::sin(r / 4.0) * std::sin(c / 5.0); });
    const auto edges = grid_edges(l.grid, l.heights);
    const Camera camera = fitting_camera({.elevation = 15 * degree}, l.surface);
    const auto drawn = [&](int threads) {
        const ThreadLimit limit(threads);
        return svg_of(100, 100, {}, visible_strokes(l.surface, edges, camera), 1);
    };
    CHECK(drawn(1) == drawn(2));
    const double seen = length_of(visible_strokes(l.surface, edges, camera));
    const double all = length_of(all_strokes(l, edges, camera));
    CHECK(seen < 0.9 * all);
    CHECK(seen > 0.3 * all);
}

TEST_CASE("A line drawn over a picture inks its pixels fully and their neighbours not") {
    Picture picture{.width = 10, .height = 5, .light = {}, .coverage = {}};
    picture.light.resize(50);
    picture.coverage.resize(50);
    draw(picture, std::vector<Stroke>{{{1, 2.5}, {9, 2.5}}}, 1, {0.25f, 0.5f, 1});
    CHECK(picture.coverage[2 * 10 + 5] == 1);
    CHECK(picture.light[2 * 10 + 5].g == 0.5f);
    CHECK(picture.coverage[0 * 10 + 5] == 0);
    CHECK(picture.coverage[4 * 10 + 5] == 0);
    float ink = 0;
    for (const float c : picture.coverage) ink += c;
    CHECK(ink == Approx(8).margin(1));
}

TEST_CASE("Facets come from the farthest to the nearest, lit by Lambert's law") {
    const Lattice l = lattice(12, 12, [](Index r, Index c) { return 5 * std::sin(r + 0.5 * c); });
    const Model model{.ground = l.surface,
                      .color = clay_colors(l.surface.size()),
                      .sides = {},
                      .side_color = {},
                      .shading = Shading::facets};
    const Camera camera = fitting_camera({.azimuth = 180 * degree, .elevation = 30 * degree}, l.surface);
    const auto facets = painted_facets(model, camera, {.to_sun = {0, 0, 1}});
    REQUIRE(facets.size() == l.surface.triangles.size());
    const auto middle = [](const Facet& f) { return (f.corners[0].y + f.corners[1].y + f.corners[2].y) / 3; };
    double highest_of_first = 1e9, lowest_of_last = 0;
    for (std::size_t i = 0; i < 22; ++i) {
        highest_of_first = std::min(highest_of_first, middle(facets[i]));
        lowest_of_last = std::max(lowest_of_last, middle(facets[facets.size() - 1 - i]));
    }
    CHECK(highest_of_first < lowest_of_last);
    for (const Facet& f : facets) CHECK((f.color.r > 0 && f.color.r <= clay_colors(1)[0].r));
    const std::string svg = svg_of(640, 480, facets, {}, 1);
    CHECK(svg.starts_with("<svg xmlns="));
    CHECK(svg.ends_with("</svg>\n"));
    CHECK(svg.find("width=\"640\"") != std::string::npos);
}
