// SPDX-License-Identifier: GPL-3.0-or-later
#include "thalweg/grow/surface_mesh.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <numeric>
#include <queue>
#include <span>

#include "grow/valley_side.hpp"
#include "thalweg/core/error.hpp"
#include "thalweg/grow/elevations.hpp"
#include "thalweg/mesh/hilbert.hpp"
#include "thalweg/mesh/triangulate_lines.hpp"

namespace thalweg::grow {
namespace {

/// The pieces of every line: numbers of the vertices within it, from `from` to `to`, follow each other.
class Pieces {
  public:
    Pieces(const Network& network, double longest_m) {
        double next = static_cast<double>(network.vertices.size());
        for (const Edge& edge : network.edges) {
            const double length = norm(network.vertices[edge.to] - network.vertices[edge.from]);
            const double count = std::max(1.0, std::ceil(length / longest_m - 1e-9));
            if (!(next + count < none)) {
                throw Error(
                    fmt::format("lines in pieces of {} m have more vertices than 32-bit numbers can count", longest_m));
            }
            line_.push_back({.from = edge.from,
                             .to = edge.to,
                             .first = static_cast<Index>(next),
                             .inner = static_cast<Index>(count) - 1});
            next += count - 1;
        }
        sort_by_lower_end(network);
    }

    struct Line {
        Index from, to, first, inner;
        Index lower_end() const { return std::min(from, to); }
    };

    const Line& line(std::size_t edge) const { return line_[edge]; }

    /// Appends the vertices from a up to, but without, b.
    void append(Index a, Index b, std::vector<Index>& vertices) const {
        const auto [lower, upper] = std::minmax(a, b);
        auto at = by_lower_end_.begin() + offset_[lower];
        while (std::max(at->from, at->to) != upper) ++at;  // few lines meet in a vertex
        vertices.push_back(a);
        for (Index i = 0; i < at->inner; ++i) {
            vertices.push_back(at->first + (at->from == a ? i : at->inner - 1 - i));
        }
    }

  private:
    void sort_by_lower_end(const Network& network) {
        offset_.assign(network.vertices.size() + 1, 0);
        for (const Line& line : line_) ++offset_[line.lower_end() + 1];
        std::partial_sum(offset_.begin(), offset_.end(), offset_.begin());
        std::vector<Index> next = offset_;
        by_lower_end_.resize(line_.size());
        for (const Line& line : line_) by_lower_end_[next[line.lower_end()]++] = line;
    }

