// SPDX-License-Identifier: GPL-3.0-or-later
#include "thalweg/channel/slope_area.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <map>

#include "thalweg/core/parallel.hpp"

namespace thalweg::channel {

namespace {

constexpr double nan = std::numeric_limits<double>::quiet_NaN();

/// Sums over the points of one bin: weights, and weighted logarithms of slopes over the first one's, so that points of
/// one slope have no scatter, not even that of rounding.
struct BinSum {
    double weight = 0, log_area = 0;
    double first = 0;                       ///< ln slope that the others are told from
    double over = 0;                        ///< Σ w·o, o = ln slope − first
    double w2 = 0, w2_over = 0, w2_o2 = 0;  ///< Σ w², Σ w²·o, Σ w²·o²
    Index count = 0;

    void add(double log_a, double log_s, double w) {
        if (count == 0) first = log_s;
        const double o = log_s - first;
        weight += w;
        log_area += w * log_a;
        over += w * o;
        w2 += w * w;
        w2_over += w * w * o;
        w2_o2 += w * w * o * o;
        ++count;
    }
    /// As if the other's points came after these.
    void add(const BinSum& other) {
        if (other.count == 0) return;
        if (count == 0) {
            *this = other;
            return;
        }
        const double shift = other.first - first;
        weight += other.weight;
        log_area += other.log_area;
        over += other.over + shift * other.weight;
        w2_o2 += other.w2_o2 + shift * (2 * other.w2_over + shift * other.w2);
        w2_over += other.w2_over + shift * other.w2;
        w2 += other.w2;
        count += other.count;
    }
};

SlopeAreaBin bin_of(const BinSum& sum) {
    const double mean = sum.over / sum.weight;
    const double slope = std::exp(sum.first + mean);
    const double n = sum.count;
    const double squares = std::max(0.0, sum.w2_o2 - mean * (2 * sum.w2_over - mean * sum.w2));  // Σ (w·(o − mean))²
    const double error = n > 1 ? std::sqrt(squares * n / (n - 1)) / sum.weight : nan;
    return {
        .area_m2 = std::exp(sum.log_area / sum.weight), .slope = slope, .slope_se = slope * error, .count = sum.count};
}

int bin_number(double area_m2, int bins_per_decade) {
    return static_cast<int>(std::floor(bins_per_decade * std::log10(area_m2)));
}

/// Slope of a node to its receiver; NaN where it has none or is not in use.
double slope_of(const terrain::FlowGraph& graph, std::span<const double> elevation_m,
                std::span<const std::uint8_t> used, Index node) {
    const Index receiver = graph.receiver[node];
    if (receiver == none || (!used.empty() && !used[node])) return nan;
    return (elevation_m[node] - elevation_m[receiver]) / graph.length[node];
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
        const double slope = slope_of(graph, elevation_m, used, node);
        if (slope > 0 && drainage_area_m2[node] > 0) points.push_back({drainage_area_m2[node], slope, 1, node});
    }
    return points;
}

std::vector<SlopeAreaPoint> link_slopes(const StreamNetwork& network, const terrain::FlowGraph& graph,
                                        std::span<const double> drainage_area_m2) {
    std::vector<SlopeAreaPoint> points;
    for (Index link = 0; link < network.size(); ++link) {
        if (!(network.drop_m[link] > 0)) continue;
        const auto nodes = network.nodes_of(link);
        const auto steps = nodes.first(nodes.size() - 1);
        double length = 0, log_area = 0;
        for (const Index node : steps) {
            length += graph.length[node];
            log_area += graph.length[node] * std::log(drainage_area_m2[node]);
        }
        points.push_back({std::exp(log_area / length), network.drop_m[link] / length, length, steps.back()});
    }
    return points;
}

std::vector<SlopeAreaBin> slope_area_bins(std::span<const SlopeAreaPoint> points, int bins_per_decade) {
    std::map<int, BinSum> sums;
    for (const SlopeAreaPoint& point : points) {
        sums[bin_number(point.area_m2, bins_per_decade)].add(std::log(point.area_m2), std::log(point.slope),
                                                             point.weight);
    }
    std::vector<SlopeAreaBin> bins;
    for (const auto& [number, sum] : sums) bins.push_back(bin_of(sum));
    return bins;
}

NodeSlopeBins node_slope_bins(const terrain::FlowGraph& graph, std::span<const double> drainage_area_m2,
                              std::span<const double> elevation_m, std::span<const std::uint8_t> used) {
    constexpr int bins_per_decade = 10, lowest = -20 * bins_per_decade, bins = 40 * bins_per_decade;
    struct Block {
        std::vector<BinSum> sums;
        std::size_t looked_at = 0, level = 0;
    };
    const Index block_size = std::max<Index>(Index{1} << 18, graph.size() / 128 + 1);  // never by the threads
    std::vector<Block> blocks((graph.size() + block_size - 1) / block_size);
    const auto gather = [&](Block& block, Index begin, Index end) {
        block.sums.resize(bins);
        for (Index node = begin; node < end; ++node) {
            const double slope = slope_of(graph, elevation_m, used, node), area = drainage_area_m2[node];
            if (std::isnan(slope) || !(area > 0)) continue;
            ++block.looked_at;
            block.level += !(slope > 0);
            if (!(slope > 0)) continue;
            const int bin = std::clamp(bin_number(area, bins_per_decade) - lowest, 0, bins - 1);
            block.sums[bin].add(std::log(area), std::log(slope), 1);
        }
    };
    parallel_for(
        0, static_cast<Index>(blocks.size()),
        [&](Index first, Index last) {
            for (Index b = first; b < last; ++b) {
                gather(blocks[b], b * block_size, std::min(graph.size(), (b + 1) * block_size));
            }
        },
        1);
    NodeSlopeBins all;
    std::vector<BinSum> sums(bins);
    for (const Block& block : blocks) {
        all.looked_at += block.looked_at;
        all.level += block.level;
        for (int bin = 0; bin < bins; ++bin) sums[bin].add(block.sums[bin]);
    }
    for (const BinSum& sum : sums) {
        if (sum.count > 0) all.bins.push_back(bin_of(sum));
    }
    return all;
}

Turnover hillslope_turnover(std::span<const SlopeAreaBin> all) {
    std::vector<SlopeAreaBin> bins;
    std::ranges::copy_if(all, std::back_inserter(bins), [](const SlopeAreaBin& bin) { return bin.count >= 5; });
    const auto steepest = std::ranges::max_element(bins, {}, &SlopeAreaBin::slope);
    if (bins.size() < 3 || steepest == bins.begin() || steepest + 1 == bins.end()) return {nan, {nan, nan}};
    const auto as_steep = [&](const SlopeAreaBin& bin) {
        return steepest->slope - bin.slope < 1.96 * std::hypot(steepest->slope_se, bin.slope_se);
    };
    auto first = steepest, last = steepest;
    while (first != bins.begin() && as_steep(*(first - 1))) --first;
    while (last + 1 != bins.end() && as_steep(*(last + 1))) ++last;
    return {steepest->area_m2, {first->area_m2, last->area_m2}};
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
