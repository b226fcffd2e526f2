// SPDX-License-Identifier: GPL-3.0-or-later
#include "thalweg/channel/profile.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "thalweg/core/random.hpp"

namespace thalweg::channel {

namespace {

constexpr double nan = std::numeric_limits<double>::quiet_NaN();
constexpr double theta_step = 0.025;
constexpr int theta_count = 61;  // 0 to 1.5

/// Sums over one river from which the straightness of elevation over χ follows.
struct Sums {
    double nodes = 0, x = 0, y = 0, xx = 0, xy = 0, yy = 0;

    /// nodes·(1 − R²); 0 where nothing can be told
    double misfit() const {
        const double sxx = xx - x * x / nodes, sxy = xy - x * y / nodes, syy = yy - y * y / nodes;
        return sxx > 0 && syy > 0 ? nodes * std::max(0.0, 1 - sxy * sxy / (sxx * syy)) : 0;
    }
};

/// Elevations above each river's base, so that the sums keep their digits.
std::vector<double> heights_above_base(const Profile& profile) {
    std::vector<double> height(profile.size(), 0);
    for (Index i = 0; i < profile.size(); ++i) {
        const Index below = profile.below[i];
        if (below != none) height[i] = height[below] + (profile.elevation_m[i] - profile.elevation_m[below]);
    }
    return height;
}

std::vector<double> misfits(const Profile& profile, std::span<const double> chi_m, std::span<const double> height_m,
                            Index rivers) {
    std::vector<Sums> sums(rivers);
    for (Index i = 0; i < profile.size(); ++i) {
        Sums& sum = sums[profile.river[i]];
        const double x = chi_m[i], y = height_m[i];
        ++sum.nodes;
        sum.x += x;
        sum.y += y;
        sum.xx += x * x;
        sum.xy += x * y;
        sum.yy += y * y;
    }
    std::vector<double> result;
    for (const Sums& sum : sums) result.push_back(sum.misfit());
    return result;
}

std::vector<Index> river_sizes(const Profile& profile) {
    std::vector<Index> sizes;
    for (const Index river : profile.river) {
        if (river >= sizes.size()) sizes.resize(river + 1, 0);
        ++sizes[river];
    }
    return sizes;
}

/// Misfit by θ (rows) and river, of the rivers that count.
std::vector<std::vector<double>> misfit_table(const Profile& profile, Index smallest_river) {
    const auto sizes = river_sizes(profile);
    const auto height = heights_above_base(profile);
    std::vector<std::vector<double>> table;
    for (int i = 0; i < theta_count; ++i) {
        const auto chi_m = chi(profile, i * theta_step, 1e6);
        const auto all = misfits(profile, chi_m, height, static_cast<Index>(sizes.size()));
        std::vector<double>& row = table.emplace_back();
        for (std::size_t river = 0; river < sizes.size(); ++river) {
            if (sizes[river] >= smallest_river) row.push_back(all[river]);
        }
    }
    return table;
}

/// Where the parabola through the least value and its two neighbours has its vertex; NaN at an end.
double least_at(const std::vector<double>& misfit) {
    const auto least = std::ranges::min_element(misfit) - misfit.begin();
    if (least == 0 || least + 1 == theta_count) return nan;
    const double left = misfit[least - 1], middle = misfit[least], right = misfit[least + 1];
    const double curvature = left - 2 * middle + right;
    const double shift = curvature > 0 ? (left - right) / (2 * curvature) : 0;
    return (static_cast<double>(least) + shift) * theta_step;
}

std::vector<double> added_up(const std::vector<std::vector<double>>& table, const std::vector<double>& times) {
    std::vector<double> sums;
    for (const auto& row : table) {
        double& sum = sums.emplace_back(0);
        for (std::size_t river = 0; river < row.size(); ++river) sum += times[river] * row[river];
    }
    return sums;
}

Estimate with_bootstrap(double value, const std::vector<std::vector<double>>& table, const ConcavityOptions& options) {
    Random random(options.seed, 0);
    const auto rivers = static_cast<Index>(table.front().size());
    std::vector<double> values;
    for (Index resample = 0; resample < options.resamples; ++resample) {
        std::vector<double> times(rivers, 0);
        for (Index draw = 0; draw < rivers; ++draw) ++times[random.below(rivers)];
        const double theta = least_at(added_up(table, times));
        if (!std::isnan(theta)) values.push_back(theta);
    }
    return {value, standard_deviation(values), {quantile(values, 0.025), quantile(values, 0.975)}};
}

/// The first place downstream that lies lower; on a level reach not each of its nodes is looked at again and again.
/// (Where water climbs, "lower" is lower than some node of the climb; no place in between can be the sought one.)
std::vector<Index> next_lower(const Profile& profile) {
    std::vector<Index> lower(profile.size(), none);
    for (Index i = 0; i < profile.size(); ++i) {
        const Index below = profile.below[i];
        const bool falls = below != none && profile.elevation_m[below] < profile.elevation_m[i];
        lower[i] = falls || below == none ? below : lower[below];
    }
    return lower;
}

}  // namespace

Profile channel_profile(const terrain::FlowGraph& graph, std::span<const std::uint8_t> channel,
                        std::span<const double> drainage_area_m2, std::span<const double> elevation_m) {
    Profile profile;
    std::vector<Index> place(graph.size(), none);
    Index rivers = 0;
    for (const Index node : graph.order) {
        if (!channel[node]) continue;
        const Index receiver = graph.receiver[node];
        const Index below = receiver == none ? none : place[receiver];
        place[node] = profile.size();
        profile.node.push_back(node);
        profile.below.push_back(below);
        profile.river.push_back(below == none ? rivers++ : profile.river[below]);
        profile.length_m.push_back(below == none ? 0 : graph.length[node]);
        profile.area_m2.push_back(drainage_area_m2[node]);
        profile.elevation_m.push_back(elevation_m[node]);
    }
    return profile;
}

std::vector<double> chi(const Profile& profile, double theta, double reference_area_m2) {
    std::vector<double> result(profile.size(), 0);
    for (Index i = 0; i < profile.size(); ++i) {
        if (profile.below[i] == none) continue;
        const double step = profile.length_m[i] * std::pow(reference_area_m2 / profile.area_m2[i], theta);
        result[i] = result[profile.below[i]] + step;
    }
    return result;
}

std::vector<double> steepness(const Profile& profile, std::span<const double> chi_m, double theta,
                              double reference_area_m2, double smallest_drop_m) {
    const double scale = std::pow(reference_area_m2, theta);
    const double enough = smallest_drop_m * (1 - 1e-9);  // a whole drop is not missed by rounding
    const std::vector<Index> lower = next_lower(profile);
    std::vector<double> result(profile.size(), nan);
    for (Index i = 0; i < profile.size(); ++i) {
        Index at = profile.below[i];
        while (at != none && profile.elevation_m[i] - profile.elevation_m[at] < enough) at = lower[at];
        if (at == none) continue;
        result[i] = scale * (profile.elevation_m[i] - profile.elevation_m[at]) / (chi_m[i] - chi_m[at]);
    }
    return result;
}

Estimate concavity_by_chi(const Profile& profile, const ConcavityOptions& options) {
    Estimate unknown{nan, nan, {nan, nan}};
    const auto table = misfit_table(profile, options.smallest_river);
    const std::size_t rivers = table.front().size();
    if (rivers == 0) return unknown;
    const double value = least_at(added_up(table, std::vector<double>(rivers, 1)));
    if (std::isnan(value) || rivers < options.smallest_sample) {
        unknown.value = value;
        return unknown;
    }
    return with_bootstrap(value, table, options);
}

}  // namespace thalweg::channel
