// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cmath>

#include "thalweg/channel/slope_area.hpp"

namespace thalweg::channel {

namespace {

/// At most 65 536 of the heights, evenly spread over the array, ascending.
std::vector<double> sorted_sample(std::span<const double> elevation_m) {
    constexpr std::size_t most = 65536;
    std::vector<double> sample;
    const double stride = std::max(1.0, static_cast<double>(elevation_m.size()) / most);
    for (double at = 0; at < static_cast<double>(elevation_m.size()); at += stride) {
        const double height = elevation_m[static_cast<std::size_t>(at)];
        if (std::isfinite(height)) sample.push_back(height);
    }
    std::ranges::sort(sample);
    return sample;
}

/// Heights that differ by more than `tolerance`, and of those only the ones seen at least `least` times.
std::vector<double> distinct(const std::vector<double>& sorted, double tolerance, std::size_t least) {
    std::vector<double> kept;
    for (std::size_t first = 0, last = 0; first < sorted.size(); first = last) {
        while (last < sorted.size() && sorted[last] - sorted[first] <= tolerance) ++last;
        if (last - first >= least) kept.push_back(sorted[first]);
    }
    return kept;
}

/// Greatest common divisor of the gaps between heights, each known to `rounding` (Euclid's algorithm, small gaps first
/// so that errors stay small, on a running mean of the divisor). 0 once it falls under `smallest`.
double common_divisor(const std::vector<double>& heights, double rounding, double smallest) {
    std::vector<double> gaps;
    for (std::size_t i = 1; i < heights.size(); ++i) gaps.push_back(heights[i] - heights[i - 1]);
    std::ranges::sort(gaps);
    double divisor = gaps.front(), distance = 0, steps = 0;
    for (double gap : gaps) {
        double rest = std::abs(std::remainder(gap, divisor));
        while (rest > 2 * rounding * (1 + gap / divisor)) {
            gap = divisor;
            divisor = rest;
            distance = steps = 0;
            if (divisor < smallest) return 0;
            rest = std::abs(std::remainder(gap, divisor));
        }
        distance += gap;
        steps += std::round(gap / divisor);
        divisor = distance / steps;
    }
    return divisor < smallest - rounding ? 0 : divisor;
}

}  // namespace

double vertical_quantum(std::span<const double> elevation_m, double smallest_m) {
    const std::vector<double> sample = sorted_sample(elevation_m);
    if (sample.empty()) return 0;
    const double largest = std::max(std::abs(sample.front()), std::abs(sample.back()));
    const double rounding = largest * 0x1p-23 + 1e-9;  // of a difference of two heights in single precision
    std::vector<double> heights = distinct(sample, 2 * rounding, 2);
    std::vector<double> all = distinct(sample, 2 * rounding, 1);
    // A quantised DEM repeats its heights; then those seen once are what is foreign in it.
    if (heights.size() < 2 || 2 * heights.size() < all.size()) heights = std::move(all);
    if (heights.size() < 2) return 0;
    const double least = std::max(smallest_m, 8 * rounding);  // finer, and rounding alone would look like it
    const double quantum = common_divisor(heights, rounding, least);
    if (quantum == 0) return 0;
    const auto fits = [&](double height) {
        return std::abs(std::remainder(height - heights.front(), quantum)) <= 2 * rounding;
    };
    const auto fitting = std::ranges::count_if(sample, fits);
    return 100 * static_cast<std::size_t>(fitting) >= 99 * sample.size() ? quantum : 0;
}

}  // namespace thalweg::channel
