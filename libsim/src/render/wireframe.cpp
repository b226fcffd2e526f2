// SPDX-License-Identifier: GPL-3.0-or-later
#include "thalweg/render/wireframe.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <numeric>

#include "render/rays.hpp"
#include "thalweg/core/parallel.hpp"
#include "thalweg/render/trace.hpp"

namespace thalweg::render {
namespace {

Vector vertex(const TriangleSurface& s, Index v) { return {s.x[v], s.y[v], s.z[v]}; }

/// Looks from places of the surface's edges to the eye.
class Sight {
  public:
    Sight(const TriangleSurface& surface, const Camera& camera)
        : surface_(surface), camera_(camera), rays_(surface, {}), lift_(1e-4 * extent(surface)) {}

    void add_strokes(const Edge& edge, std::vector<Stroke>& strokes) const {
        constexpr int pieces = 24;
        const Vector from = vertex(surface_, edge.first), to = vertex(surface_, edge.second);
        const auto sees = [&](double share) { return is_seen(from + share * (to - from)); };
        const auto pixel = [&](double share) { return camera_.project(from + share * (to - from)); };
        double start = 0, before = 0.5 / pieces;
        bool seen = sees(before);
        for (int i = 1; i < pieces; ++i) {
            const double here = (i + 0.5) / pieces;
            if (sees(here) != seen) {
                const double change = halved(before, here, seen, sees);
                if (seen) strokes.push_back({pixel(start), pixel(change)});
                start = change;
                seen = !seen;
            }
            before = here;
        }
        if (seen) strokes.push_back({pixel(start), pixel(1)});
    }

  private:
    static double extent(const TriangleSurface& s) {
        double low = s.x[s.triangles[0][0]], high = low;
        for (const auto& t : s.triangles) {
            for (const Index v : t) {
                low = std::min(low, s.x[v]);
                high = std::max(high, s.x[v]);
            }
        }
        return high - low;
    }

    bool is_seen(Vector place) const {
        place.z += lift_;
        const Vector to_eye = camera_.eye - place;
        const double distance = std::sqrt(dot(to_eye, to_eye));
        const Vector along = (1 / distance) * to_eye;
        return !rays_.blocked(place, along, along, distance);
    }

    template <class Sees>
    static double halved(double low, double high, bool seen_at_low, Sees sees) {
        for (int i = 0; i < 8; ++i) {
            const double middle = (low + high) / 2;
            (sees(middle) == seen_at_low ? low : high) = middle;
        }
        return (low + high) / 2;
    }

