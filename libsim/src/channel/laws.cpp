// SPDX-License-Identifier: GPL-3.0-or-later
#include "thalweg/channel/laws.hpp"

#include <algorithm>
#include <bit>
#include <cmath>

#include "terrain/sweeps.hpp"

namespace thalweg::channel {

std::vector<double> longest_upstream_lengths(const terrain::FlowGraph& graph) {
    std::vector<double> longest(graph.size(), 0);
    terrain::from_leaves_down(graph, [&](Index node) {
        const Index receiver = graph.receiver[node];
        longest[receiver] = std::max(longest[receiver], longest[node] + graph.length[node]);
    });
    return longest;
}

std::vector<double> longest_upstream_lengths(const StreamNetwork& network) {
    std::vector<double> longest(network.size(), 0);
    for (Index link = network.size(); link-- > 0;) {
        longest[link] += network.length_m[link];
        const Index below = network.downstream[link];
        if (below != none) longest[below] = std::max(longest[below], longest[link]);
    }
    return longest;
}

PowerLawFit hack_law(const StreamNetwork& network, std::span<const double> drainage_area_m2,
                     std::span<const double> longest_upstream_m) {
    std::vector<double> area, length;
    for (Index link = 0; link < network.size(); ++link) {
        const auto nodes = network.nodes_of(link);
        const Index node = nodes[nodes.size() - 2];
        area.push_back(drainage_area_m2[node]);
        length.push_back(longest_upstream_m[node]);
    }
    return fit_power_law(area, length);
}

PowerLawFit flint_law(const StreamNetwork& network) {
    struct Class {
        double links = 0, length = 0, drop = 0, log_magnitude = 0;
    };
    std::vector<Class> classes(std::bit_width(Index{0} - 1) + 1);
    for (Index link = 0; link < network.size(); ++link) {
        const Index magnitude = network.shreve[link];
        Class& sum = classes[std::bit_width(magnitude - 1)];
        ++sum.links;
        sum.length += network.length_m[link];
        sum.drop += network.drop_m[link];
        sum.log_magnitude += network.length_m[link] * std::log(2.0 * magnitude - 1);
    }
    std::vector<double> abscissa, slope, weight;
    for (const Class& sum : classes) {
        if (!(sum.length > 0)) continue;
        abscissa.push_back(std::exp(sum.log_magnitude / sum.length));
        slope.push_back(sum.drop / sum.length);
        weight.push_back(sum.links);
    }
    return fit_power_law(abscissa, slope, weight);
}

double howard_angle(double below_over_first, double below_over_second) {
    return std::acos(std::min(below_over_first, 1.0)) + std::acos(std::min(below_over_second, 1.0));
}

}  // namespace thalweg::channel
