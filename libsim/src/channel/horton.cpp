// SPDX-License-Identifier: GPL-3.0-or-later
#include "thalweg/channel/horton.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "thalweg/core/statistics.hpp"

namespace thalweg::channel {

namespace {

/// Ratio by which a statistic grows from order to order; orders where it is not positive are left out.
HortonRatio growth(const std::vector<OrderStatistics>& orders, double (*statistic)(const OrderStatistics&)) {
    std::vector<double> order, logarithm, ratio;
    double previous = 0;
    for (const OrderStatistics& each : orders) {
        double value = statistic(each);
        if (!(value > 0) || std::isinf(value)) value = 0;
        if (value > 0) {
            order.push_back(each.order);
            logarithm.push_back(std::log10(value));
        }
        if (value > 0 && previous > 0) ratio.push_back(value / previous);
        previous = value;
    }
    const Estimate slope = fit_line(order, logarithm).slope;
    const double regression = std::pow(10, slope.value);
    return {.regression = regression,
            .mean_ratio = mean(ratio),
            .regression_se = regression * std::log(10.0) * slope.standard_error,
            .regression_ci95 = {std::pow(10, slope.interval95[0]), std::pow(10, slope.interval95[1])}};
}

}  // namespace

std::vector<StrahlerStream> strahler_streams(const StreamNetwork& network) {
    std::vector<StrahlerStream> streams;
    std::vector<Index> of_link(network.size());
    for (Index link = 0; link < network.size(); ++link) {
        const Index below = network.downstream[link];
        if (below != none && network.strahler[below] == network.strahler[link]) {
            of_link[link] = of_link[below];
        } else {
            of_link[link] = static_cast<Index>(streams.size());
            streams.push_back({network.strahler[link], 0, 0, network.area_m2[link]});
        }
        streams[of_link[link]].length_m += network.length_m[link];
        streams[of_link[link]].drop_m += network.drop_m[link];
    }
    return streams;
}

std::vector<OrderStatistics> strahler_statistics(const StreamNetwork& network) {
    if (network.size() == 0) return {};
    const Index highest = *std::ranges::max_element(network.strahler);
    std::vector<OrderStatistics> orders(highest);
    for (Index i = 0; i < highest; ++i) orders[i] = {i + 1, 0, 0, 0, 0, 0};
    for (const StrahlerStream& stream : strahler_streams(network)) {
        OrderStatistics& sum = orders[stream.order - 1];
        ++sum.streams;
        sum.mean_length_m += stream.length_m;
        sum.mean_area_m2 += stream.area_m2;
        sum.mean_slope += stream.drop_m / stream.length_m;
        sum.mean_drop_m += stream.drop_m;
    }
    for (OrderStatistics& sum : orders) {
        sum.mean_length_m /= sum.streams;
        sum.mean_area_m2 /= sum.streams;
        sum.mean_slope /= sum.streams;
        sum.mean_drop_m /= sum.streams;
    }
    return orders;
}

HortonRatios horton_ratios(const std::vector<OrderStatistics>& orders) {
    return {.bifurcation = growth(orders, [](const OrderStatistics& o) { return 1.0 / o.streams; }),
            .length = growth(orders, [](const OrderStatistics& o) { return o.mean_length_m; }),
            .area = growth(orders, [](const OrderStatistics& o) { return o.mean_area_m2; }),
            .slope = growth(orders, [](const OrderStatistics& o) { return 1 / o.mean_slope; })};
}

}  // namespace thalweg::channel
