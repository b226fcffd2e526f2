// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "thalweg/channel/network.hpp"
#include "thalweg/core/statistics.hpp"

namespace thalweg::channel {

/// How many side tributaries of each order a stream takes in (Tokunaga 1978). Two streams of the order below form a
/// stream at its head; every other inflow of lower order is a side tributary, also a third one that joins at the head.
/// So N_i = 2·N_(i+1) + Σ_j T_ij·N_j + (streams of order i that reach a mouth).
struct Tokunaga {
    /// T_ij: [i − 1][k − 1] is the mean number of side tributaries of order i per stream of order j = i + k.
    std::vector<std::vector<double>> per_stream;
    /// T_k: [k − 1] is the number of side tributaries k orders lower per stream that could have one, all orders pooled.
    std::vector<double> pooled;
    Estimate a;  ///< of T_k = a·c^(k−1), by regression of ln T_k on k − 1, each weighted by the tributaries counted
    Estimate c;
};

/// Linear in the links. Below two orders everything is empty and a and c are NaN; without side tributaries of two
/// different k, c is NaN. Peano's basin and Shreve's random model have a = 1 and c = 2.
Tokunaga tokunaga(const StreamNetwork&);

}  // namespace thalweg::channel
