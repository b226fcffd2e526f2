// SPDX-License-Identifier: GPL-3.0-or-later
#include "thalweg/channel/extent.hpp"

#include <algorithm>
#include <cmath>

namespace thalweg::channel {

namespace {

constexpr int class_count = 50;

/// Mouth link of the largest river, `none` without links.
Index largest_mouth(const StreamNetwork& network) {
    Index best = none;
    for (Index link = 0; link < network.size(); ++link) {
        if (network.downstream[link] != none) continue;
        if (best == none || network.area_m2[link] > network.area_m2[best]) best = link;
    }
    return best;
}

/// Distance of each link's lower and upper end from the mouth; NaN for links of other rivers.
struct Reach {
    double from, to;
};

std::vector<Reach> reaches(const StreamNetwork& network, Index mouth) {
    std::vector<Reach> all;
    for (Index link = 0; link < network.size(); ++link) {
        const Index below = network.downstream[link];
        const double from = link == mouth ? 0 : below == none ? std::nan("") : all[below].to;
        all.push_back({from, from + network.length_m[link]});
    }
    return all;
}

}  // namespace

WidthFunction width_function(const StreamNetwork& network) {
    const Index mouth = largest_mouth(network);
    if (mouth == none) return {};
    const auto all = reaches(network, mouth);
    double farthest = 0;
    for (const Reach& reach : all) farthest = std::max(farthest, std::isnan(reach.to) ? 0 : reach.to);
    const double width = farthest / class_count;
    WidthFunction result;
    result.links.assign(class_count, 0);
    for (const Reach& reach : all) {
        if (std::isnan(reach.from)) continue;
        const int last = std::min(static_cast<int>(reach.to / width), class_count - 1);
        for (int i = static_cast<int>(reach.from / width); i <= last; ++i) {
            const double inside = std::min(reach.to, (i + 1) * width) - std::max(reach.from, i * width);
            result.links[i] += std::max(0.0, inside) / width;
        }
    }
    for (int i = 0; i < class_count; ++i) result.distance_m.push_back((i + 0.5) * width);
    return result;
}

PowerLawFit area_exceedance(std::span<const double> drainage_area_m2, std::span<const std::uint8_t> used,
                            double smallest_m2, double largest_m2) {
    constexpr int per_decade = 10;
    const double decades = std::log10(largest_m2) - std::log10(smallest_m2);  // their ratio may overflow
    const int steps = decades > 0 ? static_cast<int>(per_decade * decades) + 1 : 0;
    std::vector<double> area, share(steps, 0);
    for (int i = 0; i < steps; ++i) area.push_back(smallest_m2 * std::pow(10.0, static_cast<double>(i) / per_decade));
    double nodes = 0;
    for (std::size_t node = 0; node < drainage_area_m2.size(); ++node) {
        if (!used.empty() && !used[node]) continue;
        ++nodes;
        if (!(drainage_area_m2[node] >= smallest_m2)) continue;
        const auto reached = std::ranges::upper_bound(area, drainage_area_m2[node]) - area.begin();
        if (reached > 0) ++share[reached - 1];
    }
    for (int i = steps - 1; i-- > 0;) share[i] += share[i + 1];
    for (double& each : share) each /= nodes;
    return fit_power_law(area, share);
}

}  // namespace thalweg::channel
