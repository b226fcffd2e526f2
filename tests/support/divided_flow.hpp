// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cmath>
#include <map>
#include <span>
#include <vector>

#include "thalweg/terrain/lakes.hpp"
#include "thalweg/terrain/multiple_flow.hpp"

namespace thalweg::support {

/// Steepest directions with lakes led over their passes.
template <Topology T>
FlowDirections single_flow(const T& topology, std::span<const double> z, std::span<const Boundary> boundary) {
    FlowDirections directions = terrain::route(topology, z, boundary);
    terrain::drain_lakes(topology, z, boundary, directions);
    return directions;
}

/// Receiver and share of a node.
inline std::map<Index, double> shares_of(const terrain::MultipleFlow& flow, Index node) {
    std::map<Index, double> shares;
    flow.receivers(node, [&](Index receiver, double, double share) { shares[receiver] = share; });
    return shares;
}

/// Upslope sums as the solution of the linear equations A = a + Wᵀ·A, by Gauss's elimination on the dense matrix. Knows
/// nothing of an order.
inline std::vector<double> accumulate_by_elimination(const terrain::MultipleFlow& flow,
                                                     std::span<const double> amount) {
    const std::size_t n = flow.size();
    std::vector<std::vector<double>> matrix(n, std::vector<double>(n + 1, 0.0));
    for (std::size_t i = 0; i < n; ++i) {
        matrix[i][i] = 1;
        matrix[i][n] = amount[i];
        flow.receivers(static_cast<Index>(i),
                       [&](Index receiver, double, double share) { matrix[receiver][i] -= share; });
    }
    for (std::size_t k = 0; k < n; ++k) {
        std::size_t pivot = k;
        for (std::size_t i = k; i < n; ++i) {
            if (std::abs(matrix[i][k]) > std::abs(matrix[pivot][k])) pivot = i;
        }
        std::swap(matrix[k], matrix[pivot]);
        for (std::size_t i = k + 1; i < n; ++i) {
            const double factor = matrix[i][k] / matrix[k][k];
            if (factor == 0) continue;
            for (std::size_t j = k; j <= n; ++j) matrix[i][j] -= factor * matrix[k][j];
        }
    }
    std::vector<double> sum(n);
    for (std::size_t k = n; k-- > 0;) {
        sum[k] = matrix[k][n];
        for (std::size_t j = k + 1; j < n; ++j) sum[k] -= matrix[k][j] * sum[j];
        sum[k] /= matrix[k][k];
    }
    return sum;
}

}  // namespace thalweg::support
