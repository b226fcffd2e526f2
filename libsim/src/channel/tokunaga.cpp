// SPDX-License-Identifier: GPL-3.0-or-later
#include "thalweg/channel/tokunaga.hpp"

#include <algorithm>
#include <cmath>

namespace thalweg::channel {

namespace {

/// Streams of each order, and side tributaries by their own order and that of the stream they join (from 1).
struct Counts {
    std::vector<double> streams;
    std::vector<std::vector<double>> side;
};

Counts count(const StreamNetwork& network, Index highest) {
    Counts counts{std::vector<double>(highest + 1, 0),
                  std::vector<std::vector<double>>(highest + 1, std::vector<double>(highest + 1, 0))};
    for (Index link = 0; link < network.size(); ++link) {
        const Index order = network.strahler[link];
        const Index below = network.downstream[link];
        if (below != none && network.strahler[below] == order) continue;  // the stream goes on
        ++counts.streams[order];
        if (below != none) ++counts.side[order][network.strahler[below]];
    }
    for (Index order = 2; order <= highest; ++order) counts.side[order - 1][order] -= 2 * counts.streams[order];
    return counts;
}

void fit_law(const std::vector<double>& tributaries, Tokunaga& result) {
    std::vector<double> step, logarithm, weight;
    for (std::size_t i = 0; i < tributaries.size(); ++i) {
        if (!(tributaries[i] > 0)) continue;
        step.push_back(static_cast<double>(i));
        logarithm.push_back(std::log(result.pooled[i]));
        weight.push_back(tributaries[i]);
    }
    const Line line = fit_line(step, logarithm, weight);
    result.a = exponential(line.intercept);
    result.c = exponential(line.slope);
}

}  // namespace

Tokunaga tokunaga(const StreamNetwork& network) {
    const Index highest = network.size() == 0 ? 0 : *std::ranges::max_element(network.strahler);
    const Counts counts = count(network, highest);
    Tokunaga result;
    std::vector<double> tributaries;
    for (Index order = 1; order < highest; ++order) {
        std::vector<double>& row = result.per_stream.emplace_back();
        for (Index above = order + 1; above <= highest; ++above) {
            row.push_back(counts.side[order][above] / counts.streams[above]);
        }
    }
    for (Index k = 1; k < highest; ++k) {
        double joining = 0, streams = 0;
        for (Index order = 1; order + k <= highest; ++order) {
            joining += counts.side[order][order + k];
            streams += counts.streams[order + k];
        }
        tributaries.push_back(joining);
        result.pooled.push_back(joining / streams);
    }
    fit_law(tributaries, result);
    return result;
}

}  // namespace thalweg::channel
