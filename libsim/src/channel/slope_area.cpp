// SPDX-License-Identifier: GPL-3.0-or-later
#include "thalweg/channel/slope_area.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

namespace thalweg::channel {

namespace {

constexpr double nan = std::numeric_limits<double>::quiet_NaN();

/// Sums over the points of one bin: weights, weighted logarithms, and what their scatter needs.
struct BinSum {
    double weight = 0, log_area = 0, log_slope = 0;
    double squares = 0;  ///< sum of (weight·(ln slope − mean))²
    Index count = 0;
};

SlopeAreaBin bin_of(const BinSum& sum) {
    const double slope = std::exp(sum.log_slope / sum.weight);
    const double n = sum.count;
    const double error = n > 1 ? std::sqrt(sum.squares * n / (n - 1)) / sum.weight : nan;
    return {
        .area_m2 = std::exp(sum.log_area / sum.weight), .slope = slope, .slope_se = slope * error, .count = sum.count};
}

/// Variance of a single point's ln slope, pooled over the bins that show any; 0 if none does.
double pooled_variance(std::span<const SlopeAreaBin> bins) {
    double squares = 0;
    double freedom = 0;
    for (const SlopeAreaBin& bin : bins) {
        if (bin.count < 2) continue;
        const double relative = bin.slope_se / bin.slope;
        squares += (bin.count - 1.0) * bin.count * relative * relative;
        freedom += bin.count - 1.0;
    }
    return freedom > 0 ? squares / freedom : 0;
}

}  // namespace

std::vector<SlopeAreaPoint> node_slopes(const terrain::FlowGraph& graph, std::span<const double> drainage_area_m2,
                                        std::span<const double> elevation_m, std::span<const std::uint8_t> used) {
    std::vector<SlopeAreaPoint> points;
    for (Index node = 0; node < graph.size(); ++node) {
        const Index receiver = graph.receiver[node];
        if (receiver == none || (!used.empty() && !used[node])) continue;
        const double slope = (elevation_m[node] - elevation_m[receiver]) / graph.length[node];
        if (slope > 0 && drainage_area_m2[node] > 0) points.push_back({drainage_area_m2[node], slope, 1, node});
    }
    return points;
}

std::vector<SlopeAreaBin> slope_area_bins(std::span<const SlopeAreaPoint> points, int bins_per_decade) {
    const auto bin = [&](const SlopeAreaPoint& point) {
        return static_cast<int>(std::floor(bins_per_decade * std::log10(point.area_m2)));
    };
    std::map<int, BinSum> sums;
    for (const SlopeAreaPoint& point : points) {
        BinSum& sum = sums[bin(point)];
        sum.weight += point.weight;
        sum.log_area += point.weight * std::log(point.area_m2);
        sum.log_slope += point.weight * std::log(point.slope);
        ++sum.count;
    }
    for (const SlopeAreaPoint& point : points) {
        BinSum& sum = sums[bin(point)];
        const double off = point.weight * (std::log(point.slope) - sum.log_slope / sum.weight);
        sum.squares += off * off;
    }
    std::vector<SlopeAreaBin> bins;
    for (const auto& [number, sum] : sums) bins.push_back(bin_of(sum));
    return bins;
}

std::vector<double> bin_errors(std::span<const SlopeAreaBin> bins, double smallest_se_dex) {
    constexpr double prior_freedom = 4;  // of 1 to 30 the one whose intervals cover best (tests of infer)
    const double smallest = smallest_se_dex * std::log(10.0);
    const double pooled = pooled_variance(bins);
    std::vector<double> errors;
    for (const SlopeAreaBin& bin : bins) {
        const double freedom = bin.count > 1 ? bin.count - 1.0 : 0.0;
        const double relative = freedom > 0 ? bin.slope_se / bin.slope : 0.0;
        const double own = bin.count * relative * relative;  // of one point
        const double variance = (prior_freedom * pooled + freedom * own) / (prior_freedom + freedom);
        errors.push_back(std::max(std::sqrt(variance / bin.count), smallest));
    }
    return errors;
}

SlopeArea fit_slope_area(std::vector<SlopeAreaBin> bins, double smallest_se_dex) {
    std::vector<double> log_area, log_slope, weight;
    for (const double error : bin_errors(bins, smallest_se_dex)) weight.push_back(1 / (error * error));
    for (const SlopeAreaBin& bin : bins) {
        log_area.push_back(std::log(bin.area_m2));
        log_slope.push_back(std::log(bin.slope));
    }
    const Line line = fit_line(log_area, log_slope, weight);
    const auto& [slope, slope_se, slope_interval] = line.slope;
    return {.theta = {-slope, slope_se, {-slope_interval[1], -slope_interval[0]}},
            .ks = exponential(line.intercept),
            .r2 = line.r2,
            .bins = std::move(bins)};
}

}  // namespace thalweg::channel
