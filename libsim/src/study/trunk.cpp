// SPDX-License-Identifier: GPL-3.0-or-later
#include "study/trunk.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <utility>

#include "thalweg/core/error.hpp"
#include "thalweg/mesh/predicates.hpp"

namespace thalweg::study {
namespace {

Point between(const Point& a, const Point& b, double share) {
    return {a.x + share * (b.x - a.x), a.y + share * (b.y - a.y)};
}

double distance(const Point& a, const Point& b) { return std::hypot(b.x - a.x, b.y - a.y); }

/// A river and those of its places that a trunk goes over.
struct Followed {
    std::vector<Point> river;  ///< smoothed, but where that is no use
    const std::vector<Point>& as_it_was;
    std::vector<std::size_t> places;      ///< ascending, with both ends
    std::vector<std::uint8_t> is_no_use;  ///< of the river's places
};

/// The place of a stretch of the river that is farthest off the straight line; its first one if none is.
std::size_t furthest_off(const Followed& f, std::size_t first, std::size_t last, double at_least_m) {
    const Polygon chord{f.river[first], f.river[last]};
    std::size_t at = first;
    for (std::size_t i = first + 1; i < last; ++i) {
        const double off = distance(grow::nearest_on_outline(chord, f.river[i]), f.river[i]);
        if (off > at_least_m && !f.is_no_use[i]) at_least_m = off, at = i;
    }
    return at;
}

/// As many places as it takes to stay within a distance of all others (Douglas & Peucker 1973).
void choose_places(Followed& f, double within_m) {
    std::vector<std::array<std::size_t, 2>> waiting{{0, f.river.size() - 1}};
    f.places = {0, f.river.size() - 1};
    while (!waiting.empty()) {
        const auto [first, last] = waiting.back();
        waiting.pop_back();
        const std::size_t at = furthest_off(f, first, last, within_m);
        if (at == first) continue;
        f.places.push_back(at);
        waiting.push_back({first, at});
        waiting.push_back({at, last});
    }
    std::ranges::sort(f.places);
}

/// Goes nearer to the river where the trunk leaves the basin, leaves out bends that cannot be, and ends below what
/// cannot be mended.
void mend(const grow::TrunkError& error, Followed& f) {
    const std::size_t first = f.places[error.place];
    const auto here = f.places.begin() + static_cast<std::ptrdiff_t>(error.place);
    if (error.fault == grow::TrunkFault::bend) {
        if (f.river[first] != f.as_it_was[first]) {
            f.river[first] = f.as_it_was[first];
        } else {
            f.is_no_use[first] = 1;
            f.places.erase(here);
        }
        return;
    }
    const std::size_t second = f.places[error.place + 1];
    const std::size_t between_them = furthest_off(f, first, second, 0);
    if (error.fault == grow::TrunkFault::piece_leaves && between_them != first) {
        f.places.insert(here + 1, between_them);
    } else if (error.fault == grow::TrunkFault::piece_leaves && f.river[second] != f.as_it_was[second]) {
        f.river[second] = f.as_it_was[second];
    } else if (error.fault == grow::TrunkFault::piece_leaves && error.place + 2 < f.places.size()) {
        f.is_no_use[second] = 1;
        f.places.erase(here + 1);
    } else {
        f.places.erase(here + 1, f.places.end());
    }
}

grow::Basin with_trunk(grow::Basin basin, const Followed& f) {
    basin.source = f.river[f.places.back()];
    basin.bends.clear();
    for (std::size_t i = 1; i + 1 < f.places.size(); ++i) basin.bends.push_back(f.river[f.places[i]]);
    return basin;
}

bool crosses_outline(const Polygon& outline, const Point& from, const Point& to) {
    for (std::size_t i = 0; i < outline.size(); ++i) {
        if (mesh::segments_cross(from, to, outline[i], outline[(i + 1) % outline.size()])) return true;
    }
    return false;
}

/// Whether a network can grow from this trunk.
bool is_trunk(const grow::Basin& basin, const grow::Dials& dials) {
    try {
        grow::check_trunk(basin, dials);
        return true;
    } catch (const Error&) {
        return false;
    }
}

/// Whether the line from the outlet to the source, widened by 1 % of its length but near the outlet, stays inside.
bool is_clear(const Polygon& outline, const Point& outlet, const Point& source) {
    constexpr double clearance = 0.01;
    const Point aside{-clearance * (source.y - outlet.y), clearance * (source.x - outlet.x)};
    const Point near = between(outlet, source, 0.1);
    const Point beyond = between(outlet, source, 1 + clearance);
    if (crosses_outline(outline, between(outlet, source, 1e-6), beyond)) return false;
    for (const double side : {-1.0, 1.0}) {
        const Point from{near.x + side * aside.x, near.y + side * aside.y};
        const Point to{beyond.x + side * aside.x, beyond.y + side * aside.y};
        if (crosses_outline(outline, near, from) || crosses_outline(outline, from, to)) return false;
    }
    return true;
}

}  // namespace

std::vector<Point> smoothed(const std::vector<Point>& line, std::size_t half_window) {
    std::vector<Point> sum{{0, 0}}, smooth;
    for (const Point& p : line) {
        sum.push_back({sum.back().x + p.x - line[0].x, sum.back().y + p.y - line[0].y});  // near 0 digits are kept
    }
    for (std::size_t i = 0; i < line.size(); ++i) {
        const std::size_t half = std::min({half_window, i, line.size() - 1 - i});
        const Point &upto = sum[i + half + 1], &before = sum[i - half];
        const double count = static_cast<double>(2 * half + 1);
        smooth.push_back({line[0].x + (upto.x - before.x) / count, line[0].y + (upto.y - before.y) / count});
    }
    return smooth;
}

double follow_river(const std::vector<Point>& river, std::vector<Point> smooth, const grow::Dials& dials,
                    grow::Basin& basin) {
    Followed f{.river = std::move(smooth),
               .as_it_was = river,
               .places = {},
               .is_no_use = std::vector<std::uint8_t>(river.size(), 0)};
    choose_places(f, dials.channel_maintenance_m / 2);
    std::size_t tries_left = 20 + 4 * f.places.size();  // real rivers take up to half their places
    for (; tries_left > 0 && f.places.size() > 1; --tries_left) {
        const grow::Basin tried = with_trunk(basin, f);
        try {
            grow::check_trunk(tried, dials);
            basin = tried;
            return static_cast<double>(f.places.back()) / static_cast<double>(river.size() - 1);
        } catch (const grow::TrunkError& error) {
            mend(error, f);
        } catch (const Error&) {
            f.places.pop_back();
        }
    }
    return 0;
}

double see_river(const std::vector<Point>& river, const grow::Dials& dials, grow::Basin& basin) {
    grow::Basin tried = basin;
    tried.bends.clear();
    // No more than some hundred places are tried: a stream is seen in stretches, not in single cells.
    const std::size_t step = std::max<std::size_t>(1, river.size() / 400);
    for (std::size_t at = river.size() - 1; at > 0; at -= std::min(at, step)) {
        tried.source = river[at];
        if (!is_clear(basin.outline, basin.outlet, river[at]) || !is_trunk(tried, dials)) continue;
        basin = tried;
        return static_cast<double>(at) / static_cast<double>(river.size() - 1);
    }
    return 0;
}

}  // namespace thalweg::study
