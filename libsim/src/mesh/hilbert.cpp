// SPDX-License-Identifier: GPL-3.0-or-later
#include "thalweg/mesh/hilbert.hpp"

#include <algorithm>
#include <array>
#include <cstdint>

namespace thalweg::mesh {
namespace {

constexpr int levels = 16;

/// Place of cell (x, y) on the curve: one quadrant per level, mirrored and turned as the curve enters it.
std::uint32_t place_on_curve(std::uint32_t x, std::uint32_t y) {
    std::uint32_t place = 0;
    for (std::uint32_t side = 1u << (levels - 1); side > 0; side >>= 1) {
        const std::uint32_t right = (x & side) != 0;
        const std::uint32_t upper = (y & side) != 0;
        place = place << 2 | ((3 * right) ^ upper);
        const std::uint32_t mirror = upper == 0 && right ? ~0u : 0u;
        x ^= mirror;
        y ^= mirror;
        const std::uint32_t turned = upper == 0 ? x ^ y : 0u;
        x ^= turned;
        y ^= turned;
    }
    return place;
}

/// The places in the high words, the points' numbers in the low ones.
std::vector<std::uint64_t> keys_of(std::span<const Point> points) {
    Point low = points.front();
    Point high = low;
    for (const Point& p : points) {
        low = {std::min(low.x, p.x), std::min(low.y, p.y)};
        high = {std::max(high.x, p.x), std::max(high.y, p.y)};
    }
    const double extent = std::max(high.x - low.x, high.y - low.y);
    const double scale = extent > 0 ? 65535.99 / extent : 0;
    std::vector<std::uint64_t> keys(points.size());
    for (std::size_t i = 0; i < points.size(); ++i) {
        const auto x = static_cast<std::uint32_t>((points[i].x - low.x) * scale);
        const auto y = static_cast<std::uint32_t>((points[i].y - low.y) * scale);
        keys[i] = std::uint64_t{place_on_curve(x, y)} << 32 | i;
    }
    return keys;
}

/// Stable counting sort by 11 bits from `shift` on.
void sort_by_digit(const std::vector<std::uint64_t>& from, std::vector<std::uint64_t>& to, int shift) {
    constexpr std::uint64_t mask = (1u << 11) - 1;
    std::array<std::size_t, mask + 2> start{};
    for (const std::uint64_t key : from) ++start[(key >> shift & mask) + 1];
    for (std::size_t digit = 0; digit <= mask; ++digit) start[digit + 1] += start[digit];
    for (const std::uint64_t key : from) to[start[key >> shift & mask]++] = key;
}

}  // namespace

std::vector<Index> hilbert_order(std::span<const Point> points) {
    if (points.empty()) return {};
    std::vector<std::uint64_t> keys = keys_of(points);
    std::vector<std::uint64_t> other(keys.size());
    for (int shift = 32; shift < 64; shift += 11) {
        sort_by_digit(keys, other, shift);
        keys.swap(other);
    }
    std::vector<Index> order(keys.size());
    std::transform(keys.begin(), keys.end(), order.begin(), [](std::uint64_t key) { return static_cast<Index>(key); });
    return order;
}

}  // namespace thalweg::mesh
