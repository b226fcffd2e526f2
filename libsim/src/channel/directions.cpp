// SPDX-License-Identifier: GPL-3.0-or-later
#include "channel/directions.hpp"

#include <cmath>
#include <numbers>

namespace thalweg::channel {

std::vector<JunctionInflows> junction_inflows(const StreamNetwork& network) {
    std::vector<JunctionInflows> all(network.size());
    for (Index link = 0; link < network.size(); ++link) {
        if (network.downstream[link] == none) continue;
        JunctionInflows& below = all[network.downstream[link]];
        if (below.count < 2) below.link[below.count] = link;
        ++below.count;
    }
    return all;
}

Point upstream_direction(std::span<const Index> nodes, const OffsetOf& offset, double reach_m) {
    double along = 0;
    std::size_t at = nodes.size() - 1;
    while (at > 0 && along < reach_m) {
        const Point step = offset(nodes[at], nodes[at - 1]);
        along += std::hypot(step.x, step.y);
        --at;
    }
    return offset(nodes.back(), nodes[at]);
}

Point downstream_direction(std::span<const Index> nodes, const OffsetOf& offset, double reach_m) {
    double along = 0;
    std::size_t at = 0;
    while (at + 1 < nodes.size() && along < reach_m) {
        const Point step = offset(nodes[at], nodes[at + 1]);
        along += std::hypot(step.x, step.y);
        ++at;
    }
    return offset(nodes.front(), nodes[at]);
}

double turn(const Point& from, const Point& to) {
    const double angle = std::atan2(from.x * to.y - from.y * to.x, from.x * to.x + from.y * to.y);
    return angle < 0 ? angle + 2 * std::numbers::pi : angle;
}

double angle_between(const Point& a, const Point& b) {
    return std::abs(std::atan2(a.x * b.y - a.y * b.x, a.x * b.x + a.y * b.y));
}

std::array<Index, 2> main_and_tributary(const StreamNetwork& network, const JunctionInflows& in) {
    const auto [a, b] = in.link;
    return network.area_m2[b] > network.area_m2[a] ? std::array{b, a} : std::array{a, b};
}

bool is_left_of(const StreamNetwork& network, const OffsetOf& offset, double reach_m, const Meeting& m) {
    const Point down = downstream_direction(network.nodes_of(m.below), offset, reach_m);
    return turn(down, upstream_direction(network.nodes_of(m.tributary), offset, reach_m)) <
           turn(down, upstream_direction(network.nodes_of(m.main), offset, reach_m));
}

}  // namespace thalweg::channel