    const TriangleSurface& surface_;
    const Camera& camera_;
    Rays rays_;
    double lift_;  ///< m, so that an edge is not hidden by the triangles that it belongs to
};

double distance_to(const Stroke& stroke, const Point& p) {
    const double dx = stroke.to.x - stroke.from.x, dy = stroke.to.y - stroke.from.y;
    const double length2 = dx * dx + dy * dy;
    const double along = length2 > 0 ? ((p.x - stroke.from.x) * dx + (p.y - stroke.from.y) * dy) / length2 : 0;
    const double share = std::clamp(along, 0.0, 1.0);
    return std::hypot(p.x - stroke.from.x - share * dx, p.y - stroke.from.y - share * dy);
}

/// Pixels from `low` to `high`, of those there are.
std::pair<Index, Index> pixels_between(double low, double high, Index count) {
    return {static_cast<Index>(std::clamp(std::floor(low), 0.0, double(count))),
            static_cast<Index>(std::clamp(std::ceil(high), 0.0, double(count)))};
}

std::string html(const Rgb& color) {
    const Picture pixel{.width = 1, .height = 1, .light = {color}, .coverage = {1}};
    const auto bytes = to_srgb(pixel, {});
    return fmt::format("#{:02x}{:02x}{:02x}", bytes[0], bytes[1], bytes[2]);
}

}  // namespace

std::vector<Edge> grid_edges(const Grid& grid, std::span<const double> heights_m) {
    std::vector<Edge> edges;
    for (Index node = 0; node < grid.size(); ++node) {
        if (std::isnan(heights_m[node])) continue;
        const bool east = grid.col(node) + 1 < grid.cols, south = grid.row(node) + 1 < grid.rows;
        if (east && !std::isnan(heights_m[node + 1])) edges.emplace_back(node, node + 1);
        if (south && !std::isnan(heights_m[node + grid.cols])) edges.emplace_back(node, node + grid.cols);
    }
    return edges;
}

std::vector<Stroke> visible_strokes(const TriangleSurface& surface, std::span<const Edge> edges, const Camera& camera) {
    if (surface.triangles.empty()) return {};
    const Sight sight(surface, camera);
    constexpr Index batch = 256;
    const Index batches = (static_cast<Index>(edges.size()) + batch - 1) / batch;
    std::vector<std::vector<Stroke>> found(batches);
    parallel_for(
        0, batches,
        [&](Index first, Index last) {
            for (Index b = first; b < last; ++b) {
                for (const Edge& edge :
                     edges.subspan(b * batch, std::min<std::size_t>(batch, edges.size() - b * batch))) {
                    sight.add_strokes(edge, found[b]);
                }
            }
        },
        1);
    std::vector<Stroke> strokes;
    for (const auto& part : found) strokes.insert(strokes.end(), part.begin(), part.end());
    return strokes;
}

void draw(Picture& picture, std::span<const Stroke> strokes, double line_width, const Rgb& color) {
    std::vector<float> ink(picture.light.size(), 0);
    const double reach = line_width / 2 + 0.5;
    for (const Stroke& s : strokes) {
        const auto [left, right] = std::minmax(s.from.x, s.to.x);
        const auto [top, bottom] = std::minmax(s.from.y, s.to.y);
        const auto rows = pixels_between(top - reach, bottom + reach, picture.height);
        const auto cols = pixels_between(left - reach, right + reach, picture.width);
        for (Index row = rows.first; row < rows.second; ++row) {
            for (Index col = cols.first; col < cols.second; ++col) {
                const double share = reach - distance_to(s, {col + 0.5, row + 0.5});
                float& here = ink[std::size_t{row} * picture.width + col];
                here = std::max(here, static_cast<float>(std::clamp(share, 0.0, std::min(1.0, line_width))));
            }
        }
    }
    for (std::size_t i = 0; i < ink.size(); ++i) {
        picture.light[i] = (1 - ink[i]) * picture.light[i] + ink[i] * color;
        picture.coverage[i] = (1 - ink[i]) * picture.coverage[i] + ink[i];
    }
}

std::vector<Facet> painted_facets(const Model& model, const Camera& camera, const Light& light) {
    const TriangleSurface& s = model.ground;
    std::vector<std::pair<double, Index>> order;
    std::vector<Facet> facets;
    for (Index t = 0; t < s.triangles.size(); ++t) {
        const auto& [i, j, k] = s.triangles[t];
        const Vector a = vertex(s, i), b = vertex(s, j), c = vertex(s, k);
        const Vector normal = unit(cross(b - a, c - a)), from_eye = 1.0 / 3 * (a + b + c) - camera.eye;
        const double sun = std::max(0.0, dot(normal, light.to_sun)), sky = (1 + normal.z) / 2;
        const Rgb color = 1.0f / 3 * (model.color[i] + model.color[j] + model.color[k]);
        facets.push_back({{camera.project(a), camera.project(b), camera.project(c)},
                          color * (static_cast<float>(sun) * light.sun + static_cast<float>(sky) * light.sky)});
        order.emplace_back(-dot(from_eye, from_eye), t);
    }
    std::sort(order.begin(), order.end());
    std::vector<Facet> painted;
    painted.reserve(facets.size());
    for (const auto& [distance, t] : order) painted.push_back(facets[t]);
    return painted;
}

std::string svg_of(Index width, Index height, std::span<const Facet> facets, std::span<const Stroke> strokes,
                   double line_width) {
    std::string svg = fmt::format(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{0}\" height=\"{1}\" viewBox=\"0 0 {0} {1}\">\n"
        "<rect width=\"100%\" height=\"100%\" fill=\"#ffffff\"/>\n",
        width, height);
    svg += "<g stroke-width=\"0.5\" stroke-linejoin=\"round\">\n";
    for (const Facet& f : facets) {
        const std::string color = html(f.color);
        svg += fmt::format("<path d=\"M{:.2f} {:.2f}L{:.2f} {:.2f}L{:.2f} {:.2f}Z\" fill=\"{}\" stroke=\"{}\"/>\n",
                           f.corners[0].x, f.corners[0].y, f.corners[1].x, f.corners[1].y, f.corners[2].x,
                           f.corners[2].y, color, color);
    }
    svg += fmt::format("</g>\n<path fill=\"none\" stroke=\"#222222\" stroke-width=\"{}\" stroke-linecap=\"round\" d=\"",
                       line_width);
    Point last{-1, -1};
    for (const Stroke& s : strokes) {
        if (!(s.from == last)) svg += fmt::format("M{:.2f} {:.2f}", s.from.x, s.from.y);
        svg += fmt::format("L{:.2f} {:.2f}", s.to.x, s.to.y);
        last = s.to;
    }
    return svg + "\"/>\n</svg>\n";
}

}  // namespace thalweg::render
