// SPDX-License-Identifier: GPL-3.0-or-later
#include "thalweg/mesh/points.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "mesh/fill.hpp"
#include "mesh/outline.hpp"
#include "thalweg/core/error.hpp"
#include "thalweg/core/random.hpp"
#include "thalweg/mesh/triangulate.hpp"

namespace thalweg::mesh {
namespace {

double distance(const Point& a, const Point& b) { return std::hypot(b.x - a.x, b.y - a.y); }

/// How many points inside fill one square of the spacing, and how wide a strip along the outline they leave free, in
/// spacings. Those of Poisson disks are measured on squares of 1e2 to 1e6 points.
struct Density {
    double per_square;
    double strip;
};
Density density(PointPattern pattern) {
    if (pattern == PointPattern::poisson) return {0.698, 0.534};
    return pattern == PointPattern::regular ? Density{1, 0.5} : Density{std::sqrt(4.0 / 3), 0.5};
}

double area_of(const Rings& rings) {
    double area = 0;
    for (const Polygon& ring : rings) area += polygon_area(ring);
    return area;
}

/// How many points a spacing is expected to give: those on the outline are counted, those inside fill what is more than
/// half a spacing or so from it.
double expected_count(const Rings& rings, PointPattern pattern, double area, double spacing) {
    double on_outline = 0;
    double length = 0;
    for (const Polygon& ring : rings) {
        for (std::size_t i = 0; i < ring.size(); ++i) {
            const Point& a = ring[i];
            const Point& b = ring[(i + 1) % ring.size()];
            on_outline += pieces_of_side(a, b, {spacing, spacing});
            length += distance(a, b);
        }
    }
    const auto [per_square, strip] = density(pattern);
    return on_outline + per_square * std::max(0.0, area - strip * length * spacing) / (spacing * spacing);
}

double expected_spacing(const Rings& rings, PointPattern pattern, double count) {
    const double area = area_of(rings);
    const double first_side = distance(rings[0][0], rings[0][1]);
    double low = std::sqrt(area / count) / 1e3;
    double high = std::sqrt(area) + first_side;
    while (expected_count(rings, pattern, area, high) > count && high < 1e3 * first_side) high *= 2;
    for (int halving = 0; halving < 60; ++halving) {
        const double middle = std::sqrt(low * high);
        (expected_count(rings, pattern, area, middle) > count ? low : high) = middle;
    }
    return std::sqrt(low * high);
}

/// How many points may be put on the outline beyond what the spacing asks: a few to hit a small count; where the count
/// leaps with the spacing (a strip whose middle fills all at once), in the end enough to cross the leap.
double largest_extra(int attempt, Index count) {
    if (attempt <= 4) return 0;
    return attempt <= 20 ? 4 : std::min(0.25 * count, 1000.0);
}

void check_count(const Rings& rings, Index count) {
    if (count < 16 || count > Index{1} << 31) {
        throw Error(fmt::format("a mesh needs 16 to 2147483648 nodes, not {}", count));
    }
    std::size_t corners = 0;
    for (const Polygon& ring : rings) corners += ring.size();
    if (static_cast<double>(corners) > 1.02 * count) {
        throw Error(
            fmt::format("the outline alone has {} corners, more than the {} nodes asked for: ask for more nodes or "
                        "simplify the outline",
                        corners, count));
    }
}

PointSet fill(const Rings& rings, PointPattern pattern, double spacing, double stretch, int extra, std::uint64_t seed) {
    return pattern == PointPattern::poisson ? fill_poisson(rings, spacing, extra, seed)
                                            : fill_lattice(rings, pattern, spacing, stretch, extra);
}

}  // namespace

PointSet place_points(const PolygonPart& domain, PointPattern pattern, double spacing_m, std::uint64_t seed) {
    if (!(spacing_m > 0) || std::isinf(spacing_m)) {
        throw Error(fmt::format("points need a positive spacing, not {} m", spacing_m));
    }
    return fill(checked_rings(domain), pattern, spacing_m, 1, 0, seed);
}

PointSet place_points_count(const PolygonPart& domain, PointPattern pattern, Index count, std::uint64_t seed) {
    const Rings rings = checked_rings(domain);
    check_count(rings, count);
    double spacing = expected_spacing(rings, pattern, count);
    double stretch = 1;
    Random jitter(seed, 0x636f756e);
    int extra = 0;
    PointSet near_miss{};
    // A large set is met by the first or second spacing. A small one may need a certain number exactly: then what is
    // missing is put on the outline, at a spacing jittered until the two together make it.
    for (int attempt = 0; attempt < 200; ++attempt) {
        PointSet set = fill(rings, pattern, spacing, stretch, extra, seed);
        const double missing = static_cast<double>(count) - static_cast<double>(set.points.size());
        if (std::abs(missing) <= 0.02 * count) return set;
        const double ratio = static_cast<double>(set.points.size()) / count;
        if (std::abs(missing) <= 1) near_miss = std::move(set);
        if (extra == 0 && missing > 0 && missing <= largest_extra(attempt, count)) {
            extra = static_cast<int>(missing);
        } else {
            spacing *= std::pow(ratio, 0.5);
            if (attempt >= 4) {
                spacing *= 0.95 + 0.1 * jitter.uniform();
                // A lattice of whole rows and columns takes few counts unless its steps may differ a little.
                if (pattern != PointPattern::poisson) stretch = 0.97 + 0.06 * jitter.uniform();
            }
            extra = 0;
        }
    }
    if (!near_miss.points.empty()) return near_miss;
    throw Error(fmt::format("no spacing gives {} points in this outline of {} corners: ask for more, or for a spacing",
                            count, rings.front().size()));
}

PointSet poisson_disk(const Polygon& outline, double spacing_m, std::uint64_t seed) {
    return place_points({outline, {}}, PointPattern::poisson, spacing_m, seed);
}

PointSet poisson_disk_count(const Polygon& outline, Index count, std::uint64_t seed) {
    return place_points_count({outline, {}}, PointPattern::poisson, count, seed);
}

}  // namespace thalweg::mesh
