// SPDX-License-Identifier: GPL-3.0-or-later
#include "thalweg/channel/drop_analysis.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "thalweg/channel/horton.hpp"
#include "thalweg/channel/network.hpp"
#include "thalweg/core/statistics.hpp"

namespace thalweg::channel {

namespace {

double sum_of_squares(std::span<const double> values, double about) {
    double sum = 0;
    for (const double value : values) sum += (value - about) * (value - about);
    return sum;
}

/// Student's t of the difference of two means, both samples taken to have one variance.
double students_t(std::span<const double> a, std::span<const double> b) {
    if (a.size() < 2 || b.size() < 2) return std::numeric_limits<double>::quiet_NaN();
    const double mean_a = mean(a), mean_b = mean(b);
    const auto count_a = static_cast<double>(a.size()), count_b = static_cast<double>(b.size());
    const double variance = (sum_of_squares(a, mean_a) + sum_of_squares(b, mean_b)) / (count_a + count_b - 2);
    return (mean_a - mean_b) / std::sqrt(variance * (1 / count_a + 1 / count_b));
}

DropTest test_of(double threshold, const StreamNetwork& network) {
    std::vector<double> first, higher;
    for (const StrahlerStream& stream : strahler_streams(network)) {
        (stream.order == 1 ? first : higher).push_back(stream.drop_m);
    }
    return {.threshold = threshold,
            .first_order = static_cast<Index>(first.size()),
            .higher_order = static_cast<Index>(higher.size()),
            .first_mean_m = mean(first),
            .higher_mean_m = mean(higher),
            .t = students_t(first, higher)};
}

}  // namespace

std::vector<DropTest> drop_analysis(const terrain::FlowGraph& graph, std::span<const double> measure,
                                    std::span<const double> drainage_area_m2, std::span<const double> elevation_m,
                                    std::span<const std::uint8_t> used, std::span<const double> thresholds) {
    std::vector<DropTest> tests;
    for (const double threshold : thresholds) {
        const auto channels = channels_by_area(measure, threshold, used);
        tests.push_back(test_of(threshold, stream_network(graph, channels, drainage_area_m2, elevation_m)));
    }
    return tests;
}

std::optional<double> first_threshold_by_drops(std::span<const DropTest> tests) {
    std::vector<DropTest> upwards(tests.begin(), tests.end());
    std::ranges::sort(upwards, {}, &DropTest::threshold);
    for (const DropTest& test : upwards) {
        if (std::abs(test.t) < 2) return test.threshold;
    }
    return std::nullopt;
}

std::optional<double> lasting_threshold_by_drops(std::span<const DropTest> tests) {
    std::vector<DropTest> downwards(tests.begin(), tests.end());
    std::ranges::sort(downwards, std::ranges::greater{}, &DropTest::threshold);
    constexpr Index enough = 5;
    std::optional<double> lasting;
    int differing = 0;
    for (const DropTest& test : downwards) {
        if (std::min(test.first_order, test.higher_order) < enough) continue;
        differing += std::abs(test.t) >= 2;
        if (differing > 1 || std::abs(test.t) >= 3) break;
        if (std::abs(test.t) < 2) lasting = test.threshold;
    }
    return lasting;
}

std::optional<double> threshold_by_drops(std::span<const DropTest> tests) {
    const std::optional<double> lasting = lasting_threshold_by_drops(tests);
    return lasting ? lasting : first_threshold_by_drops(tests);
}

std::vector<double> slope_area_product(const terrain::FlowGraph& graph, std::span<const double> drainage_area_m2,
                                       std::span<const double> elevation_m) {
    std::vector<double> product(graph.size(), 0);
    for (auto node = graph.order.rbegin(); node != graph.order.rend(); ++node) {
        const Index receiver = graph.receiver[*node];
        if (receiver == none) continue;
        const double slope = (elevation_m[*node] - elevation_m[receiver]) / graph.length[*node];
        product[*node] = std::max(product[*node], drainage_area_m2[*node] * slope * slope);
        product[receiver] = std::max(product[receiver], product[*node]);
    }
    return product;
}

}  // namespace thalweg::channel
