// SPDX-License-Identifier: GPL-3.0-or-later
#include "study/grown_outputs.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>
#include <tuple>
#include <utility>

#include "grow/valley_side.hpp"
#include "thalweg/grow/elevations.hpp"
#include "thalweg/mesh/triangulate_lines.hpp"
#include "thalweg/surface/heightfield.hpp"
#include "thalweg/surface/patch.hpp"

namespace thalweg::study {
namespace {

constexpr double degrees_per_radian = 180 / std::numbers::pi;
using Doubles = std::vector<double>;
using Wholes = std::vector<std::int64_t>;
using Texts = std::vector<std::string>;

std::int64_t or_minus_one(Index value) { return value == none ? -1 : static_cast<std::int64_t>(value); }
const char* name_of(grow::Side side) { return side == grow::Side::left ? "left" : "right"; }

const char* name_of(grow::EdgeKind kind) {
    switch (kind) {
        case grow::EdgeKind::outline:
            return "outline";
        case grow::EdgeKind::head:
            return "head";
        case grow::EdgeKind::divide:
            return "divide";
        case grow::EdgeKind::channel:
            break;
    }
    return "channel";
}

double sidewall_deg(const grow::Network& network, Index link, grow::Side side) {
    return std::atan(network.sidewall_slope[link][static_cast<std::size_t>(side)]) * degrees_per_radian;
}

/// The points in their order, but each place once: where it came first.
std::vector<Point> each_once(const std::vector<Point>& points) {
    std::vector<Index> by_place(points.size());
    std::iota(by_place.begin(), by_place.end(), 0);
    const auto place = [&](Index i) { return std::pair(points[i].x, points[i].y); };
    std::ranges::sort(by_place, {}, [&](Index i) { return std::tuple(points[i].x, points[i].y, i); });
    std::vector<std::uint8_t> is_first(points.size(), 1);
    for (std::size_t at = 1; at < by_place.size(); ++at) {
        is_first[by_place[at]] = place(by_place[at]) != place(by_place[at - 1]);
    }
    std::vector<Point> kept;
    for (std::size_t i = 0; i < points.size(); ++i) {
        if (is_first[i]) kept.push_back(points[i]);
    }
    return kept;
}

/// Along both banks of a link, at most `spacing_m` apart.
void add_banks(const Experiment& e, const grow::Network& network, Index link, double spacing_m, Banks& banks) {
    const double half_width = channel_width_m(e, network.magnitude[link]) / 2;
    const Point& lower = network.vertices[network.lower[link]];
    const Point& upper = network.vertices[network.upper[link]];
    const Point along{upper.x - lower.x, upper.y - lower.y};
    const double length = network.length_m[link];
    const double count = std::ceil(length / spacing_m);
    for (double k = 0; k < count; ++k) {
        for (const auto side : {grow::Side::left, grow::Side::right}) {
            const double share = (k + 0.5) / count;
            const double aside = (side == grow::Side::left ? half_width : -half_width) / length;
            const Point bank{lower.x + share * along.x - aside * along.y, lower.y + share * along.y + aside * along.x};
            ++banks.all;
            if (grow::is_inside(network, network.polygon(link, side), bank)) {
                banks.places.push_back(bank);
            } else {
                ++banks.beyond;
            }
        }
    }
}

/// Middles of the edges that are no lines of the network.
void add_middles(const grow::SurfaceMesh& mesh, std::vector<Point>& points) {
    std::vector<std::pair<Index, Index>> lines;
    for (const grow::Edge& line : mesh.lines) lines.push_back(std::minmax(line.from, line.to));
    std::sort(lines.begin(), lines.end());
    for (const auto& t : mesh.triangles) {
        for (int k = 0; k < 3; ++k) {
            const Index a = t[k], b = t[(k + 1) % 3];
            if (a > b || std::binary_search(lines.begin(), lines.end(), std::pair{a, b})) continue;
            points.push_back({(mesh.x[a] + mesh.x[b]) / 2, (mesh.y[a] + mesh.y[b]) / 2});
        }
    }
}

/// Where the written triangles have their corners: the mesh's own first.
std::vector<Point> places_of_corners(const Experiment& e, const GrownTerrain& t) {
    const grow::SurfaceMesh& mesh = t.surface.mesh;
    std::vector<Point> places;
    for (Index vertex = 0; vertex < mesh.size(); ++vertex) places.push_back({mesh.x[vertex], mesh.y[vertex]});
    for (const Point& bank : banks_of(e, t).places) places.push_back(bank);
    add_middles(mesh, places);
    return each_once(places);
}

/// The corners with their heights, but for those beyond the surface; the triangles are still to come. They take most
/// of the memory that a grown terrain needs, so what the heights need is gone by then.
TriangleSurface corners_of_triangles(const Experiment& e, const GrownTerrain& t) {
    const grow::SurfaceMesh& mesh = t.surface.mesh;
    const std::vector<Point> places = places_of_corners(e, t);
    const std::vector<double> rough = roughness_at(e, t, places);
    const surface::TensionMesh tension = t.surface.tension_mesh();
    const auto evaluated = surface::surface_at(tension, surface::tension_patches(tension, t.surface.network),
                                               std::span(places).subspan(mesh.size()));
    TriangleSurface surface;
    for (std::size_t i = 0; i < places.size(); ++i) {
        const double smooth = i < mesh.size() ? mesh.height[i] : evaluated[i - mesh.size()].height;
        if (i >= mesh.size() && !std::isfinite(smooth)) continue;
        surface.x.push_back(places[i].x);
        surface.y.push_back(places[i].y);
        surface.z.push_back(smooth + rough[i]);
    }
    return surface;
}

Table links_layer(const Experiment& e, const GrownTerrain& t) {
    const grow::Network& network = t.growth.network;
    const channel::StreamNetwork& tree = t.tree;
    Table table{.name = "links", .columns = {}, .kind = GeometryKind::line, .geometry = {}};
    Wholes id, downstream, strahler, shreve, stream;
    Doubles slope, left, right, width;
    for (Index link = 0; link < network.size(); ++link) {
        id.push_back(link);
        downstream.push_back(or_minus_one(network.downstream[link]));
        strahler.push_back(tree.strahler[link]);
        shreve.push_back(network.magnitude[link]);
        stream.push_back(network.stream[link]);
        slope.push_back(grow::gradient(t.dials.flint, network.magnitude[link]));
        left.push_back(sidewall_deg(network, link, grow::Side::left));
        right.push_back(sidewall_deg(network, link, grow::Side::right));
        width.push_back(channel_width_m(e, network.magnitude[link]));
        table.geometry.push_back(map_places(t.site, network, tree.nodes_of(link)));
    }
    table.columns = {{"id", id},
                     {"downstream", downstream},
                     {"strahler", strahler},
                     {"shreve", shreve},
                     {"length_m", tree.length_m},
                     {"drop_m", tree.drop_m},
                     {"slope", slope},
                     {"area_m2", tree.area_m2},
                     {"stream", stream},
                     {"left_sidewall_deg", left},
                     {"right_sidewall_deg", right},
                     {"width_m", width}};
    return table;
}

Table polygons_layer(const GrownTerrain& t) {
    const grow::Network& network = t.growth.network;
    Table table{.name = "polygons", .columns = {}, .kind = GeometryKind::polygon, .geometry = {}};
    Wholes link_of;
    Texts side_of;
    Doubles angle;
    for (Index link = 0; link < network.size(); ++link) {
        for (const auto side : {grow::Side::left, grow::Side::right}) {
            link_of.push_back(link);
            side_of.push_back(name_of(side));
            angle.push_back(sidewall_deg(network, link, side));
            table.polygons.push_back({{map_places(t.site, network, network.polygon(link, side)), {}}});
        }
    }
    table.columns = {
        {"link", link_of}, {"side", side_of}, {"area_m2", network.polygon_area_m2}, {"sidewall_deg", angle}};
    return table;
}

Table divides_layer(const GrownTerrain& t) {
    const grow::Network& network = t.growth.network;
    Table table{.name = "divides", .columns = {}, .kind = GeometryKind::line, .geometry = {}};
    Texts kind;
    Doubles from, to, length;
    for (const grow::Edge& edge : network.edges) {
        if (edge.kind == grow::EdgeKind::channel) continue;
        kind.push_back(name_of(edge.kind));
        from.push_back(t.surface.mesh.height[t.surface.mesh.vertex_of[edge.from]]);
        to.push_back(t.surface.mesh.height[t.surface.mesh.vertex_of[edge.to]]);
        const Point& a = network.vertices[edge.from];
        const Point& b = network.vertices[edge.to];
        length.push_back(std::hypot(b.x - a.x, b.y - a.y));
        table.geometry.push_back(map_places(t.site, network, std::array{edge.from, edge.to}));
    }
    table.columns = {{"kind", kind}, {"length_m", length}, {"elevation_from_m", from}, {"elevation_to_m", to}};
    return table;
}

Table junctions_layer(const GrownTerrain& t) {
    const grow::Network& network = t.growth.network;
    Table table{.name = "junctions", .columns = {}, .kind = GeometryKind::point, .geometry = {}};
    Wholes downstream, upstream, tributary, magnitude;
    Texts side;
    Doubles angle, turn;
    for (const grow::Junction& junction : network.junctions) {
        downstream.push_back(junction.downstream);
        upstream.push_back(junction.upstream);
        tributary.push_back(junction.tributary);
        magnitude.push_back(junction.magnitude);
        side.push_back(name_of(junction.side));
        angle.push_back(junction.angle_rad * degrees_per_radian);
        turn.push_back(junction.turn_rad * degrees_per_radian);
        table.geometry.push_back(map_places(t.site, network, std::array{junction.vertex}));
    }
    table.columns = {{"downstream", downstream}, {"upstream", upstream}, {"tributary", tributary}, {"side", side},
                     {"magnitude", magnitude},   {"angle_deg", angle},   {"turn_deg", turn}};
    return table;
}

Table sources_layer(const GrownTerrain& t) {
    const grow::Network& network = t.growth.network;
    Table table{.name = "sources", .columns = {}, .kind = GeometryKind::point, .geometry = {}};
    Wholes link_of;
    for (Index link = 0; link < network.size(); ++link) {
        if (!network.is_exterior(link)) continue;
        link_of.push_back(link);
        table.geometry.push_back(map_places(t.site, network, std::array{network.upper[link]}));
    }
    table.columns = {{"link", link_of}};
    return table;
}

}  // namespace

double channel_width_m(const Experiment& e, Index magnitude) {
    return e.growth.channel_width_m * std::pow(magnitude, e.growth.channel_width_exponent);
}

std::vector<Index> source_vertices(const grow::Network& network) {
    std::vector<Index> vertices;
    for (Index link = 0; link < network.size(); ++link) {
        if (network.is_exterior(link)) vertices.push_back(network.upper[link]);
    }
    return vertices;
}

std::vector<Point> map_places(const GrowthSite& site, const grow::Network& network, std::span<const Index> vertices) {
    std::vector<Point> places;
    places.reserve(vertices.size());
    for (const Index vertex : vertices) {
        const Point& p = network.vertices[vertex];
        places.push_back({(p.x + network.origin.x) / site.unit_m, (p.y + network.origin.y) / site.unit_m});
    }
    return places;
}

Banks banks_of(const Experiment& e, const GrownTerrain& t) {
    Banks banks;
    if (!(e.growth.channel_width_m > 0)) return banks;
    for (Index link = 0; link < t.growth.network.size(); ++link) {
        add_banks(e, t.growth.network, link, surface_spacing_m(t.dials), banks);
    }
    return banks;
}

TriangleSurface triangles_of(const Experiment& e, const GrownTerrain& t) {
    TriangleSurface surface = corners_of_triangles(e, t);
    std::vector<Point> points;
    points.reserve(surface.size());
    for (Index i = 0; i < surface.size(); ++i) points.push_back({surface.x[i], surface.y[i]});
    std::vector<std::array<Index, 2>> lines;
    for (const grow::Edge& line : t.surface.mesh.lines) lines.push_back({line.from, line.to});
    surface.triangles = mesh::triangulate_lines(points, lines);
    return surface;
}

std::vector<Table> grown_layers(const Experiment& e, const GrownTerrain& t) {
    return {links_layer(e, t), polygons_layer(t), divides_layer(t), junctions_layer(t), sources_layer(t)};
}

}  // namespace thalweg::study
