// SPDX-License-Identifier: GPL-3.0-or-later
#include "thalweg/terrain/accumulate.hpp"

#include <algorithm>

#include "terrain/check_sizes.hpp"
#include "terrain/sweeps.hpp"

namespace thalweg::terrain {

std::vector<double> accumulate(const FlowGraph& graph, std::span<const double> amount) {
    check_sizes(graph.size(), amount.size(), amount.size());
    std::vector<double> sum(amount.begin(), amount.end());
    if (graph.order.size() < sum.size()) {
        std::fill(sum.begin(), sum.end(), 0.0);
        for (const Index node : graph.order) sum[node] = amount[node];
    }
    from_leaves_down(graph, [&](Index node) { sum[graph.receiver[node]] += sum[node]; });
    return sum;
}

std::vector<double> cell_areas(const Grid& grid) {
    std::vector<double> areas(grid.size());
    for (Index row = 0; row < grid.rows; ++row) {
        std::fill_n(areas.begin() + std::size_t{row} * grid.cols, grid.cols, grid.cell_area[row]);
    }
    return areas;
}

std::vector<double> cell_areas(const Mesh& mesh) { return mesh.cell_area; }

std::vector<double> carve(const FlowGraph& graph, std::span<const double> elevation_m) {
    check_sizes(graph.size(), elevation_m.size(), elevation_m.size());
    std::vector<double> carved(elevation_m.begin(), elevation_m.end());
    from_leaves_down(graph, [&](Index node) {
        const Index receiver = graph.receiver[node];
        carved[receiver] = std::min(carved[receiver], carved[node]);
    });
    return carved;
}

std::vector<double> largest_upstream(const FlowGraph& graph, std::span<const double> values) {
    check_sizes(graph.size(), values.size(), values.size());
    std::vector<double> largest(values.begin(), values.end());
    from_leaves_down(graph, [&](Index node) {
        const Index receiver = graph.receiver[node];
        largest[receiver] = std::max(largest[receiver], largest[node]);
    });
    return largest;
}

}  // namespace thalweg::terrain