    std::vector<Line> line_, by_lower_end_;
    std::vector<Index> offset_;  ///< per vertex, into the latter
};

void cut_edges(const Network& network, const Pieces& pieces, Network& cut) {
    cut.edges.clear();
    for (std::size_t i = 0; i < network.edges.size(); ++i) {
        const Edge& edge = network.edges[i];
        const Pieces::Line& line = pieces.line(i);
        const Point& from = network.vertices[edge.from];
        const Point along = network.vertices[edge.to] - from;
        Index last = edge.from;
        for (Index k = 0; k < line.inner; ++k) {
            cut.vertices.push_back(from + ((k + 1.0) / (line.inner + 1.0)) * along);
            cut.edges.push_back({last, line.first + k, edge.kind});
            last = line.first + k;
        }
        cut.edges.push_back({last, edge.to, edge.kind});
    }
}

/// `values` in a new order: the value at `order[i]` becomes the i-th.
template <class T>
std::vector<T> reordered(const std::vector<T>& values, const std::vector<Index>& order) {
    std::vector<T> result;
    result.reserve(values.size());
    for (const Index i : order) result.push_back(values[i]);
    return result;
}

/// The steepest valley side of all.
double steepest_side(const Network& network) {
    double steepest = 0;
    for (const auto& [left, right] : network.sidewall_slope) steepest = std::max({steepest, left, right});
    return steepest;
}

/// Vertices that share a side of a triangle, as compressed rows.
struct Neighbors {
    std::vector<Index> offset, list;
};

Neighbors neighbors_of(const SurfaceMesh& mesh) {
    Neighbors n;
    n.offset.assign(mesh.size() + 1, 0);
    for (const auto& t : mesh.triangles) {
        for (const Index corner : t) n.offset[corner + 1] += 2;
    }
    for (Index i = 0; i < mesh.size(); ++i) n.offset[i + 1] += n.offset[i];
    n.list.resize(n.offset.back());
    std::vector<Index> next(n.offset.begin(), n.offset.end() - 1);
    for (const auto& t : mesh.triangles) {
        for (int k = 0; k < 3; ++k) {
            n.list[next[t[k]]++] = t[(k + 1) % 3];
            n.list[next[t[k]]++] = t[(k + 2) % 3];
        }
    }
    return n;
}

/// Height to which a vertex lowers its neighbour, no steeper than `steepest` and not under its least height; infinite
/// if the neighbour is not too high.
double lowered(const SurfaceMesh& mesh, const std::vector<double>& least, double steepest, Index from, Index to) {
    const double dx = mesh.x[to] - mesh.x[from];
    const double dy = mesh.y[to] - mesh.y[from];
    const double surely = 0.999999 * std::max(std::abs(dx), std::abs(dy));  // no longer than the distance, and quicker
    if (mesh.height[to] - mesh.height[from] < steepest * surely) return std::numeric_limits<double>::infinity();
    const double most = std::max(least[to], mesh.height[from] + steepest * std::hypot(dx, dy));
    return most < mesh.height[to] ? most : std::numeric_limits<double>::infinity();
}

/// Whether it lowers any neighbour.
bool lowers(const SurfaceMesh& mesh, const std::vector<double>& least, double steepest, const Neighbors& neighbors,
            Index from) {
    return std::any_of(neighbors.list.begin() + neighbors.offset[from],
                       neighbors.list.begin() + neighbors.offset[from + 1],
                       [&](Index to) { return lowered(mesh, least, steepest, from, to) < mesh.height[to]; });
}

/// Lowers what rises more steeply from a neighbour than any valley side does, but nothing under its least height: from
/// the lowest vertex that lowers another up, each is looked at when nothing can lower it any more.
void limit_slopes(const std::vector<double>& least, double steepest, SurfaceMesh& mesh) {
    const Neighbors neighbors = neighbors_of(mesh);
    using Waiting = std::pair<double, Index>;
    std::vector<Waiting> first;
    for (Index i = 0; i < mesh.size(); ++i) {
        if (lowers(mesh, least, steepest, neighbors, i)) first.emplace_back(mesh.height[i], i);
    }
    std::priority_queue queue(std::greater<Waiting>{}, std::move(first));
    while (!queue.empty()) {
        const auto [height, from] = queue.top();
        queue.pop();
        if (height != mesh.height[from]) continue;  // lowered since
        for (Index at = neighbors.offset[from]; at < neighbors.offset[from + 1]; ++at) {
            const Index to = neighbors.list[at];
            const double most = lowered(mesh, least, steepest, from, to);
            if (!(most < mesh.height[to])) continue;
            mesh.height[to] = most;
            queue.emplace(most, to);
        }
    }
}

double distance_to_sides(const Network& network, std::span<const Index> polygon, const Point& p) {
    double nearest = std::numeric_limits<double>::infinity();
    for (std::size_t i = 0; i < polygon.size(); ++i) {
        const Point& a = network.vertices[polygon[i]];
        const Point& b = network.vertices[polygon[(i + 1) % polygon.size()]];
        nearest = std::min(nearest, norm(p - nearest_on_segment(a, b, p)));
    }
    return nearest;
}

/// Places on the benches beyond the reach of valley sides, on a square lattice. Without them edges would cross a lobe
/// that no tributary reaches from rim to rim, and the smooth surface sag between.
struct Benches {
    std::vector<Point> places;
    std::vector<HeightRange> ranges;
};

void add_bench(const Network& network, const std::vector<HeightRange>& ranges, Index link, Side side, double spacing,
               Benches& benches) {
    const auto polygon = network.polygon(link, side);
    Point low{std::numeric_limits<double>::infinity(), std::numeric_limits<double>::infinity()}, high{-low.x, -low.y};
    double farthest = 0;  // a corner is
    for (const Index vertex : polygon) {
        const Point& p = network.vertices[vertex];
        low = {std::min(low.x, p.x), std::min(low.y, p.y)};
        high = {std::max(high.x, p.x), std::max(high.y, p.y)};
        farthest = std::max(farthest, from_link(network, link, p).distance_m);
    }
    if (!(farthest > network.sidewall_reach_m)) return;
    for (double row = std::ceil(low.y / spacing); row * spacing < high.y; ++row) {
        for (double col = std::ceil(low.x / spacing); col * spacing < high.x; ++col) {
            const Point p{col * spacing, row * spacing};
            if (!(from_link(network, link, p).distance_m > network.sidewall_reach_m)) continue;
            if (!is_inside(network, polygon, p) || distance_to_sides(network, polygon, p) < spacing / 3) continue;
            benches.places.push_back(p);
            benches.ranges.push_back(range_on_side(network, link, side, ranges[network.lower[link]].least,
                                                   ranges[network.upper[link]].least, p));
        }
    }
}

/// `ranges` are those of the network's vertices; pieces of lines are up to `longest_m` long.
Benches benches_of(const Network& network, const std::vector<HeightRange>& ranges, double longest_m) {
    Benches benches;
    if (!std::isfinite(network.sidewall_reach_m)) return benches;
    const double spacing = std::max(longest_m, network.sidewall_reach_m / 2);
    for (Index link = 0; link < network.size(); ++link) {
        for (const Side side : {Side::left, Side::right}) add_bench(network, ranges, link, side, spacing, benches);
    }
    return benches;
}

/// Gradients along the channels. Junctions are level: there links of three directions meet, and the gradient of any one
/// would tilt the beds of the others aside, so that water left them for their neighbour before it came to the junction.
void set_channel_slopes(const Network& cut, const std::vector<HeightRange>& ranges, SurfaceMesh& mesh) {
    mesh.channel_slope_x.assign(mesh.size(), std::numeric_limits<double>::quiet_NaN());
    mesh.channel_slope_y = mesh.channel_slope_x;
    for (Index link = 0; link < cut.size(); ++link) {
        const Point along = cut.vertices[cut.upper[link]] - cut.vertices[cut.lower[link]];
        const double rise = ranges[cut.upper[link]].least - ranges[cut.lower[link]].least;
        const Point slope = (rise / dot(along, along)) * along;
        for (const Index vertex : cut.polygon(link, Side::left)) {
            const Index here = mesh.vertex_of[vertex];
            const bool junction = (vertex == cut.lower[link] && cut.downstream[link] != none) ||
                                  (vertex == cut.upper[link] && !cut.is_exterior(link));
            if (mesh.on_channel[here]) {
                mesh.channel_slope_x[here] = junction ? 0 : slope.x;
                mesh.channel_slope_y[here] = junction ? 0 : slope.y;
            }
            if (vertex == cut.upper[link]) break;  // the polygon runs up the link first
        }
    }
}

}  // namespace

Network subdivided(const Network& network, double longest_m) {
    if (!(longest_m > 0)) throw Error(fmt::format("lines cannot be cut into pieces of {} m", longest_m));
    const Pieces pieces(network, longest_m);
    Network cut = network;
    cut_edges(network, pieces, cut);
    cut.polygon_vertices.clear();
    cut.polygon_offset.assign(1, 0);
    for (Index link = 0; link < network.size(); ++link) {
        for (const Side side : {Side::left, Side::right}) {
            const auto polygon = network.polygon(link, side);
            for (std::size_t i = 0; i < polygon.size(); ++i) {
                pieces.append(polygon[i], polygon[(i + 1) % polygon.size()], cut.polygon_vertices);
            }
            cut.polygon_offset.push_back(static_cast<Index>(cut.polygon_vertices.size()));
        }
    }
    return cut;
}

SurfaceMesh surface_mesh(const Network& network, const Flint& flint, double base_level_m, double longest_m) {
    Network cut = subdivided(network, longest_m);
    std::vector<HeightRange> ranges = height_ranges(cut, flint, base_level_m);
    const Benches benches = benches_of(network, ranges, longest_m);
    cut.vertices.insert(cut.vertices.end(), benches.places.begin(), benches.places.end());
    ranges.insert(ranges.end(), benches.ranges.begin(), benches.ranges.end());
    const std::vector<Index> order = mesh::hilbert_order(cut.vertices);
    SurfaceMesh surface;
    surface.vertex_of.resize(order.size());
    for (Index i = 0; i < order.size(); ++i) surface.vertex_of[order[i]] = i;
    const std::vector<Point> points = reordered(cut.vertices, order);
    std::vector<double> least;
    for (const Index i : order) {
        least.push_back(ranges[i].least);
        surface.height.push_back(std::max(ranges[i].allowed, ranges[i].least));
    }
    surface.on_channel.assign(points.size(), 0);
    std::vector<std::array<Index, 2>> lines;
    for (const Edge& edge : cut.edges) {
        const Edge line{surface.vertex_of[edge.from], surface.vertex_of[edge.to], edge.kind};
        surface.lines.push_back(line);
        lines.push_back({line.from, line.to});
        if (edge.kind == EdgeKind::channel) surface.on_channel[line.from] = surface.on_channel[line.to] = 1;
    }
    for (const Point& p : points) {
        surface.x.push_back(p.x);
        surface.y.push_back(p.y);
    }
    // Along the curve as the points are, so that neighbours in space are near each other in memory.
    std::sort(lines.begin(), lines.end());
    surface.triangles = mesh::triangulate_lines(points, lines);
    set_channel_slopes(cut, ranges, surface);
    limit_slopes(least, steepest_side(network), surface);
    surface.vertex_of.resize(network.vertices.size());
    return surface;
}

}  // namespace thalweg::grow
