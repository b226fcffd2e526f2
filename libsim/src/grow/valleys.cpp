// SPDX-License-Identifier: GPL-3.0-or-later
#include "thalweg/grow/valleys.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numbers>
#include <unordered_set>
#include <utility>

#include "grow/plane.hpp"

namespace thalweg::grow {
namespace {

constexpr int pieces_per_line = 8;

/// Both directions of a line in one number.
std::uint64_t line_between(Index a, Index b) { return (std::uint64_t{std::min(a, b)} << 32) | std::max(a, b); }

/// Lines of the subdivision that are no ridges.
std::unordered_set<std::uint64_t> inner_lines(const Network& network) {
    std::unordered_set<std::uint64_t> lines;
    for (const Edge& edge : network.edges) {
        const bool is_inner = edge.kind == EdgeKind::channel || edge.kind == EdgeKind::head;
        if (is_inner) lines.insert(line_between(edge.from, edge.to));
    }
    return lines;
}

struct Foot {
    Point place;
    double elevation_m;
};

/// The nearest point of the link.
Foot foot_of(const Network& network, std::span<const double> elevation_m, Index link, const Point& p) {
    const Point& lower = network.vertices[network.lower[link]];
    const Point along = network.vertices[network.upper[link]] - lower;
    const double share = std::clamp(dot(p - lower, along) / dot(along, along), 0.0, 1.0);
    const double low = elevation_m[network.lower[link]], high = elevation_m[network.upper[link]];
    return {lower + share * along, low + share * (high - low)};
}

void add_ridge(const Network& network, std::span<const double> elevation_m, std::array<Index, 2> ends, Index link,
               channel::Bank bank, std::vector<channel::RidgePiece>& pieces) {
    const Point& from = network.vertices[ends[0]];
    const Point along = network.vertices[ends[1]] - from;
    for (int i = 0; i < pieces_per_line; ++i) {
        const double share = (i + 0.5) / pieces_per_line;
        const Point p = from + share * along;
        const Foot foot = foot_of(network, elevation_m, link, p);
        const double height = (1 - share) * elevation_m[ends[0]] + share * elevation_m[ends[1]];
        pieces.push_back({.link = link,
                          .bank = bank,
                          .length_m = norm(along) / pieces_per_line,
                          .rise_m = height - foot.elevation_m,
                          .run_m = norm(p - foot.place)});
    }
}

/// Counter-clockwise from one direction to another, in [0, 2π).
double turn(const Point& from, const Point& to) {
    const double angle = std::atan2(cross(from, to), dot(from, to));
    return angle < 0 ? angle + 2 * std::numbers::pi : angle;
}

/// Per vertex the other ends of the divides that leave it.
std::vector<std::vector<Index>> divides_at(const Network& network) {
    std::vector<std::vector<Index>> ends(network.vertices.size());
    for (const Edge& edge : network.edges) {
        if (edge.kind != EdgeKind::divide) continue;
        ends[edge.from].push_back(edge.to);
        ends[edge.to].push_back(edge.from);
    }
    return ends;
}

}  // namespace

channel::OffsetOf offsets(const Network& network) {
    return [&network](Index from, Index to) { return network.vertices[to] - network.vertices[from]; };
}

std::vector<double> beyond_sources(const Network& network) {
    std::vector<double> beyond(network.size(), 0);
    for (Index link = 0; link < network.size(); ++link) {
        if (!network.is_exterior(link)) continue;
        const Index divide = network.polygon(link, Side::left)[2];  // after the link comes its head, one straight line
        beyond[link] = norm(network.vertices[divide] - network.vertices[network.upper[link]]);
    }
    return beyond;
}

std::vector<channel::RidgePiece> ridge_pieces(const Network& network, std::span<const double> elevation_m) {
    const auto inner = inner_lines(network);
    std::vector<channel::RidgePiece> pieces;
    for (Index link = 0; link < network.size(); ++link) {
        for (const Side hand : {Side::right, Side::left}) {  // looking upstream; the other way round downstream
            const channel::Bank bank = hand == Side::right ? channel::Bank::left : channel::Bank::right;
            const auto polygon = network.polygon(link, hand);
            for (std::size_t i = 0; i < polygon.size(); ++i) {
                const std::array ends{polygon[i], polygon[(i + 1) % polygon.size()]};
                if (inner.contains(line_between(ends[0], ends[1]))) continue;
                add_ridge(network, elevation_m, ends, link, bank, pieces);
            }
        }
    }
    return pieces;
}

std::vector<channel::JunctionDivide> junction_divides(const Network& network) {
    const auto divides = divides_at(network);
    std::vector<channel::JunctionDivide> found;
    for (const Junction& junction : network.junctions) {
        const Point& place = network.vertices[junction.vertex];
        const auto direction = [&](Index vertex) { return network.vertices[vertex] - place; };
        struct Arm {
            Index link;
            Point direction;
        };
        const Arm below{junction.downstream, direction(network.lower[junction.downstream])};
        Arm right{junction.upstream, direction(network.upper[junction.upstream])};
        Arm left{junction.tributary, direction(network.upper[junction.tributary])};
        if (turn(below.direction, right.direction) > turn(below.direction, left.direction)) std::swap(left, right);
        const std::array arms{below, right, left};
        for (std::size_t i = 0; i < 3; ++i) {
            const Arm &first = arms[i], &second = arms[(i + 1) % 3];
            const double sector = turn(first.direction, second.direction);
            std::vector<double> between;
            for (const Index far : divides[junction.vertex]) {
                const double angle = turn(first.direction, direction(far));
                if (angle < sector) between.push_back(angle);
            }
            if (between.size() != 1) continue;
            found.push_back({junction.downstream, {first.link, second.link}, sector, between.front()});
        }
    }
    return found;
}

channel::GrowthMeasures growth_measures(const Network& network, std::span<const double> elevation_m) {
    const channel::StreamNetwork streams = stream_network(network, elevation_m);
    return channel::growth_measures({.network = streams,
                                     .offset_m = offsets(network),
                                     .reach_m = std::numeric_limits<double>::infinity(),  // links are straight
                                     .beyond_source_m = beyond_sources(network),
                                     .ridges = ridge_pieces(network, elevation_m),
                                     .divides = junction_divides(network),
                                     .sidewall_reach_m = network.sidewall_reach_m});
}

}  // namespace thalweg::grow
