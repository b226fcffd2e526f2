// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <cmath>

#include "support/outlines.hpp"
#include "thalweg/core/error.hpp"
#include "thalweg/core/random.hpp"
#include "thalweg/grow/grow.hpp"
#include "thalweg/mesh/triangulate.hpp"

namespace support {

/// A basin with a square outline; the trunk runs from the middle of its southern side two thirds of the way north.
inline thalweg::grow::Basin square_basin(double side_m) {
    return {.outline = rectangle(side_m, side_m),
            .outlet = {side_m / 2, 0},
            .source = {side_m / 2, side_m * 2 / 3},
            .base_level_m = 100};
}

/// Outlines of every kind: convex, concave, sharp, thin, rectilinear, with corners on one line.
inline Polygon random_outline(thalweg::Random& random) {
    const auto seed = static_cast<std::uint64_t>(random.below(1u << 30));
    const int corners = 3 + static_cast<int>(random.below(40));
    Polygon outline;
    switch (random.below(8)) {
        case 0:
            outline = random_convex(corners, seed);
            break;
        case 1:
            outline = random_star(std::max(corners, 6), seed);
            break;
        case 2:
            outline = rectangle(1, 1);
            break;
        case 3:
            outline = rectangle(30, 1);
            break;
        case 4:
            outline = l_shape();
            break;
        case 5:
            outline = staircase(corners);
            break;
        case 6:
            outline = {{0, 0}, {10, 0}, {0, 1}};
            break;
        default:
            outline = random_star(200, seed);
            break;
    }
    const double size = std::pow(10, 1 + 4 * random.uniform());
    const double turn = random.below(2) ? 6.3 * random.uniform() : 0;
    const Point corner{5e5 * random.below(2), 5e6 * random.below(2)};  // half of them far from (0, 0), as maps are
    for (Point& p : outline) {
        p = {corner.x + size * (p.x * std::cos(turn) - p.y * std::sin(turn)),
             corner.y + size * (p.x * std::sin(turn) + p.y * std::cos(turn))};
    }
    if (random.below(2)) std::reverse(outline.begin(), outline.end());
    return outline;
}

/// A trunk that lies inside: from a corner or from within a side to any point that can be seen from there.
inline thalweg::grow::Basin random_basin(thalweg::Random& random) {
    thalweg::grow::Basin basin;
    basin.base_level_m = 1000 * random.uniform();
    basin.outline = random_outline(random);
    const auto [west, east] = std::minmax_element(basin.outline.begin(), basin.outline.end(),
                                                  [](const Point& a, const Point& b) { return a.x < b.x; });
    const auto [south, north] = std::minmax_element(basin.outline.begin(), basin.outline.end(),
                                                    [](const Point& a, const Point& b) { return a.y < b.y; });
    for (;;) {
        const auto side = random.below(static_cast<std::uint32_t>(basin.outline.size()));
        const double share = random.below(3) ? random.uniform() : 0.0;
        const Point& a = basin.outline[side];
        const Point& b = basin.outline[(side + 1) % basin.outline.size()];
        basin.outlet = {a.x + share * (b.x - a.x), a.y + share * (b.y - a.y)};
        basin.source = {west->x + random.uniform() * (east->x - west->x),
                        south->y + random.uniform() * (north->y - south->y)};
        try {
            return thalweg::grow::checked_basin(basin);
        } catch (const thalweg::Error&) {
        }
    }
}

/// The same with bends: the trunk goes to and fro about its straight line.
inline thalweg::grow::Basin random_bent_basin(thalweg::Random& random) {
    for (;;) {
        thalweg::grow::Basin basin = random_basin(random);
        const Point along{basin.source.x - basin.outlet.x, basin.source.y - basin.outlet.y};
        const auto bends = 1 + random.below(6);
        const double swing = 0.1 + 0.5 * random.uniform();
        for (std::uint32_t i = 1; i <= bends; ++i) {
            const double share = i / (bends + 1.0), aside = swing * (2 * random.uniform() - 1);
            basin.bends.push_back({basin.outlet.x + share * along.x - aside * along.y,
                                   basin.outlet.y + share * along.y + aside * along.x});
        }
        try {
            return thalweg::grow::checked_basin(basin);
        } catch (const thalweg::Error&) {
        }
    }
}

/// Dials over all they can be, for networks of up to a few hundred links.
inline thalweg::grow::Dials random_dials(thalweg::Random& random, const thalweg::grow::Basin& basin) {
    thalweg::grow::Dials dials;
    const double area = std::abs(thalweg::mesh::polygon_area(basin.outline));
    dials.channel_maintenance_m = std::sqrt(area / std::pow(10, 0.3 + 2.2 * random.uniform()));
    dials.mean_junction = random.uniform();
    dials.delta_junction = random.uniform();
    dials.mean_length = 0.05 + 0.95 * random.uniform();
    dials.delta_length = random.uniform();
    dials.flint = {.p = std::pow(10, -4 + 4 * random.uniform()), .q = -0.05 - 1.95 * random.uniform()};
    dials.delta_sidewall_angle_deg = 20 * random.uniform();
    dials.sidewall_angle_deg = 25 + 35 * random.uniform();
    dials.lower_bias = random.uniform();
    dials.middle_bias = random.uniform();
    dials.upstream_link =
        random.below(2) ? thalweg::grow::UpstreamLink::turns : thalweg::grow::UpstreamLink::keeps_line;
    dials.stop = random.below(2) ? thalweg::grow::Stop::links : thalweg::grow::Stop::density;
    dials.seed = random.below(1u << 30);
    dials.divides = random.below(2) ? thalweg::grow::Divides::shares : thalweg::grow::Divides::slopes;
    for (auto* divide : {&dials.divide_across, &dials.divide_below, &dials.divide_above}) {
        *divide = {.mean = 0.1 + 0.8 * random.uniform(), .delta = 0.8 * random.uniform()};
    }
    return dials;
}

}  // namespace support
