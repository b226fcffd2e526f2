// SPDX-License-Identifier: GPL-3.0-or-later
#include "study/channel_choice.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "thalweg/core/error.hpp"
#include "thalweg/core/statistics.hpp"
#include "thalweg/terrain/accumulate.hpp"

namespace thalweg::study {
namespace {

/// Calls use(area) with the drainage area by which channels begin. Divided flow may lose water along a path of the
/// graph; a channel that has begun goes on.
template <class Use>
auto with_initiation_area(const RoutedTerrain& terrain, const Use& use) {
    if (terrain.divided_area_m2.empty()) return use(terrain.drainage_area_m2);
    return use(terrain::largest_upstream(terrain.graph, terrain.divided_area_m2));
}

/// A·S² with the area of the routing that was asked for.
std::vector<double> initiation_product(const RoutedTerrain& terrain) {
    return channel::slope_area_product(
        terrain.graph, terrain.divided_area_m2.empty() ? terrain.drainage_area_m2 : terrain.divided_area_m2,
        terrain.elevation_m);
}

/// Five thresholds per decade, the same whatever the terrain, within [lowest, highest].
std::vector<double> candidates(double lowest, double highest) {
    std::vector<double> thresholds;
    if (!(lowest > 0) || !(highest > 0)) return thresholds;
    for (double decade = std::floor(std::log10(lowest)); decade <= std::log10(highest); ++decade) {
        for (const double step : {1.0, 1.6, 2.5, 4.0, 6.3}) {
            const double threshold = step * std::pow(10.0, decade);
            if (threshold >= lowest && threshold <= highest) thresholds.push_back(threshold);
        }
    }
    return thresholds;
}

/// Values at the nodes with data.
template <class Values>
std::vector<double> known(const RoutedTerrain& terrain, const Values& values) {
    std::vector<double> result;
    result.reserve(terrain.graph.order.size());
    for (const Index node : terrain.graph.order) result.push_back(values[node]);
    return result;
}

/// Areas from ten cells, below which a grid holds no valleys, to a tenth of the terrain.
std::vector<double> candidate_areas(const RoutedTerrain& terrain) {
    const std::vector<double> cells = known(terrain, terrain.cell_area_m2);
    double area = 0;
    for (const double cell : cells) area += cell;
    return candidates(10 * area / static_cast<double>(cells.size()), 0.1 * area);
}

/// Products from the one that a quarter of all cells reach, as about that many have ten others upstream.
std::vector<double> candidate_products(const RoutedTerrain& terrain, const std::vector<double>& product) {
    std::vector<double> values = known(terrain, product);
    const double highest = values.empty() ? 0 : *std::ranges::max_element(values);
    return candidates(quantile(std::move(values), 0.75), highest);
}

double chosen_threshold(const RoutedTerrain& terrain, const MeasureOptions& options, std::span<const double> measure,
                        std::span<const double> thresholds, ChannelEvidence& evidence) {
    evidence.drop_tests = channel::drop_analysis(terrain.graph, measure, terrain.drainage_area_m2, terrain.elevation_m,
                                                 nodes_in_use(terrain, options), thresholds);
    const std::optional<double> chosen = channel::threshold_by_drops(evidence.drop_tests);
    if (chosen) return *chosen;
    if (thresholds.empty()) throw Error("the terrain is too small or too flat to choose channels by drop analysis");
    throw Error(
        fmt::format("drop analysis finds no threshold between {:.3g} and {:.3g} m2 at which streams of the first order "
                    "fall as far as the others: give one yourself",
                    thresholds.front(), thresholds.back()));
}

std::vector<Index> heads_by_product(const RoutedTerrain& terrain, const MeasureOptions& options,
                                    ChannelEvidence& evidence) {
    const std::vector<double> product = initiation_product(terrain);
    evidence.slope_area_m2 = options.slope_area_m2 ? *options.slope_area_m2
                                                   : chosen_threshold(terrain, options, product,
                                                                      candidate_products(terrain, product), evidence);
    return channel::channel_heads(terrain.graph, channel::channels_by_area(product, *evidence.slope_area_m2));
}

}  // namespace

MeasureOptions with_channels_chosen(const RoutedTerrain& terrain, const MeasureOptions& options,
                                    ChannelEvidence& evidence) {
    MeasureOptions chosen = options;
    if (options.channels == ChannelRule::drop) {
        chosen.channel_area_m2 = with_initiation_area(terrain, [&](const std::vector<double>& area) {
            return chosen_threshold(terrain, options, area, candidate_areas(terrain), evidence);
        });
    }
    if (options.channels == ChannelRule::slope_area) {
        chosen.heads = ChannelHeads{.cells = heads_by_product(terrain, options, evidence)};
    }
    return chosen;
}

std::span<const std::uint8_t> nodes_in_use(const RoutedTerrain& terrain, const MeasureOptions& options) {
    if (options.edge_basins == terrain::EdgeBasins::keep) return {};
    return terrain.complete;
}

std::vector<std::uint8_t> channel_nodes(const RoutedTerrain& terrain, const MeasureOptions& options,
                                        double threshold_m2) {
    if (options.heads) return channel::channels_from_heads(terrain.graph, options.heads->cells);
    return with_initiation_area(
        terrain, [&](const std::vector<double>& area) { return channel::channels_by_area(area, threshold_m2); });
}

std::vector<std::uint8_t> channels_in_use(const RoutedTerrain& terrain, const MeasureOptions& options,
                                          double threshold_m2) {
    std::vector<std::uint8_t> channels = channel_nodes(terrain, options, threshold_m2);
    const auto used = nodes_in_use(terrain, options);
    for (std::size_t node = 0; node < used.size(); ++node) channels[node] &= used[node];
    return channels;
}

}  // namespace thalweg::study
