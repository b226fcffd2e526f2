// SPDX-License-Identifier: GPL-3.0-or-later
#include "study/outlets.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "thalweg/core/error.hpp"

namespace thalweg::study {
namespace {

double distance_to(const Point& a, const Point& b, const Point& p) {
    const double dx = b.x - a.x, dy = b.y - a.y;
    const double at = std::clamp(((p.x - a.x) * dx + (p.y - a.y) * dy) / (dx * dx + dy * dy), 0.0, 1.0);
    return std::hypot(p.x - a.x - at * dx, p.y - a.y - at * dy);
}

struct Edge {
    Point a, b;
    Side side;
};

std::vector<Edge> edges_of(const std::vector<Polygon>& rings) {
    std::vector<Edge> edges;
    for (const Polygon& ring : rings) {
        for (std::size_t i = 0; i < ring.size(); ++i) {
            const Point& b = ring[(i + 1) % ring.size()];
            edges.push_back({ring[i], b, facing(ring[i], b)});
        }
    }
    return edges;
}

/// Whether one of the edges nearest to the place faces one of the sides. `rounding` is what counts as equally near.
bool lies_on(const std::vector<Side>& sides, const std::vector<Edge>& edges, const Point& place, double rounding,
             std::vector<double>& distance) {
    distance.resize(edges.size());
    double nearest = std::numeric_limits<double>::infinity();
    for (std::size_t i = 0; i < edges.size(); ++i) {
        distance[i] = distance_to(edges[i].a, edges[i].b, place);
        nearest = std::min(nearest, distance[i]);
    }
    for (std::size_t i = 0; i < edges.size(); ++i) {
        const bool wanted = std::find(sides.begin(), sides.end(), edges[i].side) != sides.end();
        if (wanted && distance[i] <= nearest + rounding) return true;
    }
    return false;
}

double extent(std::span<const Point> positions) {
    double west = positions[0].x, east = west, south = positions[0].y, north = south;
    for (const Point& p : positions) {
        west = std::min(west, p.x), east = std::max(east, p.x);
        south = std::min(south, p.y), north = std::max(north, p.y);
    }
    return std::max(east - west, north - south);
}

void open_sides(const std::vector<Side>& sides, const Rim& rim, std::span<const Point> plane_m,
                std::vector<Boundary>& outlets) {
    const std::vector<Edge> edges = edges_of(rim.rings);
    const double rounding = 1e-9 * extent(plane_m);
    std::vector<double> distance;
    for (std::size_t node = 0; node < outlets.size(); ++node) {
        if (rim.boundary[node] != Boundary::open) continue;
        if (lies_on(sides, edges, plane_m[node], rounding, distance)) outlets[node] = Boundary::base_level;
    }
}

void open_where_low(double share, const Rim& rim, std::span<const double> uplift, std::vector<Boundary>& outlets) {
    const double limit = share * *std::max_element(uplift.begin(), uplift.end());
    for (std::size_t node = 0; node < outlets.size(); ++node) {
        if (rim.boundary[node] == Boundary::open && uplift[node] < limit) outlets[node] = Boundary::base_level;
    }
}

std::string without_outlet(const Outlets& rule) {
    if (rule.rule == OutletRule::sides) {
        std::string names;
        for (const Side side : rule.sides) {
            for (const auto& [word, value] : words(Side{})) {
                if (value == side) names += (names.empty() ? "" : " or ") + std::string(word);
            }
        }
        return fmt::format("outlets: no part of the domain's outline faces {}: name other sides", names);
    }
    return fmt::format(
        "outlets: nowhere on the rim is the uplift below {} of its largest value: raise uplift_below, or choose a "
        "pattern "
        "that falls toward the rim",
        rule.uplift_below);
}

}  // namespace

Side facing(const Point& a, const Point& b) {
    // The domain lies to the left of a → b; clockwise from north its outward normal points along (dy, −dx).
    const double azimuth = std::atan2(b.y - a.y, a.x - b.x);
    return static_cast<Side>((static_cast<int>(std::lround(azimuth / (std::numbers::pi / 4))) + 8) % 8);
}

std::vector<Boundary> choose_outlets(const Outlets& rule, const Rim& rim, std::span<const Point> plane_m,
                                     std::span<const double> uplift) {
    std::vector<Boundary> outlets(rim.boundary.size(), Boundary::interior);
    const bool has_dem = rim.dem_outlet != none;
    if (rule.rule == OutletRule::dem && !has_dem) throw Error("outlets = \"dem\" needs domain.dem");
    if (rule.rule == OutletRule::sides) open_sides(rule.sides, rim, plane_m, outlets);
    if (rule.rule == OutletRule::uplift_below) open_where_low(rule.uplift_below, rim, uplift, outlets);
    for (std::size_t node = 0; rule.rule == OutletRule::all && node < outlets.size(); ++node) {
        if (rim.boundary[node] == Boundary::open) outlets[node] = Boundary::base_level;
    }
    const bool takes_dems = rule.rule == OutletRule::all || rule.rule == OutletRule::dem;
    if (takes_dems && has_dem) outlets[rim.dem_outlet] = Boundary::base_level;
    if (std::find(outlets.begin(), outlets.end(), Boundary::base_level) == outlets.end()) {
        throw Error(without_outlet(rule));
    }
    return outlets;
}

}  // namespace thalweg::study
