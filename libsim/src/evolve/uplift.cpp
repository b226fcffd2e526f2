// SPDX-License-Identifier: GPL-3.0-or-later
#include "thalweg/evolve/uplift.hpp"

#include <algorithm>
#include <cmath>

namespace thalweg::evolve {
namespace {

struct Box {
    Point low, high;
};

Box bounding_box(std::span<const Point> positions) {
    Box box{positions[0], positions[0]};
    for (const Point& p : positions) {
        box.low = {std::min(box.low.x, p.x), std::min(box.low.y, p.y)};
        box.high = {std::max(box.high.x, p.x), std::max(box.high.y, p.y)};
    }
    return box;
}

std::vector<double> radial(std::span<const Point> positions, double maximum) {
    const Box box = bounding_box(positions);
    const Point middle{(box.low.x + box.high.x) / 2, (box.low.y + box.high.y) / 2};
    const double radius = std::min(box.high.x - box.low.x, box.high.y - box.low.y) / 2;
    std::vector<double> values;
    values.reserve(positions.size());
    for (const Point& p : positions) {
        const double distance = std::hypot(p.x - middle.x, p.y - middle.y);
        values.push_back(distance < radius ? maximum * (1 - distance / radius) : 0.0);
    }
    return values;
}

}  // namespace

std::vector<double> pattern_values(Pattern pattern, std::span<const Point> positions, double maximum) {
    if (positions.empty()) return {};
    if (pattern == Pattern::radial) return radial(positions, maximum);
    return std::vector<double>(positions.size(), maximum);
}

}  // namespace thalweg::evolve
